// The commands of `onepass`: each adds itself to the program and runs when it was named.
#pragma once

#include <CLI/CLI.hpp>

#include "compare/cli/session.h"

namespace onepass::cli {

void add_doctor(CLI::App& app, Session& session);
void add_list(CLI::App& app, Session& session);
void add_render(CLI::App& app, Session& session);
void add_check(CLI::App& app, Session& session);
void add_explain(CLI::App& app, Session& session);
void add_bench(CLI::App& app, Session& session);
void add_tune(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_grow(CLI::App& app, Session& session);
void add_stress(CLI::App& app, Session& session);
void add_reproduce(CLI::App& app, Session& session);
void add_merge(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);
void add_shader(CLI::App& app, Session& session);
void add_scenes(CLI::App& app, Session& session);

}  // namespace onepass::cli
