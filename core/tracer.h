// The seam between the traversal strategies and everything that compares them.
//
// Every strategy, the shaders' twins and Embree are Tracers; `compare` knows nothing else.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/render_settings.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// Which hit a ray asks for. `any`: some hit in [tmin, tmax]; which one is not specified.
enum class Query { closest, any };

/// One measured or computed property of a tracer's structure, or of one run.
struct Stat {
    std::string name;  ///< with its unit: "build_ms", "grid_bytes"
    double value = 0.0;
    std::string note;  ///< how to read it; may be empty

    bool operator==(const Stat&) const = default;
};

/// Rays that rest where a tracer runs. Opaque; valid only for the tracer that made it.
struct RayBatch {
    size_t count = 0;
    std::shared_ptr<const void> resident;
};

struct CastOptions {
    Query query = Query::closest;
    bool counters = false;  ///< count cells, tests and references; slower, never mixed with timing
    bool answers = true;    ///< false: only the times are wanted; hits and flags may be left out
};

struct CastResult {
    std::vector<Hit> hits;              ///< one a ray
    std::vector<uint32_t> flags;        ///< RayFlag bits, one a ray
    std::vector<RayCounters> counters;  ///< one a ray if asked for, else empty
    double device_ms = 0.0;             ///< by the device's own timer; NaN if it has none to trust
    double wall_ms = 0.0;               ///< from launch to finish, without upload and read-back
    std::vector<Stat> costs;            ///< what the strategy says of this run: "passes", ...
};

/// What moving the instances took.
struct UpdateTimes {
    double update_ms = 0.0;  ///< rebuilding and packing the top level; wall time
    double upload_ms = 0.0;  ///< bringing what changed to the device; 0 where there is no device
};

/// One image with its arbitrary output values (AOVs). Row-major, row 0 at the top.
struct Frame {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<vec3> color;            ///< linear RGB
    std::vector<Hit> hits;              ///< of the primary rays; empty without AOVs
    std::vector<vec3> normals;          ///< shading normals, world, unit; 0 for a miss
    std::vector<RayCounters> counters;  ///< sums over all rays of a pixel
    std::vector<uint32_t> flags;        ///< RayFlag bits, one a pixel
    double device_ms = 0.0;             ///< as in CastResult
    double wall_ms = 0.0;               ///< as in CastResult
    std::vector<Stat> costs;            ///< as in CastResult
};

/// A ray-triangle test of a walk.
struct WalkTest {
    uint32_t prim_id = kNoId;
    bool accepted = false;  ///< became the best hit so far
    double t = 0.0;         ///< of an accepted one

    bool operator==(const WalkTest&) const = default;
};

/// A cell that a ray visited, with the triangles tested there, in order.
struct WalkStep {
    uint32_t inst_id = kNoId;  ///< whose object's grid; kNoId: the top-level grid
    ivec3 cell{0};             ///< from the grid's lower corner on
    std::vector<WalkTest> tests;

    bool operator==(const WalkStep&) const = default;
};

/// What one ray did in a tracer's grids: the visited cells in order, the objects' between those of
/// the top level.
struct RayWalk {
    std::vector<WalkStep> steps;
    Hit hit;                 ///< as cast() answers
    uint32_t flags = 0;      ///< RayFlag bits
    RayCounters counters{};  ///< as cast() counts
};

struct Capabilities {
    bool render = true;              ///< false: cast only; render through core/shading.h instead
    bool counters = false;           ///< fills CastResult::counters and Frame::counters
    bool walks = false;              ///< walk() tells
    bool device_timer = false;       ///< device_ms can be trusted
    bool software_renderer = false;  ///< a GL tracer that runs on the CPU (Mesa's llvmpipe)
    uint32_t threads = 0;            ///< CPU threads used; 0 where that has no meaning
    std::string device;              ///< "llvmpipe (LLVM 15...)", "Embree 3.13.5", ...
    std::string shader_hash;         ///< of the composed `cast` shader; empty for CPU tracers
};

/// One traversal of one scene. Built ready to trace; not thread-safe.
class Tracer {
  public:
    virtual ~Tracer() = default;

    /// The name in every result: strategy/storage/entry, such as "paper/texture2d/fragment".
    virtual const std::string& name() const = 0;
    virtual Capabilities capabilities() const = 0;
    virtual std::vector<Stat> stats() const = 0;

    /// Makes the rays resident. Throws: Error if the device cannot hold them.
    virtual RayBatch upload(std::span<const Ray> rays) = 0;

    /// Answers every ray of the batch. Never throws for a ray's values: a NaN ray is a miss.
    virtual CastResult cast(const RayBatch& batch, const CastOptions& options = {}) = 0;

    /// Follows one ray and tells what it did. Nothing where capabilities().walks is false.
    virtual std::optional<RayWalk> walk(const Ray& /*ray*/) { return {}; }

    /// The cells of its instance's object grid whose lists hold a triangle. Empty where
    /// capabilities().walks is false. Cost: may build the object's grid anew.
    virtual std::vector<ivec3> cells_of(uint32_t /*inst_id*/, uint32_t /*prim_id*/) { return {}; }

    /// Moves the instances: from now on the scene is the one with these transforms. Only the
    /// top level is rebuilt; what was built for the objects stays (stats() counts both).
    ///
    /// One transform an instance. The tracer must have been made from a scene with an animation:
    /// others need not keep what an update takes.
    /// Throws: Error if it was not, or if the moved scene exceeds the strategy's limits; the tracer
    /// then goes on with the transforms it had.
    virtual UpdateTimes update(std::span<const Affine> world_from_object) = 0;

    /// The whole image: primary, shadow and reflection rays. One draw or dispatch if the strategy
    /// is a single-pass one.
    virtual Frame render(const Camera& camera, const RenderSettings& settings) = 0;
};

}  // namespace onepass
