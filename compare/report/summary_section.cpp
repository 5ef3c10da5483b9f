// The first section: what was compared, on what, and one verdict a scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/report/html.h"
#include "compare/report/ladders.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/tuning.h"

namespace onepass::report {
namespace {

constexpr size_t kFailuresNamed = 2;  ///< in a verdict; the table below it has them all

std::string joined(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + fmt::format("<code>{}</code>", escape(name));
    }
    return text;
}

std::string braced(const std::set<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return parts.size() == 1 ? text : "{" + text + "}";
}

/// Tracers as a shell's braces would name them, "grid/{buffer, ssbo}/{compute, fragment}", where
/// all of those forms are there.
std::string joined_tracers(const std::set<std::string>& names) {
    struct Forms {
        std::set<std::string> storages, entries, names;
    };
    std::map<std::string, Forms> strategies;
    for (const std::string& name : names) {
        const size_t first = name.find('/'), last = name.rfind('/');
        const bool has_parts = first != std::string::npos && first < last;
        Forms& forms = strategies[name.substr(0, first)];
        forms.storages.insert(has_parts ? name.substr(first + 1, last - first - 1) : name);
        forms.entries.insert(has_parts ? name.substr(last + 1) : name);
        forms.names.insert(name);
    }
    std::set<std::string> short_names;
    for (const auto& [strategy, forms] : strategies) {
        if (forms.names.size() > 1 &&
            forms.names.size() == forms.storages.size() * forms.entries.size()) {
            short_names.insert(strategy + "/" + braced(forms.storages) + "/" +
                               braced(forms.entries));
        } else {
            short_names.insert(forms.names.begin(), forms.names.end());
        }
    }
    return joined(short_names);
}

std::string scope_paragraph(const Dossier& dossier) {
    std::set<std::string> tracers, oracles, judges, rays, devices;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& check : scene.checks) {
            tracers.insert(check->tracer);
            oracles.insert(check->oracle);
            judges.insert(check->judge);
            rays.insert(check->rays);
            if (check.tracer) devices.insert(check.tracer->device);
        }
        for (const auto& timing : scene.timings) {
            tracers.insert(timing->tracer);
            oracles.insert(timing->oracle);
            rays.insert(timing->rays);
            if (timing.tracer) devices.insert(timing.tracer->device);
        }
        for (const auto& point : scene.sweeps) tracers.insert(point->tracer);
        for (const auto& point : scene.tradeoffs) {
            tracers.insert(point->tracer);
            oracles.insert(point->oracle);
            rays.insert(point->rays);
        }
    }
    for (const std::string& oracle : oracles) tracers.erase(oracle);
    for (auto* names : {&tracers, &oracles, &judges, &rays, &devices}) names->erase("");

    std::string text = "<p class=\"lead\">";
    if (!tracers.empty()) text += fmt::format("Compared: {}", joined_tracers(tracers));
    if (!oracles.empty()) text += fmt::format(" against {}", joined(oracles));
    if (!rays.empty()) text += fmt::format(", on rays of kind {}", joined(rays));
    text += ".";
    if (!devices.empty()) text += fmt::format(" Run on {}.", joined(devices));
    if (!judges.empty()) text += fmt::format(" Disagreements judged by: {}.", joined(judges));
    return text + "</p>\n";
}

std::string key_figure(const std::string& value, const std::string& name) {
    return fmt::format("<div><dt>{1}</dt><dd>{0}</dd></div>", value, name);
}

std::string key_figures(const Dossier& dossier) {
    uint64_t rays = 0, errors = 0, checks = 0, passed = 0;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& check : scene.checks) {
            rays += check->ray_count;
            errors += check->errors();
            ++checks;
            passed += check->passed ? 1 : 0;
        }
    }
    std::string html = "<dl class=\"figures\">";
    html += key_figure(grouped(dossier.scenes.size()), "scenes");
    if (checks > 0) {
        html += key_figure(grouped(rays), "rays compared");
        html += key_figure(grouped(errors), "errors");
        html += key_figure(fmt::format("{} of {}", passed, checks), "checks passed");
    }
    return html + "</dl>\n";
}

/// What one tracer answered over all scenes and kinds of rays.
struct Total {
    std::string tracer;  ///< its label
    bool reference = false;
    std::set<std::string> scenes{};
    uint64_t rays = 0, exhausted = 0, judged = 0;
    std::array<uint64_t, kHitClassCount> classes{};
};

