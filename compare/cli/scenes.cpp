// onepass scenes export: a scene as glTF, to look at it elsewhere or to hand it on.
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

struct ExportCommand {
    std::string scene;
    std::string output;
    bool unshared = false;
    bool flat = false;
};

Scene form_asked_for(const Scene& scene, const ExportCommand& options) {
    if (options.unshared) return unshared(scene);
    if (options.flat) return flattened(scene);
    return scene;
}

void run(const ExportCommand& options) {
    const std::filesystem::path path = options.output;
    check_writable(path);
    if (path.extension() != ".glb" && path.extension() != ".gltf") {
        throw Error({"-o " + path.string(),
                     fmt::format("extension '{}'", path.extension().string()), ".glb or .gltf",
                     "Change the name."});
    }
    write_gltf(form_asked_for(*open_scene(options.scene).scene, options), path);
    fmt::print(stderr, "onepass: wrote {}\n", path.string());
}

}  // namespace

void add_scenes(CLI::App& app, Session&) {
    CLI::App* scenes = app.add_subcommand("scenes", "Works with scenes");
    scenes->require_subcommand(1);
    CLI::App* command = scenes->add_subcommand("export", "Writes a scene as glTF 2.0");
    auto options = std::make_shared<ExportCommand>();
    command->add_option("scene", options->scene, "Scene name or file")->required();
    command
        ->add_option("-o,--output", options->output, "File: .glb, or .gltf with a .bin beside it")
        ->required()
        ->type_name("FILE");
    auto* share = command->add_flag("--unshared", options->unshared,
                                    "Gives each instance an object of its own");
    command
        ->add_flag("--flat", options->flat,
                   "Makes one object in one instance of all, in world space; nothing moves")
        ->excludes(share);
    command->callback([options] { run(*options); });
}

}  // namespace onepass::cli
