// onepass render: one scene, one strategy, one image, with AOVs if asked; or the frames of its
// animation (render_frames.cpp).
#include "compare/cli/render.h"

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

}  // namespace

std::string output_path(const RenderCommand& options) {
    if (!options.output.empty()) return options.output;
    const std::string stem = fs::path(options.scene).stem().string();
    return file_name_part(stem) + (options.frames.empty() ? "" : ".%04d") +
           (image_files_supported() ? ".png" : ".npy");
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

size_t exhausted_pixels(const Frame& frame) {
    size_t exhausted = 0;
    for (const uint32_t flags : frame.flags) exhausted += (flags & kFlagExhausted) != 0;
    return exhausted;
}

Stage set_up(Session& session, const RenderCommand& options, const fs::path& output) {
    Stage stage;
    StrategyOptions strategy{{}, options.params};
    if (!options.strategy.empty()) strategy.patterns = {options.strategy};
    stage.strategy = select_strategies(session.catalogue, strategy).front();
    const ImageSize size = parse_size(options.size);
    stage.aovs = options.aovs.empty() ? std::vector<std::string>{"color"} : options.aovs;
    check_output(output, stage.aovs);

    stage.open = open_scene(options.scene);
    const Scene& scene = *stage.open.scene;
    if (options.camera >= scene.cameras.size()) {
        throw Error({"--camera", std::to_string(options.camera),
                     fmt::format("0 to {}", scene.cameras.size() - 1), "Choose another."});
    }
    if (!options.frames.empty() && scene.animation.empty()) {
        throw Error({"--frames", fmt::format("'{}', in which nothing moves", options.scene),
                     "a scene with an animation",
                     "Leave --frames out, or choose another scene, for instance balls-1."});
    }
    stage.camera = scene.cameras[options.camera];
    // Always with AOVs: they carry the flags, and an exhausted loop must be said.
    stage.settings = {size.width, size.height, options.depth, !options.no_shadows, true};

    stage.strategy =
        sized(session, stage.open, {stage.strategy}, options.sizing, {"primary"}, options.camera)
            .front();
    const std::string& name = stage.strategy.entry->info.name;
    stage.tracer = stage.strategy.entry->make(stage.open.scene, stage.strategy.params);
    if (!stage.tracer->capabilities().render) {
        throw Error({name, "a strategy that only casts rays", "one that renders images",
                     "Choose another with -s."});
    }
    if (!stage.tracer->capabilities().counters) refuse_counters(name, stage.aovs);
    return stage;
}

namespace {

void render_still(Session& session, const RenderCommand& options) {
    const fs::path path = output_path(options);
    const Stage stage = set_up(session, options, path);
    const Tracer* tracer = stage.tracer.get();
    const Frame frame = stage.tracer->render(stage.camera, stage.settings);
    write_frame(path, frame, stage.aovs);

    const size_t exhausted = exhausted_pixels(frame);
    fmt::print(stderr, "onepass: wrote {}: {} x {} pixels, {}, {:.1f} ms on {}\n", path.string(),
               frame.width, frame.height, tracer->name(), frame.wall_ms,
               tracer->capabilities().device);
    if (exhausted > 0) {
        fmt::print(stderr, "onepass: {} pixels ran out of their loop budget\n", exhausted);
    }
}

void run(Session& session, const RenderCommand& options) {
    if (options.frames.empty()) {
        render_still(session, options);
    } else {
        render_frames(session, options);
    }
}

}  // namespace

void add_render(CLI::App& app, Session& session) {
    CLI::App* command =
        app.add_subcommand("render", "Renders one image of a scene, or frames of its animation");
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
    add_sizing_options(*command, options->sizing);
    command->add_option("--size", options->size, "Image size in pixels")
        ->type_name("WxH")
        ->capture_default_str();
    command
        ->add_option("-o,--output", options->output,
                     "File: .png (8-bit sRGB colour), .exr (32-bit, named channels) or .npy "
                     "(structured array). Default: the scene's name with .png. With --frames a "
                     "pattern: frame.%04d.png")
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
    CLI::Option* frames =
        command
            ->add_option(
                "--frames", options->frames,
                "Frames of the animation, both included, into one file each; frame k is at "
                "k / fps s, modulo the animation's duration")
            ->type_name("A..B");
    command->add_option("--fps", options->fps, "Frames a second")
        ->check(CLI::PositiveNumber)
        ->needs(frames)
        ->capture_default_str();
    command
        ->add_flag(
            "--check,!--no-check", options->check,
            "Compares each frame with Embree's: exit code 1 if an image differs by more than "
            "its bound; primary hits are classed beside (default: yes)")
        ->needs(frames);
    command
        ->add_flag("--resume", options->resume,
                   "Leaves frames alone whose file is there; they are not checked again")
        ->needs(frames);
    command
        ->add_option("--json", options->json,
                     "Writes times and comparisons of the frames; '-' is standard output")
        ->type_name("FILE")
        ->needs(frames);
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