/// One a tracer, in the order of first appearance; Embree's own rows last.
std::vector<Total> totals(const Dossier& dossier) {
    std::vector<Entry<CheckRecord>> all;
    for (const auto list : {&SceneDossier::checks, &SceneDossier::references}) {
        for (const SceneDossier& scene : dossier.scenes) {
            all.insert(all.end(), (scene.*list).begin(), (scene.*list).end());
        }
    }
    std::vector<Total> totals;
    for (const auto& check : all) {
        const std::string name = label(all, check);
        auto total = std::find_if(totals.begin(), totals.end(),
                                  [&](const Total& other) { return other.tracer == name; });
        if (total == totals.end()) {
            total = totals.insert(totals.end(), {.tracer = name, .reference = check->reference});
        }
        total->scenes.insert(check->scene);
        total->rays += check->ray_count;
        total->exhausted += check->exhausted;
        total->judged += check->judged;
        for (size_t c = 0; c < kHitClassCount; ++c) total->classes[c] += check->classes[c].count;
    }
    return totals;
}

// ---- The verdict, in sentences.

std::string finding(const std::string& word, const std::string& sentence) {
    return fmt::format("<li><strong>{}</strong> {}</li>\n", word, sentence);
}

/// Who is right everywhere, and who is not.
std::string right_and_wrong(const Dossier& dossier) {
    std::map<std::string, bool> passed;
    std::map<std::string, std::pair<uint64_t, uint64_t>> errors_of_rays;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& check : scene.checks) {
            const auto known = passed.emplace(check->tracer, true).first;
            known->second &= check->passed;
            errors_of_rays[check->tracer].first += check->errors();
            errors_of_rays[check->tracer].second += check->ray_count;
        }
    }
    std::set<std::string> right, wrong;
    double least = 1.0, most = 0.0;  // shares of errors among the wrong
    for (const auto& [tracer, has_passed] : passed) {
        (has_passed ? right : wrong).insert(tracer);
        const auto& [errors, rays] = errors_of_rays[tracer];
        if (has_passed || rays == 0) continue;
        least = std::min(least, static_cast<double>(errors) / static_cast<double>(rays));
        most = std::max(most, static_cast<double>(errors) / static_cast<double>(rays));
    }
    std::string html;
    if (!right.empty()) {
        html +=
            finding("Right.", fmt::format("{} of {}: {} passed every check.", right.size(),
                                          counted(passed.size(), "tracer"), joined_tracers(right)));
    }
    if (!wrong.empty()) {
        const std::string share = least == most
                                      ? significant(100.0 * most) + "\u00a0%"
                                      : fmt::format("{} to {}\u00a0%", significant(100.0 * least),
                                                    significant(100.0 * most));
        html += finding("Wrong.", fmt::format("{} failed a check; {} of the answers are errors.",
                                              joined_tracers(wrong), share));
    }
    return html;
}

std::string speed_text(const TradeoffPoint& point) {
    return fmt::format("{} times the speed of <code>{}</code> ({} to {})", significant(point.ratio),
                       escape(point.oracle), significant(point.ratio_low),
                       significant(point.ratio_high));
}

/// Who is fastest, with and without errors. Embree does not compete with itself.
std::string fastest(const Dossier& dossier) {
    std::string html;
    const std::vector<Cloud> all = clouds(dossier);
    for (size_t c = 0; c < all.size(); ++c) {
        const Cloud& cloud = all[c];
        if (c > 0 && all[c - 1].run == cloud.run) continue;  // the first of a run is over all of it
        const TradeoffPoint* clean = nullptr;
        const TradeoffPoint* any = nullptr;
        for (const TradeoffPoint& point : cloud.points) {
            if (point.tracer.starts_with("embree/") || std::isnan(point.ratio)) continue;
            if (!any || point.ratio > any->ratio) any = &point;
            if (point.errors == 0 && (!clean || point.ratio > clean->ratio)) clean = &point;
        }
        if (!any) continue;
        std::string text;
        if (clean) {
            text =
                fmt::format("without an error <code>{}</code> is the fastest: {}.",
                            escape(name_of({clean->tracer, clean->setting})), speed_text(*clean));
        }
        if (any != clean) {
            text += fmt::format(
                "{}<code>{}</code> is the fastest of all, {}, with errors on {} of "
                "the rays.",
                clean ? " " : "", escape(name_of({any->tracer, any->setting})), speed_text(*any),
                percent(any->errors, any->ray_count));
        }
        // Runs may be of the same scenes: what they cast and which they are tells them apart.
        std::set<std::string> kinds;
        for (const TradeoffPoint& part : cloud.parts) kinds.insert(part.rays);
        const std::string which =
            dossier.runs->size() > 1
                ? fmt::format(" (run {} of {})", cloud.run + 1, dossier.runs->size())
                : "";
        html += finding(
            "Fast.", fmt::format("{}, {} rays{}: {} <a href=\"#tradeoff\">Speed "
                                 "against accuracy</a>.",
                                 escape(cloud.title),
                                 escape(fmt::format("{}", fmt::join(kinds, ", "))), which, text));
    }
    return html;
}

