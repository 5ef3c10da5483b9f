// Structures, tracers and runs: where the figures come from and how to make them again.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "compare/merge.h"
#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/study.h"

namespace onepass::report {
namespace {

std::string scroll_table(const std::string& name, const std::string& rows) {
    return fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>{}"
        "</table></div>\n",
        escape(name), rows);
}

// ---- Structures.

/// Stat names of all the scene's tracers, in order of appearance, with their first note.
std::vector<std::pair<std::string, std::string>> stat_names(const SceneDossier& scene) {
    std::vector<std::pair<std::string, std::string>> names;
    for (const auto& tracer : scene.tracers) {
        for (const Stat& stat : tracer->stats) {
            const auto known = std::find_if(names.begin(), names.end(),
                                            [&](const auto& n) { return n.first == stat.name; });
            if (known == names.end()) names.emplace_back(stat.name, stat.note);
        }
    }
    return names;
}

std::string stat_value(const TracerRecord& tracer, const std::string& name) {
    for (const Stat& stat : tracer.stats) {
        if (stat.name != name) continue;
        if (name.ends_with("bytes")) return byte_size(stat.value);
        const bool is_count = stat.value >= 0.0 && stat.value < 1e15 &&
                              stat.value == static_cast<double>(static_cast<uint64_t>(stat.value));
        return is_count ? grouped(static_cast<uint64_t>(stat.value)) : significant(stat.value);
    }
    return {};
}

/// One line a measure, one column a tracer that built something.
std::string structure_table(const SceneDossier& scene) {
    const auto names = stat_names(scene);
    if (names.empty()) return {};
    std::vector<Entry<TracerRecord>> tracers;
    for (const auto& tracer : scene.tracers) {
        if (!tracer->stats.empty()) tracers.push_back(tracer);
    }

    std::string rows = "<thead><tr>" + heading_cell("Measure", "text");
    for (const auto& tracer : tracers) {
        rows += heading_cell(breakable(escape(label(scene.tracers, tracer))), "name");
    }
    rows += heading_cell("How to read it", "text") + "</tr></thead><tbody>\n";
    for (const auto& [name, note] : names) {
        rows += fmt::format("<tr><th scope=\"row\">{}</th>", escape(name));
        for (const auto& tracer : tracers) rows += cell(stat_value(*tracer.record, name));
        rows += cell(escape(note), "text quiet") + "</tr>\n";
    }
    return fmt::format("<h3>{}</h3>\n", escape(scene.name)) +
           scroll_table("Structures of " + scene.name, rows + "</tbody>");
}

// ---- Tracers.

std::string params_text(const ParamValues& params) {
    std::string text;
    for (const auto& [name, value] : params) {
        text += fmt::format("{}<code>{}={}</code>", text.empty() ? "" : " ", escape(name),
                            escape(value));
    }
    return text;
}

std::string tracer_row(const TracerRecord& tracer) {
    std::string role = tracer.is_oracle ? "oracle" : tracer.is_twin ? "twin" : "strategy";
    if (tracer.software_renderer) role += ", software renderer";
    std::string html = fmt::format("<tr><th scope=\"row\">{}</th>", escape(tracer.name));
    html += cell(escape(role), "text") + cell(escape(tracer.device), "text");
    html += cell(tracer.threads > 0 ? grouped(tracer.threads) : "–");
    html += cell(params_text(tracer.params), "text");
    return html + cell(fmt::format("<code>{}</code>", escape(tracer.shader_hash)), "text") +
           "</tr>\n";
}

/// Each different line once: most tracers are the same on every scene.
std::string tracer_table(const Dossier& dossier) {
    std::set<std::string> seen;
    std::string rows;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& tracer : scene.tracers) {
            const std::string row = tracer_row(*tracer.record);
            if (seen.insert(row).second) rows += row;
        }
    }
    if (rows.empty()) return {};
    return "<h3>Tracers</h3>\n" +
           scroll_table("Tracers",
                        "<thead><tr><th class=\"text\">Tracer</th><th class=\"text\">Role</th>"
                        "<th class=\"text\">Device</th><th>Threads</th>"
                        "<th class=\"text\">Parameters</th><th class=\"text\">Shader</th></tr>"
                        "</thead><tbody>\n" +
                            rows + "</tbody>");
}

// ---- Runs.

/// An argument as a shell takes it: quoted if it holds anything but plain characters.
std::string shell_word(const std::string& argument) {
    static constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=+@%";
    if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) {
        return argument;
    }
    std::string quoted = "'";
    for (const char c : argument) {
        if (c == '\'')
            quoted += "'\\''";
        else
            quoted += c;
    }
    return quoted + "'";
}

