// onepass doctor: what this machine can run, what is missing, and how to get it.
#include <algorithm>

#include <fmt/format.h>

#include "compare/cli/commands.h"
#include "compare/cli/table.h"
#include "compare/image_io.h"
#include "compare/manifest.h"
#include "core/error.h"
#include "core/io/load.h"
#include "scenes/scenes.h"

namespace onepass::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

void show(const std::string& title, const Rows& rows) {
    fmt::print("{}\n{}", title, format_list(rows));
}

Rows program_rows(const Session& session) {
    const Manifest manifest = session.manifest();
    return {{"build", fmt::format("{}, {}, commit {}{}", manifest.build_type, manifest.compiler,
                                  manifest.commit, manifest.dirty ? " with changes" : "")},
            {"CPU", fmt::format("{}, {} usable cores", manifest.cpu, manifest.cores)},
            {"Embree", manifest.embree},
            {"PNG and EXR", image_files_supported()
                                ? image_io_description()
                                : "not built in: AOVs are written as .npy. Remedy: build with "
                                  "ONEPASS_WITH_OPENIMAGEIO=ON"},
            {"mesh files", mesh_files_supported()
                               ? "glTF, and OBJ, PLY, STL and others through Assimp"
                               : "glTF only. Remedy: build with ONEPASS_WITH_ASSIMP=ON"}};
}

Rows context_rows(const std::vector<gl::GlProbe>& probes) {
    Rows rows;
    for (const gl::GlProbe& probe : probes) {
        const std::string place =
            probe.device == gl::kAnyDevice
                ? fmt::format("--gl {}", probe.kind)
                : fmt::format("--gl {} --device {}", probe.kind, probe.device);
        rows.push_back({place, probe.usable ? fmt::format("{}, {}{}", probe.renderer, probe.version,
                                                          probe.software ? " (software)" : "")
                                            : fmt::format("not usable: {}", probe.problem)});
    }
    return rows;
}

Rows scene_rows() {
    Rows rows;
    for (const SceneInfo& info : builtin_scenes()) {
        try {
            const Scene scene = load_scene(info.name).scene;
            rows.push_back(
                {info.name, fmt::format("{} triangles", instanced_triangle_count(scene))});
        } catch (const Error& error) {
            rows.push_back({info.name, fmt::format("missing. {}", error.parts().remedy)});
        }
    }
    return rows;
}

}  // namespace

void add_doctor(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "doctor", "Says what this machine can run, what is missing, and how to get it");
    command->callback([&session] {
        const std::vector<gl::GlProbe> probes = gl::probe_contexts();
        show("program", program_rows(session));
        show("OpenGL", context_rows(probes));
        show("scenes", scene_rows());
        const bool usable = std::any_of(probes.begin(), probes.end(),
                                        [](const gl::GlProbe& probe) { return probe.usable; });
        if (!usable) {
            fmt::print(
                "No OpenGL context can be made: shaders cannot run here. Install libosmesa6 "
                "or a driver with EGL.\n");
            session.exit_code = kNoDevice;
        }
    });
}

}  // namespace onepass::cli
