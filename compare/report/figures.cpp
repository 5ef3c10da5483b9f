#include "compare/report/figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/timing.h"
#include "compare/tradeoff.h"

namespace onepass::report {
namespace {

using json = nlohmann::ordered_json;

// ---- CSV.

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

/// A table whose columns are those of its rows, in the order in which they first appear.
class Table {
  public:
    using Row = std::vector<std::pair<std::string, std::string>>;

    void add(Row row) {
        for (const auto& [column, value] : row) {
            if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) {
                columns_.push_back(column);
            }
        }
        rows_.push_back(std::move(row));
    }

    bool empty() const { return rows_.empty(); }

    std::string csv() const {
        std::string text;
        for (size_t c = 0; c < columns_.size(); ++c) text += (c ? "," : "") + quoted(columns_[c]);
        text += "\n";
        for (const Row& row : rows_) {
            for (size_t c = 0; c < columns_.size(); ++c) {
                const auto value = std::find_if(row.begin(), row.end(), [&](const auto& field) {
                    return field.first == columns_[c];
                });
                text += (c ? "," : "") + (value == row.end() ? "" : quoted(value->second));
            }
            text += "\n";
        }
        return text;
    }

  private:
    std::vector<std::string> columns_;
    std::vector<Row> rows_;
};

std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

// ---- Records.

std::string scalar_text(const json& value) {
    if (value.is_null()) return "";
    return value.is_string() ? value.get<std::string>() : value.dump();
}

bool is_list_of_scalars(const json& value) {
    return value.is_array() && std::none_of(value.begin(), value.end(), [](const json& element) {
               return element.is_structured();
           });
}

/// Nested members become columns "outer.inner"; lists of records within a record become rows of
/// their own tables, named "list.inner", with the outer record's scalars before theirs.
void flatten(const json& value, const std::string& name, Table::Row& row,
             std::vector<std::pair<std::string, json>>& inner_lists) {
    if (value.is_object()) {
        for (const auto& [member, field] : value.items()) {
            flatten(field, name.empty() ? member : name + "." + member, row, inner_lists);
        }
    } else if (is_list_of_scalars(value)) {
        std::string text;
        for (const json& element : value) text += (text.empty() ? "" : " ") + scalar_text(element);
        row.emplace_back(name, text);
    } else if (value.is_array()) {
        inner_lists.emplace_back(name, value);
    } else {
        row.emplace_back(name, scalar_text(value));
    }
}

void add_records(const json& records, const std::string& list, const Table::Row& outer,
                 std::map<std::string, Table>& tables) {
    for (const json& record : records) {
        Table::Row row = outer;
        std::vector<std::pair<std::string, json>> inner_lists;
        flatten(record, "", row, inner_lists);
        for (const auto& [name, inner] : inner_lists) {
            // What the outer row says of itself, under its list's name.
            Table::Row of_inner;
            for (const auto& [column, value] : row) {
                const bool is_run = column == "run";
                of_inner.emplace_back(is_run ? column : list + "." + column, value);
            }
            add_records(inner, list + "." + name, of_inner, tables);
        }
        tables[list].add(std::move(row));
    }
}

/// Every list of every run.
std::map<std::string, Table> record_tables(const std::vector<Results>& runs) {
    std::map<std::string, Table> tables;
    for (size_t r = 0; r < runs.size(); ++r) {
        const json document = json::parse(to_json(runs[r]));
        const Table::Row outer = {{"run", std::to_string(r + 1)}};
        for (const auto& [list, records] : document.items()) {
            if (records.is_array() && !is_list_of_scalars(records)) {
                add_records(records, list, outer, tables);
            }
        }
        add_records(json::array({document["manifest"]}), "manifest", outer, tables);
    }
    return tables;
}

// ---- Charts.

/// What a chart is, for gnuplot.
struct Drawing {
    std::string name;  ///< of its files
    std::string title;
    std::string x_title;
    std::string y_title;
    bool log_x = false;
    bool log_y = false;
    size_t height = 560;  ///< of the picture, in its pixels; the width is 840
    std::string extra{};  ///< further commands
    Table table{};        ///< columns "series", "x", "y" and others
    std::vector<std::string> series{};
};

/// Okabe and Ito's colours; every series has a point type of its own as well.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#777777", "#a89f00"};
constexpr int kPointTypes[] = {7, 5, 9, 13, 3, 2, 1, 4};

/// A string of gnuplot in single quotes, where a quote is doubled and nothing else is special.
std::string gnuplot_text(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
}

/// `with`: how a series is drawn, by name.
std::string script(const Drawing& drawing, const std::map<std::string, std::string>& with,
                   const std::string& usual) {
    std::string text = fmt::format(
        "# Made by onepass report --figures. Draws {0}.csv: gnuplot {0}{1}\n"
        "set terminal svg size 840,{6} dynamic enhanced font 'sans-serif,14' background 'white'\n"
        "set output {2}\nset datafile separator ','\n"
        "set key outside below left Left reverse noenhanced maxrows 12\n"
        "set grid lc rgb '#dfe3e7'\nset border 3\nset tics nomirror\n"
        "set title {3} noenhanced\nset xlabel {4}\nset ylabel {5}\n",
        drawing.name, kScriptSuffix, gnuplot_text(drawing.name + ".svg"),
        gnuplot_text(drawing.title), gnuplot_text(drawing.x_title), gnuplot_text(drawing.y_title),
        drawing.height);
    if (drawing.log_x) text += "set logscale x\n";
    if (drawing.log_y) text += "set logscale y\n";
    text += drawing.extra + "plot \\\n";
    size_t colour = 0;
    for (size_t s = 0; s < drawing.series.size(); ++s) {
        const std::string& series = drawing.series[s];
        const auto special = with.find(series);
        const size_t c = colour % std::size(kColours);
        const std::string style = special != with.end() ? special->second
                                                        : fmt::format("{} lc rgb '{}' pt {}", usual,
                                                                      kColours[c], kPointTypes[c]);
        if (special == with.end()) ++colour;
        // Rows of other series have no number in y, and so no point.
        text += fmt::format(
            "  {} using (strcol('series') eq {} ? column('x') : NaN):(column('y'))"
            "{} title {}{}\n",
            gnuplot_text(drawing.name + ".csv"), gnuplot_text(series), style, gnuplot_text(series),
            s + 1 < drawing.series.size() ? ", \\" : "");
    }
    return text;
}

void add_point(Drawing& drawing, const std::string& series, double x, double y,
               Table::Row more = {}) {
    if (std::find(drawing.series.begin(), drawing.series.end(), series) == drawing.series.end()) {
        drawing.series.push_back(series);
    }
    Table::Row row = {{"series", series}, {"x", number(x)}, {"y", number(y)}};
    row.insert(row.end(), more.begin(), more.end());
    drawing.table.add(std::move(row));
}

void add_files(const Drawing& drawing, const std::map<std::string, std::string>& with,
               const std::string& usual, std::vector<TextFile>& files) {
    if (drawing.table.empty()) return;
    files.push_back({drawing.name + ".csv", drawing.table.csv()});
    files.push_back({drawing.name + std::string(kScriptSuffix), script(drawing, with, usual)});
}

/// Speed against the share of errors. A share of 0 is drawn in the strip on the left, as the page
/// does.
void tradeoff_files(const Dossier& dossier, std::vector<TextFile>& files) {
    constexpr const char* kFront = "Pareto front";
    const std::vector<Cloud> all = clouds(dossier);
    for (const Cloud& cloud : all) {
        const CloudAxis axis = cloud_axis(cloud);
        Drawing drawing;
        drawing.name = fmt::format("chart-tradeoff-{}-{}", cloud.run + 1, slug(cloud.title));
        drawing.title = "Speed against accuracy: " + cloud.title;
        drawing.x_title = "share of wrong answers; left of the dashed line: none";
        drawing.y_title = "times Embree's speed";
        drawing.log_x = drawing.log_y = true;
        drawing.extra = fmt::format(
            "set format x '10^{{%T}}'\nset arrow from {0},graph 0 to {0},graph 1 nohead dt 2 lc "
            "rgb "
            "'#9aa3ac'\n",
            axis.band.high);
        std::vector<size_t> front;
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            const TradeoffPoint& point = cloud.points[i];
            if (std::isnan(point.ratio) || std::isnan(axis.x[i])) continue;
            add_point(drawing, name_of({point.tracer, point.setting}), axis.x[i], point.ratio,
                      {{"low", number(point.ratio_low)},
                       {"high", number(point.ratio_high)},
                       {"errors", std::to_string(point.errors)},
                       {"rays", std::to_string(point.ray_count)},
                       {"on_front", cloud.front[i] ? "1" : "0"}});
            if (cloud.front[i]) front.push_back(i);
        }
        std::sort(front.begin(), front.end(),
                  [&](size_t a, size_t b) { return axis.x[a] < axis.x[b]; });
        for (const size_t i : front) add_point(drawing, kFront, axis.x[i], cloud.points[i].ratio);
        add_files(drawing, {{kFront, " with fsteps lw 2 lc rgb '#007556'"}},
                  ":(column('low')):(column('high')) with yerrorbars ps 1", files);
    }
}