std::string command_line(const Manifest& manifest) {
    std::string line;
    for (const std::string& argument : manifest.arguments) {
        if (!line.empty()) line += ' ';
        line += shell_word(argument);
    }
    return line;
}

std::string manifest_table(const Manifest& m) {
    const auto row = [](const std::string& name, const std::string& html) {
        return fmt::format("<tr><th scope=\"row\">{}</th><td class=\"text\">{}</td></tr>\n", name,
                           html.empty() ? "–" : html);
    };
    std::string rows = "<tbody>\n";
    rows += row("Time, UTC", escape(m.time_utc));
    rows += row("Commit", fmt::format("<code>{}</code>{}", escape(m.commit),
                                      m.dirty ? " with uncommitted changes" : ""));
    rows += row("Build", escape(fmt::format("{}, {}", m.build_type, m.compiler)));
    const std::string cores = m.cores > 0 ? counted(m.cores, "core") : "as the shards say";
    rows += row("CPU", escape(fmt::format("{}, {}", m.cpu, cores)));
    if (!m.gl_context.empty()) {
        rows +=
            row("GL", escape(fmt::format("{}: {}, {}", m.gl_context, m.gl_renderer, m.gl_version)) +
                          (m.software_renderer ? " <strong>(software renderer)</strong>" : ""));
    }
    rows += row("Embree", escape(m.embree));
    rows += row("Judge", escape(m.judge));
    rows += row("Seed", std::to_string(m.seed));
    return scroll_table("Manifest", rows + "</tbody>");
}

/// Of a merged study: who measured which points, and whether their times compare.
std::string shard_table(const StudyRecord& study) {
    if (study.parts.empty()) return {};
    std::string rows =
        "<thead><tr><th class=\"text\">Shard</th><th>Points</th><th class=\"text\">CPU</th>"
        "<th class=\"text\">GL</th><th class=\"text\">Time, UTC</th></tr></thead><tbody>\n";
    bool alike = true;
    for (const StudyPart& part : study.parts) {
        const Manifest& m = part.manifest;
        alike &= like_machines(m, study.parts.front().manifest);
        std::string points;
        for (size_t k = 0; k < study.keys.size(); ++k) {
            if (!takes(part.shard, k)) continue;
            points += (points.empty() ? "" : "; ") + study.keys[k];
        }
        const std::string gl =
            m.gl_context.empty() ? "–" : fmt::format("{}, {}", m.gl_renderer, m.gl_version);
        rows += fmt::format("<tr><th scope=\"row\">{}</th>", to_string(part.shard));
        rows += cell(escape(points), "text quiet");
        rows += cell(escape(fmt::format("{}, {}", m.cpu, counted(m.cores, "core"))), "text");
        rows += cell(escape(gl), "text") + cell(escape(m.time_utc), "text") + "</tr>\n";
    }
    const std::string flag =
        alike ? ""
              : "<p class=\"flag\"><strong>Measured on unlike machines.</strong> Counts and errors "
                "compare throughout; times and ratios only among the points of like "
                "machines.</p>\n";
    return flag + scroll_table("Shards", rows + "</tbody>");
}

}  // namespace

std::string structure_section(const Dossier& dossier) {
    std::string tables;
    for (const SceneDossier& scene : dossier.scenes) tables += structure_table(scene);
    if (tables.empty()) return {};
    return "<section id=\"structures\">\n<h2>Structures</h2>\n" + tables + "</section>\n";
}

std::string environment_section(const Dossier& dossier) {
    std::string html = "<section id=\"environment\">\n<h2>Environment</h2>\n";
    const std::vector<Results>& runs = *dossier.runs;
    for (size_t r = 0; r < runs.size(); ++r) {
        html += fmt::format(
            "<h3>Run {} of {}</h3>\n<pre class=\"command\"><code class=\"copy\">{}</code></pre>\n",
            r + 1, runs.size(), escape(command_line(runs[r].manifest)));
        if (!runs[r].manifest.complete) {
            html +=
                "<p class=\"flag\"><strong>Stopped early.</strong> This run was interrupted; what "
                "it "
                "holds is whole.</p>\n";
        }
        html += manifest_table(runs[r].manifest);
        if (runs[r].study) html += shard_table(*runs[r].study);
    }
    return html + tracer_table(dossier) + "</section>\n";
}

}  // namespace onepass::report
