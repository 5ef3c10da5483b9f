// Ladders: where each method first fails, over all ladders in one table, then ladder by ladder with
// its plot, its counts and its worst rays.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/ladders.h"
#include "compare/report/sections.h"

namespace onepass::report {
namespace {

std::string open_table(const std::string& name, const std::string& css = {}) {
    return fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table{}>",
        escape(name), css.empty() ? "" : " class=\"" + css + "\"");
}
constexpr char kCloseTable[] = "</tbody></table></div>\n";

std::string anchor(const LadderOfRun& ladder) {
    return fmt::format("ladder-{}-{}", ladder.run, slug(ladder->id));
}

std::string link(const LadderOfRun& ladder) {
    return fmt::format("<a href=\"#{}\">{}</a>", anchor(ladder), escape(ladder->title));
}

std::string code(const std::string& text) {
    return fmt::format("<code>{}</code>", breakable(escape(text)));
}

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (size_t i = 0; i < parts.size(); ++i) {
        text += i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ";
        text += parts[i];
    }
    return text;
}

// ---- Fates.

/// The words of breaks_text(), told apart by shape as well.
std::string fate_badge(const Fate& fate) {
    const char* css = fate.kind == Fate::Kind::never     ? " pass"
                      : fate.kind == Fate::Kind::breaks  ? " fail"
                      : fate.kind == Fate::Kind::refused ? " depends"
                                                         : "";
    return fmt::format("<span class=\"badge{}\">{}</span>", css, escape(breaks_text(fate)));
}

std::string refusal_note(const Fate& fate) {
    return fate.refusals == 0 ? "" : fmt::format("{} refused", counted(fate.refusals, "rung"));
}

std::string fate_cell(const Fate& fate, size_t rungs, bool first) {
    const char* css = fate.kind == Fate::Kind::never     ? "text pass"
                      : fate.kind == Fate::Kind::breaks  ? "text fail"
                      : fate.kind == Fate::Kind::refused ? "text depends"
                                                         : "text";
    if (fate.kind == Fate::Kind::absent) return cell("–", css);
    std::string html = fate_badge(fate);
    if (fate.breaks) {
        html += fmt::format("<small>rung {} of {}: {} of {}</small>", fate.step + 1, rungs,
                            grouped(fate.breaks->failed()), grouped(fate.breaks->trials));
    }
    if (first) html += "<small><strong>first to fail</strong></small>";
    const std::string refusals = refusal_note(fate);
    if (!refusals.empty() && fate.climbed > 0) html += fmt::format("<small>{}</small>", refusals);
    return cell(html, css);
}

// ---- The table over all ladders.

std::string climber_heading(const Climber& climber) {
    const std::string family = family_of(climber.tracer);
    const std::string rest =
        climber.tracer.substr(std::min(family.size() + 1, climber.tracer.size()));
    std::string html = escape(family);
    if (!rest.empty()) html += fmt::format("<small>{}</small>", breakable(escape(rest)));
    if (!climber.setting.empty()) {
        html += fmt::format("<small>{}</small>", breakable(escape(climber.setting)));
    }
    return fmt::format("<th scope=\"col\" class=\"text\">{}</th>", html);
}

std::string summary_table(const std::vector<LadderOfRun>& ladders,
                          const std::vector<Climber>& columns) {
    std::string html = open_table("Where each method first fails", "ladders") + "<thead><tr>" +
                       heading_cell("Ladder", "text");
    for (const Climber& climber : columns) html += climber_heading(climber);
    html += "</tr></thead><tbody>\n";
    for (const LadderOfRun& ladder : ladders) {
        const std::vector<Climber> first = earliest_failures(*ladder.record);
        html += fmt::format(
            "<tr><th scope=\"row\">{}{}</th>", link(ladder),
            ladder.repeated ? fmt::format("<small>run {}</small>", ladder.run + 1) : "");
        for (const Climber& climber : columns) {
            const bool is_first = std::find(first.begin(), first.end(), climber) != first.end();
            html +=
                fate_cell(fate_of(*ladder.record, climber), steps(*ladder.record).size(), is_first);
        }
        html += "</tr>\n";
    }
    return html + kCloseTable;
}

