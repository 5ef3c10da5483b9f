// A strategy made ready for one scene: the structure built, packed, and its parameters read.
//
// GPU tracers and twins start from the same PreparedStrategy; they differ in who runs the shader.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/catalogue.h"
#include "core/params.h"
#include "core/scene_needs.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/shader_inputs.h"
#include "gpu_glsl/pack/top_level_update.h"

namespace onepass {

/// What runs a strategy: by default a GPU, or a twin.
struct Device {
    TextureLimits limits;
    bool is_software = false;  ///< a software renderer (shaders/lib/renderer.glsl, loops.glsl)
    bool jumps = false;        ///< one that jumps (gl/context.h: is_jumping_renderer)
    bool has_ballots = false;  ///< invocations that run together can tell how many they are
    uint32_t processors = 1;   ///< each runs one group of persistent threads at once
};

/// How given rays are cast.
enum class CastForm {
    single,      ///< one an invocation
    pairs,       ///< two a fragment (shaders/lib/grid/pairs.glsl)
    persistent,  ///< from a queue (shaders/entry/cast_compute_persistent.glsl)
};

/// Rays of a cast that has enough of them for any form.
inline constexpr size_t kManyRays = std::numeric_limits<size_t>::max();

struct PreparedStrategy {
    gl::StrategyInfo info;
    std::string storage;
    ScenePtr scene;
    Params params;
    ShaderInputs inputs;                              ///< the structure's and the shading tables
    std::vector<gl::ShaderConstant> param_constants;  ///< the strategy's own parameters
    std::vector<Stat> stats;
    /// What moving takes; nothing: it does not move.
    std::variant<std::monostate, MovingTopLevel, MovingTopBuffers> moving;
    Device device = {};

    /// The roots of a shader: storage, strategy, then the entry.
    std::vector<std::string> files_with(const std::string& entry_file) const;

    /// Whether the strategy answers Query::any otherwise than by the nearest hit: it has the
    /// parameter `any_hit`, and that is on.
    bool answers_any() const;

    /// Whether an image's shadow rays are such queries. On a GPU they are not: a query that differs
    /// from ray to ray costs its images more than it saves (gpu_glsl/README.md).
    bool any_shadow_query() const;

    /// How fragments cast given rays: by the strategy's parameter `pairs`, if it has one; and how
    /// compute shaders cast `rays` of them: by its parameter `persistent`. `auto`: as pays.
    CastForm fragment_form() const;
    CastForm compute_form(size_t rays = kManyRays) const;

    /// Whether the driver ends loops of many turns (shaders/lib/loops.glsl): there an invocation of
    /// persistent threads takes one ray, for it counts the turns of all.
    bool ends_loops() const;

    /// How the planes of triangles are stored: by the strategy's parameter `records`; `auto`: as
    /// the device does best with.
    PlanesForm planes_form() const;

    /// All constants of a variant. `needs`: what the frame asks for; nullptr for `cast`, which
    /// shades nothing. `query`: what all rays of a cast ask; those of a frame differ.
    std::vector<gl::ShaderConstant> constants(bool count_work, const SceneNeeds* needs,
                                              Query query = Query::closest) const;
};

/// The parameters a user may set: those of the structure, of the storage and of the strategy.
/// Throws: Error if no packing is known for the structure and storage.
std::vector<ParamInfo> strategy_params(const gl::StrategyInfo& info, const std::string& storage);

/// Builds the structure and packs it.
/// Throws: Error for bad parameter values, or a scene that does not fit the limits.
PreparedStrategy prepare_strategy(const gl::StrategyInfo& info, const std::string& storage,
                                  ScenePtr scene, const ParamValues& values, const Device& device);

/// The cells of its object's grid whose lists hold a triangle; empty if the structure has no grids.
/// Cost: builds the object's grid anew: packed tables are made to be walked, not searched.
std::vector<ivec3> cells_of_triangle(const PreparedStrategy& prepared, uint32_t inst_id,
                                     uint32_t prim_id);

/// Works out what Tracer::update() changes; nothing has changed yet.
/// Throws: Error as Tracer::update().
TopLevelMove plan_move(const PreparedStrategy& prepared, std::span<const Affine> world_from_object);

/// Goes over to what was planned: inputs, statistics and room. Textures whose texels were given
/// back stay without, but for those that the move remade.
void commit_move(PreparedStrategy& prepared, TopLevelMove move);

}  // namespace onepass
