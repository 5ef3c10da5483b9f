#include "compare/cli/bench_settings.h"

#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "compare/atomic_file.h"
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
            bar.say(fmt::format("onepass: {}: {}{} is left out: {}", court.open.name,
                                listed.info.name, params.empty() ? "" : " (" + params + ")", why));
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

void bench_scene(const Session& session, const BenchSettingsCommand& options,
                 const std::string& name, ProgressBar& bar, const Progress& progress,
                 Results& results) {
    const ImageSize size = parse_size(options.rays.size);
    const RayRequest request{size.width, size.height, options.rays.camera, session.globals.seed};

    Court court = open_court(session, name);
    results.manifest.judge = court.judge->name();
    results.scenes.push_back(court.open.record);
    const std::vector<Contestant> contestants = make_contestants(
        session, court, options.entry, uint64_t{size.width} * size.height, bar, results);
    std::vector<Tracer*> tracers;
    for (const Contestant& contestant : contestants) tracers.push_back(contestant.tracer.get());

    const double kinds = static_cast<double>(options.rays.kinds.size());
    for (size_t k = 0; k < options.rays.kinds.size(); ++k) {
        const double begin = static_cast<double>(k) / kinds;
        const Progress part = [&](double done) { return go_on(progress, begin + done / kinds); };
        if (!part(0.0)) return;
        const RaySet rays =
            make_ray_set(options.rays.kinds[k], *court.open.scene, *court.oracle, request);
        std::vector<TradeoffPoint> points =
            measure_tradeoff(tracers, 0, rays, *court.judge, options.timing, part);
        for (size_t i = 0; i < points.size(); ++i) {
            points[i].scene = court.open.name;
            points[i].setting = contestants[i].setting;
            results.tradeoffs.push_back(std::move(points[i]));
        }
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
    if (!options.json.empty() && options.json != "-") check_writable(options.json);
    parse_size(options.rays.size);
    BenchSettingsCommand command = options;
    command.timing.seed = session.globals.seed;
    check_repetitions(command.timing);

    Results results;
    {
        ProgressBar bar("bench --settings");
        const double scenes = static_cast<double>(command.scenes.size());
        for (size_t i = 0; i < command.scenes.size() && !stop_requested(); ++i) {
            const double begin = static_cast<double>(i) / scenes;
            bench_scene(session, command, command.scenes[i], bar,
                        bar.part(begin, begin + 1.0 / scenes), results);
        }
    }
    print(results, table_stream(command.json));
    finish(session, results, command.json, stop_requested());
}

}  // namespace onepass::cli
