#include "gpu_glsl/glsl_tracers.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "gpu_glsl/brute_force.h"
#include "gpu_glsl/gpu_tracer.h"
#include "gpu_glsl/prepared_strategy.h"
#include "gpu_glsl/streaming/streaming_tracer.h"
#include "gpu_glsl/twin/twin_unit.h"
#include "gpu_glsl/twin_tracer.h"

namespace onepass {
namespace {

std::string tracer_name(const gl::StrategyInfo& info, const std::string& storage,
                        const std::string& entry) {
    return fmt::format("{}/{}/{}", info.name, storage, entry);
}

/// What a catalogue entry shows, but for the summary's ending.
TracerInfo tracer_info(const gl::StrategyInfo& info, const std::string& storage,
                       const std::string& entry, const std::string& how) {
    return {.name = tracer_name(info, storage, entry),
            .summary = info.summary + ", " + how,
            .source = info.source,
            .params = strategy_params(info, storage),
            .deviations = info.deviations,
            .by_default = info.by_default};
}

/// Those of a software renderer are the machine's. Where a GPU does not tell, more than there are
/// cost little, fewer would leave some idle (gpu_glsl/README.md: 256 groups on 132).
uint32_t processors_of(const gl::GlContext& context) {
    constexpr uint32_t kUnknown = 256;
    if (context.limits().processors > 0) return static_cast<uint32_t>(context.limits().processors);
    return context.description().software ? std::max(1u, std::thread::hardware_concurrency())
                                          : kUnknown;
}

Device device_of(const gl::GlContext& context) {
    const gl::GlLimits& limits = context.limits();
    return {.limits = {.max_2d = static_cast<uint32_t>(limits.max_texture_size),
                       .max_3d = static_cast<uint32_t>(limits.max_3d_texture_size),
                       .max_buffer = static_cast<uint64_t>(limits.max_texture_buffer_size),
                       .max_block = static_cast<uint64_t>(limits.max_ssbo_bytes)},
            .is_software = context.description().software,
            .jumps = context.description().jumps,
            .has_ballots = context.description().has_ballots,
            .processors = processors_of(context)};
}

/// The units of a strategy in one storage. Throws: Error if the front matter and the build differ.
std::vector<const twin::Unit*> twin_units_of(const gl::StrategyInfo& info,
                                             const std::string& storage) {
    std::vector<const twin::Unit*> found;
    for (const twin::Unit& unit : twin::units()) {
        if (unit.strategy == info.name && unit.storage == storage) found.push_back(&unit);
    }
    const size_t expected = info.twin ? 2 : 0;
    if (found.size() != expected) {
        throw Error({info.file,
                     fmt::format("{} twins of storage '{}' in this binary", found.size(), storage),
                     fmt::format("{}, by its front matter", expected),
                     "Build again, so that CMake reads the strategy files; a strategy read from a "
                     "folder at run time must say 'twin: none REASON'."});
    }
    return found;
}

using LibraryPtr = std::shared_ptr<const gl::ShaderLibrary>;

CatalogueEntry gpu_entry(const LibraryPtr& library, const gl::StrategyInfo& info,
                         const std::string& storage, const std::string& entry_name,
                         const GlContextProvider& context) {
    const GpuEntry entry = entry_name == "compute" ? GpuEntry::compute : GpuEntry::fragment;
    CatalogueEntry result;
    result.info = tracer_info(info, storage, entry_name, "in a " + entry_name + " shader");
    result.make = [=](ScenePtr scene, const ParamValues& values) {
        gl::GlContext& gl_context = context();
        return make_gpu_tracer(
            tracer_name(info, storage, entry_name),
            prepare_strategy(info, storage, std::move(scene), values, device_of(gl_context)), entry,
            *library, gl_context);
    };
    return result;
}

CatalogueEntry twin_entry(const gl::StrategyInfo& info, const std::string& storage,
                          const twin::Unit& unit) {
    const std::string name = fmt::format("twin{}", unit.bits);
    CatalogueEntry result;
    result.info = tracer_info(info, storage, name,
                              fmt::format("its shader text as C++ in {} bits", unit.bits));
    result.info.is_twin = true;
    result.make = [=](ScenePtr scene, const ParamValues& values) {
        return make_twin_tracer(tracer_name(info, storage, name),
                                prepare_strategy(info, storage, std::move(scene), values, {}),
                                unit);
    };
    return result;
}

/// Streaming takes many passes, so it is no strategy file: a C++ tracer over paper's structure.
std::vector<CatalogueEntry> streaming_entries(const LibraryPtr& library,
                                              const gl::StrategyInfo& paper,
                                              const GlContextProvider& context) {
    const std::string storage = "texture2d";
    const gl::StrategyInfo info = streaming_info(paper);
    std::vector<CatalogueEntry> entries;
    for (const std::string& entry_name : info.entries) {
        const GpuEntry entry = entry_name == "compute" ? GpuEntry::compute : GpuEntry::fragment;
        CatalogueEntry result;
        result.info = tracer_info(info, storage, entry_name, "in " + entry_name + " shaders");
        result.make = [=](ScenePtr scene, const ParamValues& values) {
            gl::GlContext& gl_context = context();
            return make_streaming_tracer(
                tracer_name(info, storage, entry_name),
                prepare_strategy(info, storage, std::move(scene), values, device_of(gl_context)),
                entry, *library, gl_context);
        };
        entries.push_back(std::move(result));
    }
    return entries;
}

}  // namespace

std::vector<CatalogueEntry> glsl_tracers(const gl::ShaderLibrary& library,
                                         GlContextProvider context) {
    const auto shared = std::make_shared<const gl::ShaderLibrary>(library);
    std::vector<CatalogueEntry> entries;
    for (const gl::StrategyInfo& info : shared->strategies()) {
        for (const std::string& storage : info.storages) {
            for (const std::string& entry : info.entries) {
                entries.push_back(gpu_entry(shared, info, storage, entry, context));
            }
            for (const twin::Unit* unit : twin_units_of(info, storage)) {
                entries.push_back(twin_entry(info, storage, *unit));
            }
        }
        if (info.name == "paper") {
            for (CatalogueEntry& entry : streaming_entries(shared, info, context)) {
                entries.push_back(std::move(entry));
            }
        }
    }
    for (CatalogueEntry& entry : brute_force_tracers(shared, context)) {
        entries.push_back(std::move(entry));
    }
    return entries;
}

gl::ComposedShader compose_tracer_shader(const gl::ShaderLibrary& library, const std::string& name,
                                         ScenePtr scene, const ParamValues& params,
                                         const RenderSettings* settings) {
    for (const gl::StrategyInfo& info : library.strategies()) {
        for (const std::string& storage : info.storages) {
            for (const std::string& entry_name : info.entries) {
                if (tracer_name(info, storage, entry_name) != name) continue;
                const GpuEntry entry =
                    entry_name == "compute" ? GpuEntry::compute : GpuEntry::fragment;
                const PreparedStrategy prepared = prepare_strategy(
                    info, storage, scene, params, {.limits = {}, .has_ballots = true});
                SceneNeeds needs;
                if (settings != nullptr) needs = scene_needs(*scene, *settings);
                constexpr int kNewestGl = 450;
                const std::string file = settings != nullptr
                                             ? render_file(entry)
                                             : cast_file(entry, cast_form(prepared, entry));
                return library.compose({.glsl_version = glsl_version_for(info, entry, kNewestGl),
                                        .stage = entry_name,
                                        .files = prepared.files_with(file),
                                        .constants = prepared.constants(
                                            false, settings != nullptr ? &needs : nullptr)});
            }
        }
    }
    throw Error({"shader variant", "'" + name + "'", "the full name of a GPU tracer",
                 "See `onepass list strategies`; twins and Embree have no shader, and tracers of "
                 "several passes not a single one."});
}

}  // namespace onepass