/// Which grid sizes were the fastest, and what choosing by counting alone costs.
std::string tuned(const Dossier& dossier) {
    struct Studies {
        std::vector<double> densities;  // the fastest
        std::vector<double> regrets;    // of auto
        uint64_t errors = 0;            // at the fastest
    };
    std::map<std::string, Studies> by_tracer;
    for (const Sweep& sweep : sweeps(dossier)) {
        const std::optional<Tuning> tuning = tuning_of(sweep.points);
        if (!tuning) continue;
        Studies& studies = by_tracer[sweep.tracer];
        studies.densities.push_back(sweep.points[tuning->best].object_density);
        studies.errors += sweep.points[tuning->best].errors;
        if (tuning->automatic) studies.regrets.push_back(tuning->automatic_regret.share);
    }
    std::string html;
    for (const auto& [tracer, studies] : by_tracer) {
        const auto [low, high] = std::ranges::minmax(studies.densities);
        const std::string densities =
            low == high ? significant(low) : significant(low) + " to " + significant(high);
        const std::string regret =
            studies.regrets.empty() ? ""
                                    : fmt::format("; auto’s choice takes {} % longer in the median",
                                                  significant(100.0 * median(studies.regrets)));
        html += finding("Tuned.",
                        fmt::format("<code>{}</code>, {}: fastest at {} cells a triangle{}; {} "
                                    "there. <a href=\"#grid-size\">Grid size</a>.",
                                    escape(tracer), counted(studies.densities.size(), "sweep"),
                                    densities, regret, counted(studies.errors, "error")));
    }
    return html;
}

std::string findings(const Dossier& dossier) {
    const std::string items = right_and_wrong(dossier) + fastest(dossier) + tuned(dossier);
    return items.empty() ? "" : "<ul class=\"findings\">\n" + items + "</ul>\n";
}

/// The classes of every tracer over all scenes: a tracer may have been checked on fewer of them.
std::string totals_table(const Dossier& dossier) {
    const std::vector<Total> rows = totals(dossier);
    if (dossier.scenes.size() < 2 || rows.empty()) return {};
    std::string html =
        "<h3>All scenes together</h3>\n"
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"All scenes "
        "together\"><table class=\"classes\"><thead><tr>" +
        heading_cell("Tracer", "text") + heading_cell("scenes") + heading_cell("rays");
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const auto hit_class = static_cast<HitClass>(c);
        html += heading_cell(breakable(to_string(hit_class)), is_error(hit_class) ? "error" : "");
    }
    html += heading_cell("exhausted") + heading_cell("judged") + "</tr></thead>\n<tbody>\n";
    for (const Total& total : rows) {
        const auto count = [](uint64_t value, bool bad) {
            return cell(grouped(value), value == 0 ? "zero" : bad ? "bad" : "");
        };
        html += fmt::format("<tr{}><th scope=\"row\">{}</th>",
                            total.reference ? " class=\"oracle\"" : "", escape(total.tracer));
        html += cell(grouped(total.scenes.size())) + cell(grouped(total.rays));
        for (size_t c = 0; c < kHitClassCount; ++c) {
            html += count(total.classes[c], is_error(static_cast<HitClass>(c)));
        }
        html += count(total.exhausted, true) + cell(grouped(total.judged)) + "</tr>\n";
    }
    return html + "</tbody></table></div>\n<h3>Scene by scene</h3>\n";
}

std::string verdict_row(const SceneDossier& scene) {
    const std::string mark = scene_judged(scene)
                                 ? badge(scene_passed(scene))
                                 : fmt::format("<span class=\"badge\">{}</span>",
                                               scene.tradeoffs.empty() ? "Not judged" : "Measured");
    return fmt::format("<li>{}<a href=\"#scene-{}\">{}</a><span>{}</span></li>\n", mark,
                       slug(scene.name), escape(scene.name), verdict_sentence(scene));
}