std::string summary(const std::vector<LadderOfRun>& ladders) {
    std::vector<const LadderRecord*> records;
    for (const LadderOfRun& ladder : ladders) records.push_back(ladder.record);
    std::vector<Climber> own, twins;
    for (const Climber& climber : climbers(records)) {
        (is_twin(climber) ? twins : own).push_back(climber);
    }
    std::string html = summary_table(ladders, own);
    if (twins.empty()) return html;
    return html + fmt::format("<details><summary>The same of {}</summary>\n{}</details>\n",
                              counted(twins.size(), "twin"), summary_table(ladders, twins));
}

// ---- One ladder.

std::string kinds_text(const RungRecord& rung) {
    std::string text;
    for (const FailureCount& failure : rung.failures) {
        text += fmt::format("{}<code>{}</code> {}", text.empty() ? "" : ", ", escape(failure.kind),
                            grouped(failure.count));
    }
    return text;
}

std::string share_text(const RungRecord& rung) {
    return fmt::format("{} of {}<small>{}</small>", grouped(rung.failed()), grouped(rung.trials),
                       percent(rung.failed(), rung.trials));
}

std::string breaks_row(const LadderRecord& ladder, const Climber& climber) {
    const Fate fate = fate_of(ladder, climber);
    uint64_t trials = 0, ties = 0, edges = 0;
    std::string refusals, last_refusal;
    for (const RungRecord* rung : rungs_of(ladder, climber)) {
        if (!rung) continue;
        trials += rung->trials;
        ties += rung->ties;
        edges += rung->edges;
        if (rung->refusal.empty()) continue;
        // A reason that many rungs share is said once, after the last of them.
        if (rung->refusal == last_refusal) refusals.resize(refusals.rfind("<br>"));
        refusals +=
            (refusals.empty() ? "" : ", ") + fmt::format("<em>{}</em>", escape(knob_text(*rung)));
        refusals += "<br>" + escape(rung->refusal);
        last_refusal = rung->refusal;
    }
    std::string html = fmt::format("<tr><th scope=\"row\">{}</th>", code(name_of(climber)));
    html += cell(fate_badge(fate), "text");
    html += fate.breaks
                ? cell(share_text(*fate.breaks)) + cell(kinds_text(*fate.breaks), "text")
                : cell(fate.climbed > 0 ? "none of " + grouped(trials) : "–") + cell("–", "text");
    html += fate.worst ? cell(fmt::format("at {}<small>{}</small>", escape(knob_text(*fate.worst)),
                                          percent(fate.worst->failed(), fate.worst->trials)))
                       : cell("–");
    html += cell(grouped(ties), ties == 0 ? "zero" : "");
    html += cell(grouped(edges), edges == 0 ? "zero" : "");
    return html + cell(refusals.empty() ? "–" : refusals, "text refusals") + "</tr>\n";
}

std::string breaks_table(const LadderRecord& ladder, const std::vector<Climber>& all) {
    std::string html = open_table("Where each tracer breaks: " + ladder.title) + "<thead><tr>" +
                       heading_cell("Tracer", "text") + heading_cell("Breaks", "text") +
                       heading_cell("Failures there") + heading_cell("Kinds", "text") +
                       heading_cell("Worst") + heading_cell("Ties<small>all rungs</small>") +
                       heading_cell("Edges<small>all rungs</small>") +
                       heading_cell("Refused", "text") + "</tr></thead><tbody>\n";
    for (const Climber& climber : all) html += breaks_row(ladder, climber);
    return html + kCloseTable;
}

std::string rung_cell(const RungRecord* rung) {
    if (!rung) return cell("–");
    if (rung->trials == 0) return cell("refused", "quiet");
    return cell(
        fmt::format("{}<small>of {}</small>", grouped(rung->failed()), grouped(rung->trials)),
        rung->failed() == 0 ? "zero" : "bad");
}