void growth_files(const Dossier& dossier, std::vector<TextFile>& files) {
    const std::vector<GrowthChart> charts = growth_charts(dossier);
    for (size_t i = 0; i < charts.size(); ++i) {
        const GrowthChart& chart = charts[i];
        const bool bytes = chart.curves.front().cost == GrowthCurve::Cost::bytes;
        Drawing drawing;
        drawing.name = fmt::format("chart-growth-{}-{}", i + 1, slug(chart.title));
        drawing.title = chart.title;
        drawing.x_title = chart.curves.front().over_rays ? "rays" : "triangles";
        drawing.y_title = bytes ? "bytes" : "ms";
        drawing.log_x = drawing.log_y = true;
        for (size_t c = 0; c < chart.curves.size(); ++c) {
            const GrowthCurve& curve = chart.curves[c];
            for (size_t k = 0; k < curve.x.size(); ++k) {
                add_point(drawing, chart.names[c], curve.x[k], curve.y[k],
                          {{"exponent", number(curve.law.exponent)},
                           {"factor", number(curve.law.factor)}});
            }
        }
        add_files(drawing, {}, " with linespoints", files);
    }
}

void sweep_files(const Dossier& dossier, std::vector<TextFile>& files) {
    const std::vector<Sweep> all = sweeps(dossier);
    for (size_t i = 0; i < all.size(); ++i) {
        const Sweep& sweep = all[i];
        Drawing drawing;
        drawing.name = fmt::format("chart-grid-size-{}-{}", i + 1, slug(sweep.scene->name));
        drawing.title = fmt::format("{}, {} rays, {}", sweep.scene->name, sweep.rays, sweep.tracer);
        drawing.x_title = "cells a triangle";
        drawing.y_title = "ms, median";
        drawing.log_x = true;
        for (const SweepPoint& point : sweep.points) {
            if (!point.failure.empty()) continue;
            add_point(drawing, fmt::format("top density {}", point.top_density),
                      point.object_density, median(point.wall_ms),
                      {{"cells_per_ray", number(point.cells_per_ray)},
                       {"tests_per_ray", number(point.tests_per_ray)},
                       {"bytes", std::to_string(point.bytes)},
                       {"errors", std::to_string(point.errors)}});
        }
        add_files(drawing, {}, " with linespoints", files);
    }
}

