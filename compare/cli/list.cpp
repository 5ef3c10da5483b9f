// onepass list: strategies with their parameters, scenes with their counts, GL devices.
#include <memory>

#include <fmt/format.h>

#include "compare/cli/commands.h"
#include "compare/cli/table.h"
#include "core/error.h"
#include "scenes/scenes.h"

namespace onepass::cli {
namespace {

std::string param_text(const ParamInfo& param) {
    std::string choices;
    for (const std::string& choice : param.choices) {
        choices += (choices.empty() ? " (" : ", ") + choice;
    }
    return param.summary + (choices.empty() ? "" : choices + ")");
}

void list_strategies(const Session& session) {
    for (const CatalogueEntry& entry : session.catalogue.entries()) {
        const TracerInfo& info = entry.info;
        fmt::print("{}\n  {}\n", info.name, info.summary);
        if (!info.source.empty()) fmt::print("  source: {}\n", info.source);
        std::vector<std::vector<std::string>> rows;
        for (const ParamInfo& param : info.params) {
            rows.push_back(
                {fmt::format("--param {}={}", param.name, param.default_value), param_text(param)});
        }
        fmt::print("{}", format_list(rows));
    }
}

/// Counts are those of the scenes themselves, made or read for it.
void list_scenes() {
    std::vector<std::vector<std::string>> rows = {
        {"scene", "triangles", "instances", "lights", "what it is", "from"}};
    for (const SceneInfo& info : builtin_scenes()) {
        const std::string fetch = how_to_fetch(info.name);
        if (!fetch.empty()) {
            rows.push_back({info.name, "not fetched", "-", "-", info.summary,
                            fmt::format("{}; `{}` fetches it", info.source, fetch)});
            continue;
        }
        const Scene scene = load_scene(info.name).scene;
        rows.push_back({info.name, std::to_string(instanced_triangle_count(scene)),
                        std::to_string(scene.instances.size()), std::to_string(scene.lights.size()),
                        info.summary, info.source});
    }
    fmt::print("{}\n{}\n", format_list(rows, ""), kStandInNote);
}

void list_devices() {
    std::vector<std::vector<std::string>> rows = {{"--gl", "--device", "renderer", "version", ""}};
    for (const gl::GlProbe& probe : gl::probe_contexts()) {
        const std::string device =
            probe.device == gl::kAnyDevice ? "-" : std::to_string(probe.device);
        if (probe.usable) {
            rows.push_back({probe.kind, device, probe.renderer, probe.version,
                            probe.software ? "software: runs on the CPU" : ""});
        } else {
            rows.push_back({probe.kind, device, probe.name, "not usable", probe.problem});
        }
    }
    fmt::print("{}", format_list(rows, ""));
}

}  // namespace

void add_list(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand("list", "Lists strategies, scenes or devices");
    auto what = std::make_shared<std::string>("strategies");
    command->add_option("what", *what, "strategies, scenes or devices")
        ->check(CLI::IsMember({"strategies", "scenes", "devices"}))
        ->capture_default_str();
    command->callback([&session, what] {
        if (*what == "strategies") list_strategies(session);
        if (*what == "scenes") list_scenes();
        if (*what == "devices") list_devices();
    });
}

}  // namespace onepass::cli