/// The figures of the plot.
std::string all_rungs(const LadderRecord& ladder, const std::vector<Climber>& all) {
    std::string html = "<details><summary>Every rung: failures of trials</summary>\n" +
                       open_table("Failures on every rung: " + ladder.title, "dense") +
                       "<thead><tr>" + heading_cell(escape(ladder.knob), "text");
    std::vector<std::vector<const RungRecord*>> columns;
    for (const Climber& climber : all) {
        html += climber_heading(climber);
        columns.push_back(rungs_of(ladder, climber));
    }
    html += "</tr></thead><tbody>\n";
    const std::vector<const RungRecord*> rungs = steps(ladder);
    for (size_t i = 0; i < rungs.size(); ++i) {
        html += fmt::format("<tr><th scope=\"row\">{}</th>", escape(knob_text(*rungs[i])));
        for (const auto& column : columns) html += rung_cell(column[i]);
        html += "</tr>\n";
    }
    return html + kCloseTable + "</details>\n";
}

std::string worst_row(const Climber& climber, const RungRecord& rung) {
    const WorstRay& worst = *rung.worst;
    const Verdict& verdict = worst.verdict;
    std::string html = fmt::format("<tr><th scope=\"row\">{}<small>at {}, ray {}</small></th>",
                                   escape(name_of(climber)), escape(knob_text(rung)), worst.index);
    html += cell(to_string(verdict.hit_class), is_error(verdict.hit_class) ? "text bad" : "text");
    html += cell(hit_text(worst.answer.t, worst.answer.prim_id, worst.answer.inst_id), "text");
    html += cell(hit_text(verdict.true_t, verdict.true_prim_id, verdict.true_inst_id), "text");
    html += cell(significant(verdict.t_error_ulps)) + cell(significant(verdict.backward_error));
    return html + fmt::format("<td class=\"text\"><code class=\"copy\">{}</code></td></tr>\n",
                              breakable(escape(ray_text(worst.ray))));
}

std::string worst_rays(const LadderRecord& ladder, const std::vector<Climber>& all) {
    std::string rows;
    for (const Climber& climber : all) {
        const RungRecord* rung = fate_of(ladder, climber).breaks;
        if (rung && rung->worst) rows += worst_row(climber, *rung);
    }
    if (rows.empty()) return {};
    return "<details class=\"worst\"><summary>The worst ray of each tracer, where it "
           "breaks</summary>\n" +
           open_table("Worst rays: " + ladder.title) +
           "<thead><tr><th class=\"text\">Tracer</th><th class=\"text\">Class</th>"
           "<th class=\"text\">Its answer</th><th class=\"text\">The judge’s</th>"
           "<th>t error, ulps</th><th>Backward error</th>"
           "<th class=\"text\">The ray: origin, tmin, direction, tmax</th></tr></thead><tbody>\n" +
           rows + kCloseTable + "</details>\n";
}

std::string plot(const LadderRecord& ladder, size_t index) {
    return fmt::format(
        "<figure class=\"chart\"><div class=\"plot\" data-chart=\"ladder\" data-ladder=\"{}\">"
        "<canvas role=\"img\" aria-label=\"{}: share of failures against {}. The tables below hold "
        "the same figures.\"></canvas></div></figure>\n",
        index, escape(ladder.title), escape(ladder.knob));
}

std::string ladder_block(const LadderOfRun& ladder, size_t index) {
    const LadderRecord& record = *ladder.record;
    const std::vector<Climber> all = climbers({&record});
    std::string html = fmt::format("<article class=\"ladder\" id=\"{}\">\n<h3>{}</h3>\n<p>{}</p>\n",
                                   anchor(ladder), escape(record.title), escape(record.question));
    html += plot(record, index) + breaks_table(record, all) + all_rungs(record, all) +
            worst_rays(record, all);
    html += fmt::format(
        "<p class=\"note\">{} Again: <code class=\"copy\">{}</code></p>\n</article>\n",
        record.judge.empty() ? std::string("No judge: answers are compared among themselves.")
                             : fmt::format("Judge: {}.", escape(record.judge)),
        escape(record.command));
    return html;
}

}  // namespace