void ladder_files(const Dossier& dossier, std::vector<TextFile>& files) {
    for (const LadderOfRun& ladder : ladders_of(dossier)) {
        const LadderChart chart = ladder_chart(*ladder.record);
        Drawing drawing;
        drawing.name = fmt::format("chart-ladder-{}-{}", ladder.run + 1, slug(ladder->id));
        drawing.title = ladder->title;
        drawing.x_title = axis_title(*ladder.record);
        drawing.y_title = "share of failures; below the dashed line: none";
        drawing.log_y = true;
        drawing.extra = fmt::format(
            "set format y '10^{{%T}}'\nset arrow from graph 0,first {0} to graph 1,first {0} "
            "nohead "
            "dt 2 lc rgb '#9aa3ac'\nset xtics rotate by -40 (",
            chart.band.high);
        for (size_t t = 0; t < chart.ticks.size(); ++t) {
            drawing.extra += fmt::format("{}{} {}", t ? ", " : "",
                                         gnuplot_text(chart.ticks[t].text), chart.ticks[t].x);
        }
        drawing.extra += ")\n";
        for (const LadderChart::Line& line : chart.lines) {
            for (const LadderChart::Point& point : line.points) {
                add_point(drawing, name_of(line.climber), point.x, point.y,
                          {{"knob", knob_text(*point.rung)},
                           {"failed", std::to_string(point.rung->failed())},
                           {"trials", std::to_string(point.rung->trials)}});
            }
        }
        add_files(drawing, {}, " with linespoints", files);
    }
}

/// Ratio of every timing of a scene, with its interval; one row each.
void speed_files(const Dossier& dossier, std::vector<TextFile>& files) {
    constexpr size_t kRowHeight = 24, kFrameHeight = 140;
    for (const SceneDossier& scene : dossier.scenes) {
        Drawing drawing;
        drawing.name = "chart-speed-" + slug(scene.name);
        drawing.title = scene.name + ": speed relative to Embree";
        drawing.x_title = "times Embree's speed, median and 95 % interval";
        drawing.log_x = true;
        std::string ticks;
        size_t row = 0;
        for (const auto& timing : scene.timings) {
            if (timing->tracer == timing->oracle || std::isnan(timing->ratio)) continue;
            const std::string name = label(scene.timings, timing);
            add_point(drawing, name, timing->ratio, static_cast<double>(row),
                      {{"low", number(timing->ratio_low)},
                       {"high", number(timing->ratio_high)},
                       {"rays", timing->rays},
                       {"mrays_per_s", number(timing->mrays_per_s)},
                       {"errors", std::to_string(timing->errors)}});
            ticks += fmt::format("{}{} {}", row ? ", " : "",
                                 gnuplot_text(fmt::format("{}, {}, {}", name, timing->rays,
                                                          counted(timing->errors, "error"))),
                                 row);
            ++row;
        }
        drawing.height = kFrameHeight + kRowHeight * row;
        drawing.extra =
            fmt::format("set nokey\nset ytics ({}) noenhanced\nset yrange [{}:-1]\n", ticks, row);
        add_files(drawing, {}, ":(column('low')):(column('high')) with xerrorbars ps 0.8", files);
    }
}

}  // namespace

std::vector<TextFile> figure_files(const std::vector<Results>& runs,
                                   const std::vector<std::filesystem::path>& folders) {
    std::vector<TextFile> files;
    for (const auto& [list, table] : record_tables(runs)) {
        if (!table.empty()) files.push_back({list + ".csv", table.csv()});
    }
    const Dossier dossier = gather(runs, folders);
    speed_files(dossier, files);
    tradeoff_files(dossier, files);
    sweep_files(dossier, files);
    growth_files(dossier, files);
    ladder_files(dossier, files);
    return files;
}

}  // namespace onepass::report
