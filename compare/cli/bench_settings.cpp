#include "compare/cli/bench_settings.h"

#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/experiments.h"
#include "compare/manifest.h"
#include "compare/statistics.h"
#include "compare/tradeoff.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

/// A setting made ready for one scene.
struct Contestant {
    std::unique_ptr<Tracer> tracer;
    std::string setting;
};

std::string entry_name(const TradeoffSetting& setting, const std::string& entry) {
    const std::string& name = setting.tracer;
    return name.ends_with('*') ? name.substr(0, name.size() - 1) + entry : name;
}

/// Those that can take the scene; the others are said aloud.
std::vector<Contestant> make_contestants(const Session& session, const Court& court,
                                         const std::string& entry, uint64_t rays, ProgressBar& bar,
                                         Results& results) {
    std::vector<Contestant> contestants;
    for (const TradeoffSetting& setting : tradeoff_settings()) {
        const CatalogueEntry& listed = session.catalogue.at(entry_name(setting, entry));
        const std::string params = params_text(setting.params);
        const auto leave_out = [&](const std::string& why) {
            bar.say(fmt::format("{}: {}{} is left out: {}", court.open.name, listed.info.name,
                                params.empty() ? "" : " (" + params + ")", why));
        };
        if (setting.tracer.starts_with("brute_force/") &&
            rays * court.open.record.triangles > kMostBruteForceTests) {
            leave_out(fmt::format("{} rays times {} triangles, where at most {} are worth the time",
                                  rays, court.open.record.triangles, kMostBruteForceTests));
            continue;
        }
        try {
            contestants.push_back({listed.make(court.open.scene, setting.params), params});
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::device) throw;
            leave_out(error.what());
            continue;
        }
        if (setting.params.empty()) {
            results.tracers.push_back(make_tracer_record(
                court.open.name, *contestants.back().tracer, listed.info, setting.params));
        }
    }
    return contestants;
}

/// The scene's points that the study needs.
void bench_scene(const Session& session, const BenchSettingsCommand& options,
                 const std::string& name, ProgressBar& bar, Study& study) {
    std::vector<std::string> kinds = options.rays.kinds;
    std::erase_if(kinds, [&](const auto& kind) { return !study.needs(case_key(name, kind)); });
    if (kinds.empty()) return;
    const ImageSize size = parse_size(options.rays.size);
    const RayRequest request{size.width, size.height, options.rays.camera, session.globals.seed};

    // What the points share.
    Court court = open_court(session, name);
    study.check_scene(court.open.record);
    Results shared;
    shared.manifest.judge = court.judge->name();
    shared.scenes.push_back(court.open.record);
    const std::vector<Contestant> contestants = make_contestants(
        session, court, options.entry, uint64_t{size.width} * size.height, bar, shared);
    std::vector<Tracer*> tracers;
    for (const Contestant& contestant : contestants) tracers.push_back(contestant.tracer.get());

    for (const std::string& kind : kinds) {
        if (stop_requested()) return;
        const RaySet rays = make_ray_set(kind, *court.open.scene, *court.oracle, request);
        Results point = shared;
        point.tradeoffs = measure_tradeoff(tracers, 0, rays, *court.judge, options.timing,
                                           next_point(bar, study));
        if (stop_requested()) return;
        for (size_t i = 0; i < point.tradeoffs.size(); ++i) {
            point.tradeoffs[i].scene = court.open.name;
            point.tradeoffs[i].setting = contestants[i].setting;
        }
        study.add(case_key(name, kind), std::move(point));
    }
}

/// With the setting as last column, to the left.
std::string table(const std::string& title, const std::vector<TradeoffPoint>& points) {
    std::vector<std::vector<std::string>> rows = {
        {"tracer", "ratio", "95 % interval", "median ms", "errors", "of rays", "edge", "front"}};
    std::vector<std::string> settings = {"setting"};
    const std::vector<bool> front = on_front(points);
    for (size_t i = 0; i < points.size(); ++i) {
        const TradeoffPoint& point = points[i];
        rows.push_back({point.tracer, fmt::format("{:.3f}", point.ratio),
                        fmt::format("{:.3f}..{:.3f}", point.ratio_low, point.ratio_high),
                        point.wall_ms.empty() ? "-" : fmt::format("{:.2f}", median(point.wall_ms)),
                        std::to_string(point.errors), std::to_string(point.ray_count),
                        std::to_string(point.edges), front[i] ? "*" : ""});
        settings.push_back(point.setting);
    }
    std::istringstream lines(format_table(rows));
    std::string text = fmt::format("{}; ratio is speed relative to {}; * on the Pareto front\n",
                                   title, points.front().oracle);
    for (const std::string& setting : settings) {
        std::string line;
        std::getline(lines, line);
        text += line + (setting.empty() ? "" : "  " + setting) + '\n';
    }
    return text;
}

void print(const Results& results, std::FILE* out) {
    const std::vector<TradeoffPoint>& all = results.tradeoffs;
    size_t cases = 0;
    for (size_t begin = 0; begin < all.size(); ++cases) {
        std::vector<TradeoffPoint> of_case;
        for (size_t i = begin;
             i < all.size() && all[i].scene == all[begin].scene && all[i].rays == all[begin].rays;
             ++i) {
            of_case.push_back(all[i]);
        }
        fmt::print(out, "{}",
                   table(fmt::format("{}, {} rays", of_case[0].scene, of_case[0].rays), of_case));
        begin += of_case.size();
    }
    if (cases > 1) {
        fmt::print(
            out, "{}",
            table(fmt::format("all {} cases, geometric mean of the ratios", cases), pool(all)));
    }
    fmt::print(out, "every answer judged by: {}\n", results.manifest.judge);
}

}  // namespace

void bench_settings(Session& session, const BenchSettingsCommand& options) {
    check_scene_names(options.scenes);
    parse_size(options.rays.size);
    BenchSettingsCommand command = options;
    command.timing.seed = session.globals.seed;
    check_repetitions(command.timing);
    std::vector<const CatalogueEntry*> entries;
    for (const TradeoffSetting& setting : tradeoff_settings()) {
        entries.push_back(&session.catalogue.at(entry_name(setting, command.entry)));
    }
    std::vector<std::string> keys;
    for (const std::string& scene : command.scenes) {
        for (const std::string& kind : command.rays.kinds) keys.push_back(case_key(scene, kind));
    }

    Study study = open_study(session, command.study, std::move(keys), entries);
    {
        ProgressBar bar("bench --settings");
        for (const std::string& scene : command.scenes) {
            if (stop_requested()) break;
            bench_scene(session, command, scene, bar, study);
        }
    }
    Results results = study.results();
    print(results, table_stream(command.study.json));
    finish_study(session, study, results, command.study);
}

}  // namespace onepass::cli
