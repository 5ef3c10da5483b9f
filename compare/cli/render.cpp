// onepass render: one scene, one strategy, one image, with AOVs if asked.
#include <memory>

#include <fmt/format.h>

#include "compare/aovs.h"
#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/image_io.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct RenderCommand {
    std::string scene;
    std::string strategy;
    std::vector<std::string> params;
    std::string size = "512x512";
    std::string output;
    std::vector<std::string> aovs;
    uint32_t camera = 0;
    uint32_t depth = RenderSettings{}.max_depth;
    bool no_shadows = false;
};

fs::path output_path(const RenderCommand& options) {
    if (!options.output.empty()) return options.output;
    const std::string stem = fs::path(options.scene).stem().string();
    return file_name_part(stem) + (image_files_supported() ? ".png" : ".npy");
}

/// Everything that can be wrong with the output is found before anything is computed.
void check_output(const fs::path& path, const std::vector<std::string>& aovs) {
    check_writable(path);
    const std::string extension = path.extension().string();
    if (extension != ".png" && extension != ".exr" && extension != ".npy") {
        throw Error({"-o " + path.string(), fmt::format("extension '{}'", extension),
                     ".png, .exr or .npy", "Change the name."});
    }
    if (extension != ".npy" && !image_files_supported()) {
        throw Error({"-o " + path.string(), "a build without OpenImageIO", "a name in .npy",
                     "Write .npy, or build with ONEPASS_WITH_OPENIMAGEIO=ON."});
    }
    if (extension == ".png" && aovs != std::vector<std::string>{"color"}) {
        throw Error({"--aov", "other outputs than color for a PNG", "a name in .exr or .npy",
                     "Choose another name with -o."});
    }
    aov_channels(Frame{}, aovs);  // throws for an unknown name
}

/// A tracer that does not count would answer 0, which looks like a figure.
void refuse_counters(const std::string& strategy, const std::vector<std::string>& aovs) {
    for (const std::string& name : aovs) {
        if (name != "cells" && name != "tests" && name != "references") continue;
        throw Error({"--aov", fmt::format("'{}' of {}, which does not count", name, strategy),
                     "an output that the strategy gives",
                     "Leave it out, or choose another with -s."});
    }
}

void write_frame(const fs::path& path, const Frame& frame, const std::vector<std::string>& aovs) {
    if (path.extension() == ".png") {
        write_png(path, tone_mapped(frame));
    } else if (path.extension() == ".exr") {
        write_exr(path, frame.width, frame.height, aov_channels(frame, aovs));
    } else {
        write_channels_npy(path, frame.width, frame.height, aov_channels(frame, aovs));
    }
}

void run(Session& session, const RenderCommand& options) {
    // Read the options.
    StrategyOptions strategy{{}, options.params};
    if (!options.strategy.empty()) strategy.patterns = {options.strategy};
    SelectedStrategy selected = select_strategies(session.catalogue, strategy).front();
    const ImageSize size = parse_size(options.size);
    const std::vector<std::string> aovs =
        options.aovs.empty() ? std::vector<std::string>{"color"} : options.aovs;
    const fs::path path = output_path(options);
    check_output(path, aovs);

    // Load.
    const OpenScene open = open_scene(options.scene);
    const Scene& scene = *open.scene;
    if (options.camera >= scene.cameras.size()) {
        throw Error({"--camera", std::to_string(options.camera),
                     fmt::format("0 to {}", scene.cameras.size() - 1), "Choose another."});
    }

    // Render.
    const std::unique_ptr<Tracer> tracer = selected.entry->make(open.scene, selected.params);
    if (!tracer->capabilities().render) {
        throw Error({selected.entry->info.name, "a strategy that only casts rays",
                     "one that renders images", "Choose another with -s."});
    }
    if (!tracer->capabilities().counters) refuse_counters(selected.entry->info.name, aovs);
    // Always with AOVs: they carry the flags, and an exhausted loop must be said.
    const RenderSettings settings{size.width, size.height, options.depth, !options.no_shadows,
                                  true};
    const Frame frame = tracer->render(scene.cameras[options.camera], settings);
    write_frame(path, frame, aovs);

    // Say what was done.
    size_t exhausted = 0;
    for (const uint32_t flags : frame.flags) exhausted += (flags & kFlagExhausted) != 0;
    fmt::print(stderr, "onepass: wrote {}: {} x {} pixels, {}, {:.1f} ms on {}\n", path.string(),
               frame.width, frame.height, tracer->name(), frame.wall_ms,
               tracer->capabilities().device);
    if (exhausted > 0) {
        fmt::print(stderr, "onepass: {} pixels ran out of their loop budget\n", exhausted);
    }
}

}  // namespace

void add_render(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand("render", "Renders one image of a scene");
    auto options = std::make_shared<RenderCommand>();
    std::string aov_help;
    for (const std::string& name : aov_names()) aov_help += (aov_help.empty() ? "" : ", ") + name;
    command->add_option("scene", options->scene, "Scene name or file")->required();
    command
        ->add_option("-s,--strategy", options->strategy,
                     "Strategy: NAME[/STORAGE[/ENTRY]]; default: the first that is neither "
                     "Embree nor a twin")
        ->type_name("NAME");
    command->add_option("--param", options->params, "A strategy's parameter; may be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    command->add_option("--size", options->size, "Image size in pixels")
        ->type_name("WxH")
        ->capture_default_str();
    command
        ->add_option("-o,--output", options->output,
                     "File: .png (8-bit sRGB colour), .exr (32-bit, named channels) or .npy "
                     "(structured array). Default: the scene's name with .png")
        ->type_name("FILE");
    command
        ->add_option(
            "--aov", options->aovs,
            fmt::format("Outputs of an .exr or .npy, by commas: {}. Default: color", aov_help))
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
    command->add_option("--camera", options->camera, "Which of the scene's cameras, from 0")
        ->capture_default_str();
    command
        ->add_option("--depth", options->depth,
                     "Mirror bounces after the primary ray; 0 turns reflections off")
        ->capture_default_str();
    command->add_flag("--no-shadows", options->no_shadows, "Casts no shadow rays");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