/// A check can fail without an error: by its budget of edges.
std::string failure(const SceneDossier& scene, const Entry<CheckRecord>& check) {
    const std::string name = escape(label(scene.checks, check));
    if (check->errors() == 0) {
        constexpr auto kEdge = static_cast<size_t>(HitClass::edge);
        return fmt::format("<code>{}</code> has {} on {} rays, {} allowed", name,
                           counted(check->classes[kEdge].count, "edge"), escape(check->rays),
                           grouped(check->allowed[kEdge]));
    }
    return fmt::format("<code>{}</code> errs on {} of {} {} rays ({})", name,
                       grouped(check->errors()), grouped(check->ray_count), escape(check->rays),
                       percent(check->errors(), check->ray_count));
}

std::string failed_checks(const SceneDossier& scene) {
    std::vector<Entry<CheckRecord>> failed;
    for (const auto& check : scene.checks) {
        if (!check->passed) failed.push_back(check);
    }
    std::stable_sort(failed.begin(), failed.end(),
                     [](const auto& a, const auto& b) { return a->errors() > b->errors(); });
    std::string text;
    for (size_t i = 0; i < std::min(failed.size(), kFailuresNamed); ++i) {
        text += (i == 0 ? "" : "; ") + failure(scene, failed[i]);
    }
    if (failed.size() > kFailuresNamed) {
        text += fmt::format("; {} more below", failed.size() - kFailuresNamed);
    }
    return text;
}

}  // namespace

std::string badge(bool passed) {
    return passed ? "<span class=\"badge pass\">Pass</span>"
                  : "<span class=\"badge fail\">Fail</span>";
}

bool scene_judged(const SceneDossier& scene) {
    return !scene.checks.empty() || !scene.images.empty();
}

bool scene_passed(const SceneDossier& scene) {
    const auto passed = [](const auto& entry) { return entry->passed; };
    return std::all_of(scene.checks.begin(), scene.checks.end(), passed) &&
           std::all_of(scene.lesser_checks.begin(), scene.lesser_checks.end(), passed) &&
           std::all_of(scene.images.begin(), scene.images.end(), passed);
}

std::string verdict_sentence(const SceneDossier& scene) {
    if (!scene_judged(scene) && !scene.tradeoffs.empty()) {
        return "Settings held against each other, every answer judged: <a href=\"#tradeoff\">speed "
               "against accuracy</a>.";
    }
    if (!scene_judged(scene)) return "Measured only; these runs hold no comparison of its hits.";
    const auto failed = [](const auto& entry) { return !entry->passed; };
    uint64_t rays = 0, errors = 0;
    for (const auto& check : scene.checks) {
        rays += check->ray_count;
        errors += check->errors();
    }

    // Hits.
    std::string text;
    if (std::any_of(scene.checks.begin(), scene.checks.end(), failed)) {
        text = failed_checks(scene);
    } else if (!scene.checks.empty()) {
        text = errors == 0 ? fmt::format("No error in {} rays", grouped(rays))
                           : fmt::format("{} in {} rays, within the bounds asked for",
                                         counted(errors, "error"), grouped(rays));
    }

    const auto lesser =
        std::count_if(scene.lesser_checks.begin(), scene.lesser_checks.end(), failed);
    if (lesser > 0) text += fmt::format("; {} on fewer rays failed", counted(lesser, "check"));

    // Pictures.
    const auto wrong = std::count_if(scene.images.begin(), scene.images.end(), failed);
    if (wrong > 0) {
        text += fmt::format("{}{} of {} outside the bound", text.empty() ? "" : "; ", wrong,
                            counted(scene.images.size(), "picture"));
    } else if (!scene.images.empty()) {
        text += fmt::format("{}{} agree{} with the oracle’s within the stated bound",
                            text.empty() ? "" : "; ", counted(scene.images.size(), "picture"),
                            scene.images.size() == 1 ? "s" : "");
    }
    return text + ".";
}

std::string summary_section(const Dossier& dossier) {
    if (dossier.scenes.empty() && !dossier.software_renderer) return {};
    std::string html = "<section id=\"summary\">\n<h2>Summary</h2>\n";
    if (dossier.software_renderer) {
        html +=
            "<p class=\"flag\"><strong>Software renderer.</strong> The GL figures of these runs "
            "were made by a renderer that runs on the CPU. They say nothing of a GPU’s speed; "
            "hits and errors do carry over as far as both round alike.</p>\n";
    }
    if (dossier.scenes.empty()) return html + "</section>\n";
    html += findings(dossier) + scope_paragraph(dossier);
    html += key_figures(dossier) + totals_table(dossier);
    html += "<ul class=\"verdicts\">\n";
    for (const SceneDossier& scene : dossier.scenes) html += verdict_row(scene);
    return html + "</ul>\n</section>\n";
}

}  // namespace onepass::report
