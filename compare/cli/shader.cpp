// onepass shader: the composed text of a GPU tracer's shader, as the driver gets it.
#include <memory>

#include <fmt/format.h>

#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "gpu_glsl/glsl_tracers.h"

namespace onepass::cli {
namespace {

struct ShaderCommand {
    std::string variant;
    std::string scene = "balls-1";
    std::vector<std::string> params;
    std::string entry = "render";
    uint32_t depth = RenderSettings{}.max_depth;
    bool no_shadows = false;
};

void run(Session& session, const ShaderCommand& options) {
    const SelectedStrategy selected =
        select_strategies(session.catalogue, {{options.variant}, options.params}).front();
    const OpenScene open = open_scene(options.scene);
    const RenderSettings settings{.max_depth = options.depth, .shadows = !options.no_shadows};
    const gl::ComposedShader shader =
        compose_tracer_shader(gl::ShaderLibrary::embedded(), selected.entry->info.name, open.scene,
                              selected.params, options.entry == "render" ? &settings : nullptr);
    fmt::print("{}", shader.text);
    fmt::print(stderr, "onepass: {} of {}, {} bytes, hash {}\n", options.entry,
               selected.entry->info.name, shader.text.size(), shader.hash);
}

}  // namespace

void add_shader(CLI::App& app, Session& session) {
    CLI::App* command =
        app.add_subcommand("shader", "Prints the composed shader text of one variant");
    auto options = std::make_shared<ShaderCommand>();
    command->add_option("--variant", options->variant, "Strategy: NAME[/STORAGE[/ENTRY]]")
        ->required()
        ->type_name("NAME");
    command->add_option("--scene", options->scene, "Scene whose needs the variant is made for")
        ->capture_default_str();
    command->add_option("--param", options->params, "A strategy's parameter; may be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    command->add_option("--entry", options->entry, "render (a whole image) or cast (given rays)")
        ->check(CLI::IsMember({"render", "cast"}))
        ->capture_default_str();
    command->add_option("--depth", options->depth, "Mirror bounces after the primary ray")
        ->capture_default_str();
    command->add_flag("--no-shadows", options->no_shadows, "Casts no shadow rays");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
