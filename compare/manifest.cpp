#include "compare/manifest.h"

#include <chrono>
#include <filesystem>
#include <fstream>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sched.h>

#include "compare/build_info.h"  // made by CMake at every build
#include "compare/hash.h"

namespace onepass {

Manifest make_manifest(std::vector<std::string> arguments, uint64_t seed) {
    Manifest manifest;
    manifest.arguments = std::move(arguments);
    if (!manifest.arguments.empty()) {
        std::string& program = manifest.arguments.front();
        program = std::filesystem::path(program).filename().string();
    }
    manifest.time_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    manifest.commit = kBuildCommit;
    manifest.dirty = kBuildDirty;
    manifest.program_hash = program_hash();
    manifest.build_type = kBuildType;
    manifest.compiler = fmt::format("g++ {}", __VERSION__);
    std::ifstream cpuinfo("/proc/cpuinfo");
    manifest.cpu = cpu_model(cpuinfo);
    manifest.cores = usable_cores();
    manifest.seed = seed;
    return manifest;
}

std::string program_hash() {
    static const std::string hash = [] {
        std::ifstream program("/proc/self/exe", std::ios::binary);
        if (!program) return std::string("unknown");
        Fnv1a64 sum;
        std::vector<char> block(1 << 20);
        while (program.read(block.data(), static_cast<std::streamsize>(block.size())),
               program.gcount() > 0) {
            sum.add(block.data(), static_cast<size_t>(program.gcount()));
        }
        return hash_text(sum.value());
    }();
    return hash;
}

std::string cpu_model(std::istream& cpuinfo) {
    for (std::string line; std::getline(cpuinfo, line);) {
        const size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown";
}

uint32_t usable_cores() {
    cpu_set_t mask;
    CPU_ZERO(&mask);
    if (sched_getaffinity(0, sizeof mask, &mask) != 0) return 1;
    return static_cast<uint32_t>(CPU_COUNT(&mask));
}

SceneRecord make_scene_record(const std::string& name, const LoadedScene& loaded) {
    SceneRecord record;
    record.name = name;
    record.triangles = instanced_triangle_count(loaded.scene);
    for (const Object& object : loaded.scene.objects) {
        record.unique_triangles += object.triangles.size();
    }
    record.instances = loaded.scene.instances.size();
    record.lights = loaded.scene.lights.size();
    record.hash = hash_text(hash_scene(loaded.scene));
    record.notes = loaded.notes;
    return record;
}

TracerRecord make_tracer_record(const std::string& scene, const Tracer& tracer,
                                const TracerInfo& info, const ParamValues& given) {
    const Capabilities capabilities = tracer.capabilities();
    TracerRecord record;
    record.scene = scene;
    record.name = info.name;
    record.params = Params(info.name, info.params, given).values();
    record.device = capabilities.device;
    record.software_renderer = capabilities.software_renderer;
    record.is_oracle = info.is_oracle;
    record.is_twin = info.is_twin;
    record.threads = capabilities.threads;
    record.shader_hash = capabilities.shader_hash;
    record.stats = tracer.stats();
    record.deviations = info.deviations;
    return record;
}

double stat_value(const std::vector<Stat>& stats, const std::string& name) {
    for (const Stat& stat : stats) {
        if (stat.name == name) return stat.value;
    }
    return 0.0;
}

}  // namespace onepass