std::vector<LadderOfRun> ladders_of(const Dossier& dossier) {
    std::map<std::string, size_t> runs_with;
    std::vector<LadderOfRun> all;
    for (size_t r = 0; r < dossier.runs->size(); ++r) {
        for (const LadderRecord& ladder : (*dossier.runs)[r].ladders) {
            ++runs_with[ladder.id];
            all.push_back({&ladder, r, false});
        }
    }
    for (LadderOfRun& ladder : all) ladder.repeated = runs_with[ladder->id] > 1;
    return all;
}

std::string grid_first_sentence(const std::vector<LadderOfRun>& ladders) {
    size_t climbed = 0;
    std::vector<std::string> first, later;
    for (const LadderOfRun& ladder : ladders) {
        bool took_part = false, failed = false, was_first = false;
        std::vector<std::string> others;
        for (const Climber& climber : climbers({ladder.record})) {
            if (is_twin(climber) || family_of(climber.tracer) != "grid") continue;
            const Fate fate = fate_of(*ladder.record, climber);
            took_part |= fate.climbed > 0;
            failed |= fate.breaks != nullptr;
        }
        std::string where;
        for (const Climber& climber : earliest_failures(*ladder.record)) {
            if (family_of(climber.tracer) == "grid") {
                was_first = true;
                where = breaks_text(fate_of(*ladder.record, climber));
            } else {
                others.push_back("<code>" + escape(name_of(climber)) + "</code>");
            }
        }
        climbed += took_part ? 1 : 0;
        if (was_first) {
            first.push_back(fmt::format("{} ({}{})", link(ladder), escape(where),
                                        others.empty() ? ", alone" : ", with " + joined(others)));
        } else if (failed) {
            later.push_back(link(ladder));
        }
    }
    if (climbed == 0) return "<code>grid</code> climbed none of these ladders.";

    const std::string of_all = climbed == 1
                                   ? "the one ladder that it climbed"
                                   : fmt::format("the {} ladders that it climbed", climbed);
    if (first.empty() && later.empty()) {
        return climbed == 1 ? fmt::format("<code>grid</code> does not fail on {}.", of_all)
                            : fmt::format("<code>grid</code> fails on none of {}.", of_all);
    }
    std::string text =
        first.empty()
            ? fmt::format("<code>grid</code> is not the first to fail on any of {}.", of_all)
            : fmt::format(
                  "<code>grid</code> is the first to fail, alone or with others, on {} of "
                  "{}: {}.",
                  first.size(), of_all, joined(first));
    if (!later.empty()) {
        text += fmt::format(" It fails after another on {}: {}.", later.size(), joined(later));
    }
    return text;
}

std::string ladder_section(const Dossier& dossier) {
    const std::vector<LadderOfRun> ladders = ladders_of(dossier);
    if (ladders.empty()) return {};
    std::string html =
        "<section id=\"ladders\">\n<h2>Ladders: where each method fails</h2>\n"
        "<p class=\"lead\">A ladder turns one knob, rung by rung, from harmless to hard, and every "
        "tracer climbs it with the same rays. A cell names the first rung on which an answer was "
        "wrong, and how many of how many.</p>\n";
    html += fmt::format("<p class=\"why\">{}</p>\n", grid_first_sentence(ladders));
    html += summary(ladders);
    html +=
        "<p class=\"note\"><em>Never</em>: no failure on any rung that it answered. "
        "<em>Refused</em>: it said that it cannot take the rung’s scene, which is an answer and no "
        "failure. <em>First to fail</em>: no other failed on an easier rung; twins do not compete. "
        "In the plots harder is further right, a rate of 0 lies in the strip at the bottom (of N "
        "trials none failed: the rate is below 1/N, and no more is known), and a gap is a refusal. "
        "Lines of the strip are apart only to be seen.</p>\n";
    for (size_t i = 0; i < ladders.size(); ++i) html += ladder_block(ladders[i], i);
    return html + "</section>\n";
}

}  // namespace onepass::report
