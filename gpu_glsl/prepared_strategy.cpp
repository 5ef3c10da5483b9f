#include "gpu_glsl/prepared_strategy.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "core/bvh/bvh.h"
#include "core/error.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/bvh_buffers.h"
#include "gpu_glsl/pack/flat_grid_buffers.h"
#include "gpu_glsl/pack/irregular_grid_buffers.h"
#include "gpu_glsl/pack/shading_tables.h"
#include "gpu_glsl/pack/two_level_buffers.h"
#include "gpu_glsl/pack/two_level_textures.h"
#include "gpu_glsl/pack/two_level_variants.h"

namespace onepass {
namespace {

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

// ---- The two-level grid in 2D and 3D textures --------------------------------------------------

/// One size for all objects is the rule; what a scene of unlike objects wants is its exception.
constexpr char kSameSize[] = "same";

ParamInfo object_sizes_param(const std::string& form) {
    return {"sizes",
            ParamInfo::Type::text,
            kSameSize,
            fmt::format("the object grids' own sizes, one an object in the scene's order, by "
                        "commas: {}; same: one size for all",
                        form),
            {}};
}

std::vector<ParamInfo> two_level_sizing_params() {
    using Type = ParamInfo::Type;
    const TwoLevelSizing sizing;
    return {
        {"density",
         Type::real,
         fmt::format("{}", sizing.object.density),
         "cells per triangle of the object grids (lambda)",
         {}},
        {"top_density",
         Type::real,
         fmt::format("{}", sizing.top.density),
         "cells per instance of the top-level grid (lambda)",
         {}},
        {"resolution",
         Type::text,
         "auto",
         "cells of every object grid, XxYxZ; overrides density",
         {}},
        object_sizes_param("density or XxYxZ"),
        {"top_resolution",
         Type::text,
         "auto",
         "cells of the top-level grid, XxYxZ; overrides top_density",
         {}},
    };
}

std::vector<ParamInfo> two_level_params() {
    std::vector<ParamInfo> params = two_level_sizing_params();
    params.push_back({"atlas",
                      ParamInfo::Type::integer,
                      "256",
                      "cells a side of the cell texture, at most",
                      {}});
    return params;
}

/// The paper's storage can have its tables in other widths.
std::vector<ParamInfo> two_level_texture_params() {
    using Type = ParamInfo::Type;
    std::vector<ParamInfo> params = two_level_params();
    params.push_back({"address",
                      Type::choice,
                      "auto",
                      "width of a texture address: half (16-bit float) where the scene fits, else "
                      "float",
                      {"auto", "half", "float"}});
    params.push_back({"geometry",
                      Type::choice,
                      "float",
                      "width of a triangle's numbers: half is a 16-bit float, and leaves holes",
                      {"float", "half"}});
    return params;
}

/// "auto", or three cell counts.
std::optional<uvec3> explicit_resolution(const Params& params, const std::string& name) {
    const std::string& text = params.text(name);
    if (text == "auto") return std::nullopt;
    return parse_resolution(text, "--param " + name);
}

/// Empty: one size for all.
std::vector<GridSizing> object_sizes(const Params& params) {
    std::vector<GridSizing> sizes;
    const std::string& text = params.text("sizes");
    if (text == kSameSize) return sizes;
    for (size_t at = 0; at <= text.size();) {
        const size_t end = std::min(text.find(',', at), text.size());
        sizes.push_back(
            parse_grid_sizing(std::string_view(text).substr(at, end - at), "--param sizes"));
        at = end + 1;
    }
    return sizes;
}

double positive(const Params& params, const std::string& name) {
    const double value = params.real(name);
    if (!(value > 0.0)) {
        throw Error({"--param " + name, fmt::format("{}", value), "a number above 0",
                     "Densities are cells per primitive; 1 to 16 is usual."});
    }
    return value;
}

bool has(const Params& params, const std::string& name) { return params.values().contains(name); }

/// Of a parameter that may be on, off or auto; off where the strategy has none.
bool is_chosen(const Params& params, const std::string& name, bool automatic) {
    if (!has(params, name)) return false;
    const std::string& choice = params.text(name);
    return choice == "on" || (choice == "auto" && automatic);
}

/// Whether the shader may leave out what the scene lacks.
bool specialises(const Params& params) {
    return !has(params, "specialise") || params.integer("specialise") == 1;
}

/// Whether the shader holds the top level.
bool has_top_level(const PreparedStrategy& prepared) {
    return prepared.scene->instances.size() > 1 || !specialises(prepared.params);
}

/// Whether the shader turns and scales rays for instances, or only shifts them.
bool has_linear_maps(const PreparedStrategy& prepared) {
    const Scene& scene = *prepared.scene;
    const bool is_fixed = scene.animation.empty();
    const bool all_are_shifted = std::ranges::all_of(scene.instances, [](const Instance& instance) {
        const Affine& map = instance.world_from_object;
        return map[0] == vec3(1, 0, 0) && map[1] == vec3(0, 1, 0) && map[2] == vec3(0, 0, 1);
    });
    return !(is_fixed && all_are_shifted && specialises(prepared.params));
}

/// Whether the shader looks up which object an instance is of, or knows.
bool has_several_objects(const PreparedStrategy& prepared) {
    return prepared.scene->objects.size() > 1 || !specialises(prepared.params);
}

/// What a frame needs, for one shader that serves scenes of every kind: it holds all that any of
/// them needs, and learns of this one at run time.
std::vector<gl::ShaderConstant> for_all_scenes(std::vector<gl::ShaderConstant> constants) {
    for (gl::ShaderConstant& constant : constants) {
        const std::string& name = constant.name;
        if (name == "has_several_lights" || name == "has_mirrors") constant.value = true;
        constant.late = name == "light_count" || name == "max_depth" || name == "shadows";
    }
    return constants;
}

AddressWidth address_width(const Params& params) {
    const std::string& text = params.text("address");
    if (text == "half") return AddressWidth::half;
    if (text == "float") return AddressWidth::single;
    return AddressWidth::automatic;
}

/// What the strategy's own parameters, and `geometry` where the storage has it, ask of triangles.
TrianglePlanesOptions triangle_options(const Params& params) {
    TrianglePlanesOptions options;
    options.local = has(params, "local_planes") && params.integer("local_planes") == 1;
    const bool half = has(params, "geometry") && params.text("geometry") == "half";
    options.format = half ? ChannelFormat::half : ChannelFormat::single;
    return options;
}

TwoLevelSizing two_level_sizing(const Params& params) {
    TwoLevelSizing sizing;
    sizing.object.density = positive(params, "density");
    sizing.object.resolution = explicit_resolution(params, "resolution");
    sizing.objects = object_sizes(params);
    sizing.top.density = positive(params, "top_density");
    sizing.top.resolution = explicit_resolution(params, "top_resolution");
    return sizing;
}

/// Moves what a packing made into the strategy.
template <class Packed>
void add_packed(PreparedStrategy& prepared, Packed& packed) {
    std::move(packed.stats.begin(), packed.stats.end(), std::back_inserter(prepared.stats));
    prepared.inputs.append(std::move(packed.inputs));
}

/// Builds and packs, then gives the tables another form. `variant` may be null.
void pack_two_level_as(PreparedStrategy& prepared, const TextureLimits& limits,
                       AddressWidth address,
                       TwoLevelTextures (*variant)(const Scene&, TwoLevelTextures,
                                                   const TextureLimits&)) {
    const Params& params = prepared.params;
    const TwoLevelSizing sizing = two_level_sizing(params);
    const long atlas = params.integer("atlas");
    if (atlas < 16) {
        throw Error({"--param atlas", fmt::format("{}", atlas), "at least 16, one block",
                     "The default is 256."});
    }

    // Only a scene that moves pays for the room and for the grids that are kept. The other forms
    // are made from finished tables: they do not move.
    const bool moves = !prepared.scene->animation.empty() && variant == nullptr;
    const TwoLevelTexturesOptions options{
        .address = address,
        .cell_texture_limit = static_cast<uint32_t>(std::min(atlas, 65536L)),
        .triangles = triangle_options(params),
        .limits = limits,
        .moving = moves};
    const uint64_t built_before = triangle_grids_built();
    TwoLevelGrid grid = build_two_level_grid(*prepared.scene, sizing);
    const auto object_builds = static_cast<double>(triangle_grids_built() - built_before);
    const auto start = std::chrono::steady_clock::now();
    TwoLevelTextures packed = pack_two_level_textures(*prepared.scene, grid, options);
    if (variant != nullptr) packed = variant(*prepared.scene, std::move(packed), limits);
    prepared.stats = {{"build_ms", grid.build_ms, "both levels, all threads"},
                      {"pack_ms", ms_since(start), ""},
                      {"object_builds", object_builds, "object grids built so far"},
                      {"top_builds", 1.0, "top-level grids built so far"},
                      {"repacks", 0.0, "times the top level outgrew its room"}};
    add_packed(prepared, packed);
    if (moves) {
        prepared.moving.emplace<MovingTopLevel>(prepared.scene, std::move(grid), sizing.top,
                                                std::move(packed.places), options);
    }
}

void pack_two_level(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_two_level_as(prepared, limits, address_width(prepared.params), nullptr);
}

void pack_two_level_copies(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_two_level_as(prepared, limits, AddressWidth::single, with_copied_triangles);
}

void pack_two_level_virtual(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_two_level_as(prepared, limits, AddressWidth::single, with_virtual_arrays);
}

// ---- The two-level grid in buffers -------------------------------------------------------------

/// Where empty space is crossed at once, more and smaller cells pay.
constexpr double kBufferDensity = 16.0;

std::vector<ParamInfo> two_level_buffer_params() {
    std::vector<ParamInfo> params = two_level_sizing_params();
    params.front().default_value = fmt::format("{}", kBufferDensity);
    return params;
}

void pack_grid_as(PreparedStrategy& prepared, const TextureLimits& limits, BufferKind kind) {
    const TwoLevelSizing sizing = two_level_sizing(prepared.params);
    const uint64_t built_before = triangle_grids_built();
    TwoLevelGrid grid = build_two_level_grid(*prepared.scene, sizing, Duplicates::dropped);
    const double build_ms = grid.build_ms;
    const auto object_builds = static_cast<double>(triangle_grids_built() - built_before);
    const auto start = std::chrono::steady_clock::now();
    TwoLevelBuffers packed = pack_two_level_buffers(*prepared.scene, std::move(grid), limits, kind,
                                                    prepared.planes_form());
    prepared.stats = {{"build_ms", build_ms, "both levels, all threads"},
                      {"pack_ms", ms_since(start), ""},
                      {"object_builds", object_builds, "object grids built so far"},
                      {"top_builds", 1.0, "top-level grids built so far"}};
    if (!prepared.scene->animation.empty()) {
        prepared.moving.emplace<MovingTopBuffers>(prepared.scene, sizing.top, packed, limits);
    }
    add_packed(prepared, packed);
    prepared.param_constants.push_back({"has_top_level", has_top_level(prepared)});
    prepared.param_constants.push_back({"has_linear_maps", has_linear_maps(prepared)});
    prepared.param_constants.push_back({"has_several_objects", has_several_objects(prepared)});
}

void pack_in_buffers(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_grid_as(prepared, limits, BufferKind::texture);
}

void pack_in_blocks(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_grid_as(prepared, limits, BufferKind::block);
}

// ---- Irregular grids in buffers -----------------------------------------------------------------

std::vector<ParamInfo> irregular_grid_params() {
    using Type = ParamInfo::Type;
    const IrregularGridSettings settings;
    return {
        {"root_density",
         Type::real,
         fmt::format("{}", settings.top_density),
         "cells per triangle of an object before any is divided",
         {}},
        {"density",
         Type::real,
         fmt::format("{}", settings.density),
         "cells per triangle where a cell is divided (lambda)",
         {}},
        object_sizes_param("density"),
        {"cell_cost",
         Type::real,
         fmt::format("{}", settings.cell_cost),
         "cost of a step to a cell beside that of a triangle test",
         {}},
        {"expansions",
         Type::integer,
         fmt::format("{}", settings.expansions),
         "passes that widen cells over their neighbours",
         {}},
        {"top_density",
         Type::real,
         fmt::format("{}", TwoLevelSizing{}.top.density),
         "cells per instance of the top-level grid (lambda)",
         {}},
    };
}

void pack_irregular_grid(PreparedStrategy& prepared, const TextureLimits& limits, BufferKind kind) {
    const Params& params = prepared.params;
    const IrregularGridSettings settings{
        .top_density = positive(params, "root_density"),
        .density = positive(params, "density"),
        .cell_cost = positive(params, "cell_cost"),
        .expansions = static_cast<uint32_t>(std::clamp(params.integer("expansions"), 0L, 64L))};
    const GridSizing top{.density = positive(params, "top_density")};
    std::vector<double> densities;
    for (const GridSizing& size : object_sizes(params)) {
        if (size.resolution) {
            throw Error({"--param sizes", to_text(size), "densities, for irregular grids",
                         "Write for example 1,2,1."});
        }
        densities.push_back(size.density);
    }
    TwoLevelIrregularGrid grid =
        build_two_level_irregular_grid(*prepared.scene, settings, top, densities);
    const auto start = std::chrono::steady_clock::now();
    const auto object_builds = static_cast<double>(grid.objects.size());
    const double build_ms = grid.build_ms;
    TwoLevelBuffers packed = pack_irregular_grid_buffers(*prepared.scene, std::move(grid), limits,
                                                         kind, prepared.planes_form());
    prepared.stats = {{"build_ms", build_ms, "both levels, all threads"},
                      {"pack_ms", ms_since(start), ""},
                      {"object_builds", object_builds, "object grids built so far"},
                      {"top_builds", 1.0, "top-level grids built so far"}};
    if (!prepared.scene->animation.empty()) {
        prepared.moving.emplace<MovingTopBuffers>(prepared.scene, top, packed, limits);
    }
    add_packed(prepared, packed);
    prepared.param_constants.push_back({"has_top_level", has_top_level(prepared)});
    prepared.param_constants.push_back({"has_linear_maps", has_linear_maps(prepared)});
    prepared.param_constants.push_back({"has_several_objects", has_several_objects(prepared)});
}

void pack_irregular_in_buffers(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_irregular_grid(prepared, limits, BufferKind::texture);
}

void pack_irregular_in_blocks(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_irregular_grid(prepared, limits, BufferKind::block);
}

// ---- One grid over all instances in buffers -----------------------------------------------------

/// Of one cell size for all of a scene, what is fine in it sets the size.
constexpr double kFlatDensity = 64.0;

std::vector<ParamInfo> flat_grid_params() {
    using Type = ParamInfo::Type;
    return {
        {"density",
         Type::real,
         fmt::format("{}", kFlatDensity),
         "cells per triangle of all instances (lambda)",
         {}},
        {"resolution", Type::text, "auto", "cells of the grid, XxYxZ; overrides density", {}},
    };
}

void pack_flat_grid(PreparedStrategy& prepared, const TextureLimits& limits, BufferKind kind) {
    const GridSizing sizing{.density = positive(prepared.params, "density"),
                            .resolution = explicit_resolution(prepared.params, "resolution")};
    const PlanesForm form = prepared.planes_form();
    check_flat_grid_fits(*prepared.scene, limits, kind, form);
    FlatGrid grid = build_flat_grid(*prepared.scene, sizing);
    const double build_ms = grid.build_ms;
    const auto start = std::chrono::steady_clock::now();
    TwoLevelBuffers packed =
        pack_flat_grid_buffers(*prepared.scene, std::move(grid), limits, kind, form);
    prepared.stats = {{"build_ms", build_ms, "all threads"}, {"pack_ms", ms_since(start), ""}};
    add_packed(prepared, packed);
    prepared.param_constants.push_back({"has_top_level", false});
    prepared.param_constants.push_back({"has_linear_maps", has_linear_maps(prepared)});
    prepared.param_constants.push_back({"has_several_objects", has_several_objects(prepared)});
}

void pack_flat_in_buffers(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_flat_grid(prepared, limits, BufferKind::texture);
}

void pack_flat_in_blocks(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_flat_grid(prepared, limits, BufferKind::block);
}

// ---- Bounding volume hierarchies in buffers ----------------------------------------------------

std::vector<ParamInfo> bvh_params() {
    using Type = ParamInfo::Type;
    const BvhSettings settings;
    return {
        {"leaf_size",
         Type::integer,
         fmt::format("{}", settings.most_leaf),
         "triangles of a leaf, at most",
         {}},
        {"test_cost",
         Type::real,
         fmt::format("{}", settings.test_cost),
         "cost of a triangle test beside that of a node, for the surface area heuristic",
         {}},
    };
}

void pack_bvh(PreparedStrategy& prepared, const TextureLimits& limits, BufferKind kind) {
    BvhSettings settings;
    settings.most_leaf = static_cast<uint32_t>(
        std::clamp(prepared.params.integer("leaf_size"), 0L, long{kBvhMostLeaf} + 1));
    settings.test_cost = positive(prepared.params, "test_cost");
    const TwoLevelBvh bvh = build_two_level_bvh(*prepared.scene, settings);
    const auto start = std::chrono::steady_clock::now();
    BvhBuffers packed =
        pack_bvh_buffers(*prepared.scene, bvh, limits, kind, prepared.planes_form());
    prepared.stats = {{"build_ms", bvh.build_ms, "both levels, all threads"},
                      {"pack_ms", ms_since(start), ""}};
    add_packed(prepared, packed);
    prepared.param_constants.push_back({"has_top_level", has_top_level(prepared)});
    prepared.param_constants.push_back({"has_linear_maps", has_linear_maps(prepared)});
}

void pack_bvh_in_buffers(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_bvh(prepared, limits, BufferKind::texture);
}

void pack_bvh_in_blocks(PreparedStrategy& prepared, const TextureLimits& limits) {
    pack_bvh(prepared, limits, BufferKind::block);
}

// ---- All structures and storages ---------------------------------------------------------------

/// How one storage of one structure is parametrised, built and packed.
struct Packing {
    const char* structure;
    const char* storage;
    std::vector<ParamInfo> (*params)();
    void (*pack)(PreparedStrategy&, const TextureLimits&);
};

constexpr Packing kPackings[] = {
    {"two_level_grid", "texture2d", two_level_texture_params, pack_two_level},
    {"two_level_grid", "texture2d_copies", two_level_params, pack_two_level_copies},
    {"two_level_grid", "texture2d_virtual", two_level_params, pack_two_level_virtual},
    {"two_level_grid", "buffer", two_level_buffer_params, pack_in_buffers},
    {"two_level_grid", "ssbo", two_level_buffer_params, pack_in_blocks},
    {"irregular_grid", "buffer", irregular_grid_params, pack_irregular_in_buffers},
    {"irregular_grid", "ssbo", irregular_grid_params, pack_irregular_in_blocks},
    {"flat_grid", "buffer", flat_grid_params, pack_flat_in_buffers},
    {"flat_grid", "ssbo", flat_grid_params, pack_flat_in_blocks},
    {"bvh", "buffer", bvh_params, pack_bvh_in_buffers},
    {"bvh", "ssbo", bvh_params, pack_bvh_in_blocks},
};

const Packing& find_packing(const gl::StrategyInfo& info, const std::string& storage) {
    for (const Packing& packing : kPackings) {
        if (info.structure == packing.structure && storage == packing.storage) return packing;
    }
    throw Error({info.file, fmt::format("structure '{}' in storage '{}'", info.structure, storage),
                 "a pair that gpu_glsl/prepared_strategy.cpp knows how to pack",
                 "Add its builder and packing to kPackings there."});
}

Stat& find_stat(std::vector<Stat>& stats, const std::string& name) {
    const auto found =
        std::find_if(stats.begin(), stats.end(), [&](const Stat& s) { return s.name == name; });
    ONEPASS_CHECK(found != stats.end());
    return *found;
}

gl::ShaderConstant param_constant(const ParamInfo& info, const Params& params) {
    switch (info.type) {
        case ParamInfo::Type::real:
            return {info.name, static_cast<float>(params.real(info.name))};
        case ParamInfo::Type::integer:
            return {info.name, static_cast<int32_t>(params.integer(info.name))};
        case ParamInfo::Type::choice: {
            // A choice becomes its position in the list.
            const auto chosen =
                std::find(info.choices.begin(), info.choices.end(), params.text(info.name));
            return {info.name, static_cast<int32_t>(chosen - info.choices.begin())};
        }
        case ParamInfo::Type::text:
            break;
    }
    throw Error({"parameter '" + info.name + "'", "a text", "real, integer or choice",
                 "Shader constants have no texts: change the strategy's front matter."});
}

/// llvmpipe as of Mesa 22.3.
bool is_old_software(const Device& device) { return device.is_software && !device.jumps; }

}  // namespace

std::vector<std::string> PreparedStrategy::files_with(const std::string& entry_file) const {
    return {fmt::format("storage/{}/{}.glsl", info.structure, storage), info.file, entry_file};
}

bool PreparedStrategy::answers_any() const {
    return has(params, "any_hit") && params.integer("any_hit") == 1;
}

bool PreparedStrategy::any_shadow_query() const { return answers_any() && device.is_software; }

CastForm PreparedStrategy::fragment_form() const {
    const bool is_on = is_chosen(params, "pairs", device.jumps);
    return is_on ? CastForm::pairs : CastForm::single;
}

CastForm PreparedStrategy::compute_form(size_t rays) const {
    // A grid's walk through a top level does not do with so few registers (gpu_glsl/README.md: what
    // a GPU is bound by). That through a linear map is taken for as long: it was not measured.
    const bool has_short_walk =
        info.structure == "bvh" || (!has_top_level(*this) && !has_linear_maps(*this));
    // With no more rays than invocations run at once, none would take a second one.
    constexpr size_t kGroupSize = 1024;  // of shaders/entry/cast_compute_persistent.glsl
    const bool has_enough_rays = rays > device.processors * kGroupSize;
    const bool pays =
        !device.is_software && device.has_ballots && has_short_walk && has_enough_rays;
    const bool is_on = is_chosen(params, "persistent", pays);
    return is_on ? CastForm::persistent : CastForm::single;
}

bool PreparedStrategy::ends_loops() const { return is_old_software(device); }

PlanesForm PreparedStrategy::planes_form() const {
    if (!has(params, "records")) return PlanesForm::floats;
    const std::string& records = params.text("records");
    const bool is_fixed = records == "fixed" || (records == "auto" && device.is_software);
    return is_fixed ? PlanesForm::fixed : PlanesForm::floats;
}

std::vector<gl::ShaderConstant> PreparedStrategy::constants(bool count_work,
                                                            const SceneNeeds* needs,
                                                            Query query) const {
    std::vector<gl::ShaderConstant> all = {{"count_work", count_work},
                                           {"is_software", device.is_software},
                                           {"loads_texels_in_place", is_old_software(device)},
                                           {"ends_loops", ends_loops()},
                                           {"has_ballots", device.has_ballots},
                                           {"has_fixed_planes", planes_form() == PlanesForm::fixed},
                                           {"any_query", query == Query::any && answers_any()},
                                           {"any_shadow_query", any_shadow_query()}};
    all.insert(all.end(), param_constants.begin(), param_constants.end());
    if (needs != nullptr) {
        std::vector<gl::ShaderConstant> shading = shading_constants(*needs);
        if (!specialises(params)) shading = for_all_scenes(std::move(shading));
        std::move(shading.begin(), shading.end(), std::back_inserter(all));
    }
    return all;
}

std::vector<ParamInfo> strategy_params(const gl::StrategyInfo& info, const std::string& storage) {
    std::vector<ParamInfo> params = info.params;
    for (ParamInfo& param : find_packing(info, storage).params()) {
        params.push_back(std::move(param));
    }
    return params;
}

PreparedStrategy prepare_strategy(const gl::StrategyInfo& info, const std::string& storage,
                                  ScenePtr scene, const ParamValues& values, const Device& device) {
    PreparedStrategy prepared{.info = info,
                              .storage = storage,
                              .scene = std::move(scene),
                              .params = Params(info.name, strategy_params(info, storage), values),
                              .inputs = {},
                              .param_constants = {},
                              .stats = {},
                              .moving = {},
                              .device = device};
    for (const ParamInfo& param : info.params) {
        prepared.param_constants.push_back(param_constant(param, prepared.params));
    }
    find_packing(info, storage).pack(prepared, device.limits);
    const double structure_bytes = static_cast<double>(prepared.inputs.texture_bytes());
    prepared.inputs.append(pack_shading_tables(
        *prepared.scene, scene_needs(*prepared.scene, {}).smooth_normals, device.limits));
    prepared.stats.push_back(
        {"device_bytes", structure_bytes, "structure, without shading tables"});
    return prepared;
}

std::vector<ivec3> cells_of_triangle(const PreparedStrategy& prepared, uint32_t inst_id,
                                     uint32_t prim_id) {
    if (prepared.info.structure != "two_level_grid") return {};
    const Scene& scene = *prepared.scene;
    const bool drops_duplicates = prepared.storage == "buffer" || prepared.storage == "ssbo";
    const uint32_t object = scene.instances[inst_id].object;
    const UniformGrid grid = build_triangle_grid(
        scene.objects[object], two_level_sizing(prepared.params).of_object(object),
        drops_duplicates ? Duplicates::dropped : Duplicates::kept);
    std::vector<ivec3> cells;
    uvec3 cell(0);
    for (cell.z = 0; cell.z < grid.dims.z; ++cell.z) {
        for (cell.y = 0; cell.y < grid.dims.y; ++cell.y) {
            for (cell.x = 0; cell.x < grid.dims.x; ++cell.x) {
                const auto list = grid.cell_references(cell);
                if (std::binary_search(list.begin(), list.end(), prim_id)) cells.push_back(cell);
            }
        }
    }
    return cells;
}

TopLevelMove plan_move(const PreparedStrategy& prepared,
                       std::span<const Affine> world_from_object) {
    if (std::holds_alternative<std::monostate>(prepared.moving)) {
        const bool moves = !prepared.scene->animation.empty();
        throw Error(
            {fmt::format("moving instances with {}/{}", prepared.info.name, prepared.storage),
             moves ? "a storage that is packed once and for all"
                   : "a tracer of a scene without an animation",
             moves ? "one that can be packed again in part" : "a scene whose instances move",
             "Make a new tracer of the moved scene."});
    }
    const uint64_t built_before = triangle_grids_built();
    const auto* textures = std::get_if<MovingTopLevel>(&prepared.moving);
    TopLevelMove move = textures != nullptr
                            ? textures->plan(world_from_object)
                            : std::get<MovingTopBuffers>(prepared.moving).plan(world_from_object);
    const auto object_builds = static_cast<double>(triangle_grids_built() - built_before);
    move.counts = {{"object_builds", object_builds, ""}, {"top_builds", 1.0, ""}};
    if (textures != nullptr) move.counts.push_back({"repacks", move.repacked ? 1.0 : 0.0, ""});
    return move;
}

void commit_move(PreparedStrategy& prepared, TopLevelMove move) {
    if (auto* textures = std::get_if<MovingTopLevel>(&prepared.moving)) textures->commit(move);
    prepared.inputs.apply(std::move(move.changes));
    for (const Stat& count : move.counts) {
        find_stat(prepared.stats, count.name).value += count.value;
    }
    for (Stat& stat : move.stats) {
        Stat& own = find_stat(prepared.stats, stat.name);
        own.value = stat.value;
        if (!stat.note.empty()) own.note = std::move(stat.note);
    }
}

}  // namespace onepass
