// onepass: ray traversal strategies compared, with Embree as the ground truth. Reads the command
// line and turns errors into one line on stderr and an exit code; the commands do the rest.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "compare/cli/commands.h"
#include "compare/cli/session.h"
#include "compare/progress.h"
#include "core/error.h"

namespace {

using namespace onepass;
using namespace onepass::cli;

constexpr char kFooter[] =
    "SCENE is a built-in name ('onepass list scenes') or a file. Lengths are in scene units, times "
    "in ms,\nspeeds in Mrays/s (1e6 rays a second). Exit codes: 0 passed, 1 compared and failed, 2 "
    "bad input or\nusage, 3 no usable device, 4 internal error, 130 stopped by Ctrl-C.";

int report_error(ExitCode code, const std::string& message) {
    fmt::print(stderr, "onepass: error: {}\n", message);
    return code;
}

void add_global_options(CLI::App& app, GlobalOptions& globals) {
    app.add_option("--gl", globals.gl,
                   "OpenGL context: auto, osmesa (software) or egl (a GPU, or Mesa). auto: egl if "
                   "--device is given, else osmesa where it works, else egl")
        ->check(CLI::IsMember({"auto", "osmesa", "egl"}))
        ->capture_default_str();
    app.add_option("--device", globals.device,
                   "EGL device number ('onepass list devices'); default: the first that works")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--seed", globals.seed, "Seed of random rays, run order and bootstrap")
        ->capture_default_str();
}

int run(int argc, char** argv) {
    Session session({argv, argv + argc});
    CLI::App app(
        "Compares ray traversal strategies for correctness and speed, with Embree as the "
        "ground truth.",
        "onepass");
    app.footer(kFooter);
    app.require_subcommand(1);
    app.fallthrough();
    add_global_options(app, session.globals);
    add_doctor(app, session);
    add_list(app, session);
    add_render(app, session);
    add_check(app, session);
    add_explain(app, session);
    add_bench(app, session);
    add_tune(app, session);
    add_compare(app, session);
    add_grow(app, session);
    add_stress(app, session);
    add_reproduce(app, session);
    add_merge(app, session);
    add_report(app, session);
    add_shader(app, session);
    add_scenes(app, session);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        const std::vector<std::string> unknown = app.remaining();
        const bool no_command = app.get_subcommands().empty() && !unknown.empty();
        return report_error(
            kBadInput, fmt::format("{} ('onepass --help' explains)",
                                   no_command ? fmt::format("'{}' is no command", unknown.front())
                                              : error.what()));
    }
    return session.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        catch_interrupts();
        return run(argc, argv);
    } catch (const Error& error) {
        return report_error(error.kind() == Error::Kind::device ? kNoDevice : kBadInput,
                            error.what());
    } catch (const std::exception& error) {
        return report_error(kInternal,
                            fmt::format("{} (this is a fault of onepass)", error.what()));
    }
}
