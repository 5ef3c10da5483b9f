// The page's part on ladders and on speed against accuracy, on invented results.
//
// With ONEPASS_LADDER_SAMPLE=FILE the sample page is also written there, to be looked at.
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compare/report/html.h"
#include "compare/report/ladders.h"
#include "compare/report/report.h"
#include "compare/report/sections.h"
#include "tests/support/ladder_results.h"

namespace onepass {
namespace {

using namespace report;

const Climber kPaper{"paper/texture2d/fragment", ""};
const Climber kGrid{"grid/buffer/fragment", ""};
const Climber kFast{"embree/fast/threads", ""};
const Climber kTwin{"grid/buffer/twin32", ""};

Results sample_run() {
    Results run;
    run.manifest.arguments = {"onepass", "stress"};
    run.manifest.judge = "exact (intervals of doubles, then exact numbers)";
    run.ladders = invented_ladders();
    run.tradeoffs = invented_tradeoffs();
    return run;
}

std::string page_of(const Results& run) { return render_report({run}, {"."}); }

/// What a reader sees, without where lines may break.
std::string visible(const std::string& page) {
    std::string text = page.substr(0, page.find("<script"));
    for (size_t at = text.find("<wbr>"); at != std::string::npos; at = text.find("<wbr>", at)) {
        text.erase(at, 5);
    }
    return text;
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const size_t at = text.find(begin);
    if (at == std::string::npos) return {};
    return text.substr(at, text.find(end, at) - at);
}

nlohmann::json data_of(const std::string& page) {
    const std::string open = "id=\"onepass-data\">";
    const size_t at = page.find(open) + open.size();
    return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++count;
    }
    return count;
}

LadderRecord small_ladder(const std::vector<InventedClimb>& climbs) {
    return invented_ladder("small", "A small one", {1.0, 10.0, 100.0}, climbs);
}

// ---- Where a tracer breaks.

TEST(LadderFate, names_the_first_rung_that_fails) {
    const LadderRecord ladder =
        small_ladder({{kPaper.tracer, {0, 5, 9}}, {kGrid.tracer, {0, 0, 0}}});
    const Fate paper = fate_of(ladder, kPaper);
    EXPECT_EQ(breaks_text(paper), "at 10");
    EXPECT_EQ(paper.step, 1u);
    EXPECT_EQ(paper.breaks->failed(), 5u);
    EXPECT_EQ(paper.worst->failed(), 9u);
    EXPECT_EQ(breaks_text(fate_of(ladder, kGrid)), "never");
    EXPECT_EQ(breaks_text(fate_of(ladder, kTwin)), "not run");
}

TEST(LadderFate, tells_a_refusal_from_a_rung_that_held) {
    LadderRecord ladder = small_ladder({{kPaper.tracer, {0, 0, 0}}});
    ladder.rungs[1].trials = 0;
    ladder.rungs[1].refusal = "too large";
    EXPECT_EQ(breaks_text(fate_of(ladder, kPaper)), "never");
    EXPECT_EQ(fate_of(ladder, kPaper).refusals, 1u);
    EXPECT_EQ(fate_of(ladder, kPaper).climbed, 2u);
    for (RungRecord& rung : ladder.rungs) {
        rung.trials = 0;
        rung.refusal = "too large";
    }
    EXPECT_EQ(breaks_text(fate_of(ladder, kPaper)), "refused");
}

TEST(LadderFate, counts_a_rung_that_is_refused_in_part_as_climbed) {
    LadderRecord ladder = small_ladder({{kFast.tracer, {0, 0, 0}}});
    ladder.rungs[2].trials = 4000;
    ladder.rungs[2].refusal = "96 rays it cannot take";
    const Fate fate = fate_of(ladder, kFast);
    EXPECT_EQ(fate.climbed, 3u);
    EXPECT_EQ(fate.refusals, 0u);
}

TEST(LadderKnob, reads_as_label_or_as_a_number_without_an_exponent) {
    const auto text = [](double knob, const std::string& label = "") {
        return knob_text({.knob = knob, .label = label});
    };
    EXPECT_EQ(text(0.0, "-0"), "-0");
    EXPECT_EQ(text(0.5), "0.5");
    EXPECT_EQ(text(1000), "1,000");
    EXPECT_EQ(text(1e5), "100,000");
    EXPECT_EQ(text(1e6), "10⁶");
    EXPECT_EQ(text(65536), "65,536");
    EXPECT_EQ(text(1e-7), "10⁻⁷");
    EXPECT_EQ(text(2.5e9), "2.5 × 10⁹");
    EXPECT_EQ(text(-1e12), "−10¹²");
    EXPECT_EQ(text(0.0), "0");
    EXPECT_EQ(text(std::nan("")), "–");
}

TEST(LadderOrder, puts_the_four_that_are_compared_first_and_twins_last) {
    const std::vector<LadderRecord> ladders = invented_ladders();
    std::vector<std::string> names;
    for (const Climber& climber : climbers({&ladders[0], &ladders[2]})) {
        names.push_back(name_of(climber));
    }
    EXPECT_EQ(names, (std::vector<std::string>{
                         "paper/texture2d/fragment", "paper/texture2d/fragment (address=half)",
                         "grid/buffer/fragment", "embree/fast/threads", "embree/robust/threads",
                         "paper/texture2d/twin32", "paper/texture2d/twin64", "grid/buffer/twin32",
                         "grid/buffer/twin64"}));
}

// ---- Who fails first.

std::string sentence(const std::vector<LadderRecord>& ladders) {
    std::vector<LadderOfRun> all;
    for (const LadderRecord& ladder : ladders) all.push_back({&ladder, 0, false});
    return grid_first_sentence(all);
}

TEST(GridFirst, says_where_grid_is_the_first_to_fail) {
    const std::string alone =
        sentence({small_ladder({{kPaper.tracer, {0, 0, 1}}, {kGrid.tracer, {0, 2, 0}}}),
                  small_ladder({{kGrid.tracer, {0, 0, 0}}})});
    EXPECT_NE(alone.find("fails on 1 of the 2 ladders that it climbed"), std::string::npos)
        << alone;
    EXPECT_NE(alone.find("first to fail, alone or with others, on 1: <a href=\"#ladder-0-small\">A "
                         "small one</a> (at 10, alone)."),
              std::string::npos)
        << alone;
    const std::string together = sentence({small_ladder(
        {{kPaper.tracer, {0, 1, 1}}, {kGrid.tracer, {0, 2, 0}}, {kFast.tracer, {0, 0, 1}}})});
    EXPECT_NE(together.find("(at 10, with <code>paper</code>)"), std::string::npos) << together;
}

TEST(GridFirst, says_that_grid_is_nowhere_the_first) {
    const LadderRecord later = small_ladder(
        {{kPaper.tracer, {1, 1, 1}}, {kGrid.tracer, {0, 2, 0}}, {kFast.tracer, {2, 0, 0}}});
    const LadderRecord never =
        small_ladder({{kPaper.tracer, {1, 1, 1}}, {kGrid.tracer, {0, 0, 0}}});
    const std::string text = sentence({later, never});
    EXPECT_NE(text.find("fails on 1 of the 2 ladders"), std::string::npos) << text;
    EXPECT_NE(text.find("alone or with others, on none."), std::string::npos) << text;
    EXPECT_NE(text.find("Embree alone, it is the first on none."), std::string::npos) << text;
    EXPECT_NE(sentence({never, never}).find("fails on none of the 2 ladders"), std::string::npos);
    EXPECT_NE(sentence({small_ladder({{kPaper.tracer, {1, 1, 1}}})}).find("climbed none"),
              std::string::npos);
}

TEST(GridFirst, does_not_hide_behind_the_papers_tracer) {
    const std::string text = sentence({small_ladder(
        {{kPaper.tracer, {1, 1, 1}}, {kGrid.tracer, {0, 2, 0}}, {kFast.tracer, {0, 0, 5}}})});
    EXPECT_NE(text.find("alone or with others, on none."), std::string::npos) << text;
    EXPECT_NE(text.find("Embree alone, it is the first on 1: <a href=\"#ladder-0-small\">A small "
                        "one</a> (at 10, alone)."),
              std::string::npos)
        << text;
}

TEST(GridFirst, lets_no_twin_compete) {
    const LadderRecord ladder = small_ladder(
        {{kTwin.tracer, {1, 0, 0}}, {kGrid.tracer, {0, 0, 1}}, {kPaper.tracer, {0, 1, 1}}});
    EXPECT_EQ(earliest_failures(ladder), std::vector<Climber>{kPaper});
    EXPECT_NE(sentence({ladder}).find("alone or with others, on none."), std::string::npos);
}

// ---- The plot.

TEST(LadderChart, draws_a_rate_of_zero_below_one_over_the_trials_and_others_where_they_are) {
    LadderRecord ladder = small_ladder({{kPaper.tracer, {0, 1, 4096}}, {kGrid.tracer, {0, 0, 0}}});
    ladder.rungs[1].trials = 100000;  // the first of grid's
    const LadderChart chart = ladder_chart(ladder);
    EXPECT_EQ(chart.least_trials, 4096u);
    EXPECT_EQ(chart.most_trials, 100000u);
    EXPECT_LT(chart.band.high, 1.0 / 100000.0) << "the whole strip";
    std::vector<double> zeros;
    for (const LadderChart::Line& line : chart.lines) {
        for (const LadderChart::Point& point : line.points) {
            if (point.rung->failed() > 0) {
                EXPECT_DOUBLE_EQ(point.y, static_cast<double>(point.rung->failed()) / 4096.0);
                continue;
            }
            EXPECT_GT(point.y, chart.band.low);
            EXPECT_LT(point.y, 1.0 / 100000.0) << "below what any number of trials can tell";
            zeros.push_back(point.y);
        }
    }
    ASSERT_EQ(zeros.size(), 4u);
    EXPECT_NE(zeros[0], zeros[1]) << "lines of the strip stay apart";
    EXPECT_EQ(zeros[1], zeros[2]);
}

TEST(LadderChart, puts_hard_to_the_right_and_what_has_no_place_on_the_axis_last) {
    const LadderChart chart = ladder_chart(invented_ladders()[1]);
    std::vector<std::string> texts;
    for (size_t i = 0; i < chart.ticks.size(); ++i) {
        texts.push_back(chart.ticks[i].text);
    }
    for (size_t i = 1; i < chart.ticks.size(); ++i) {
        EXPECT_GT(chart.ticks[i].x, chart.ticks[i - 1].x) << texts[i];
    }
    EXPECT_EQ(texts, (std::vector<std::string>{"0.01", "10⁻⁴", "10⁻⁸", "10⁻²⁰", "0", "-0", "NaN"}));
    EXPECT_EQ(chart.ticks[0].x, 2.0) << "the logarithm of the knob, turned";
    EXPECT_EQ(chart.ticks[3].x, 20.0);
    EXPECT_EQ(chart.to_scale_until, 20.0);
}

TEST(LadderChart, leaves_refused_rungs_out_and_keeps_linear_axes) {
    const LadderChart chart = ladder_chart(invented_ladders()[2]);
    EXPECT_EQ(chart.ticks[3].x, 4.0);
    ASSERT_EQ(chart.lines.size(), 3u);
    EXPECT_EQ(name_of(chart.lines[1].climber), "paper/texture2d/fragment (address=half)");
    EXPECT_TRUE(chart.lines[1].points.empty());
    const LadderChart direction = ladder_chart(invented_ladders()[1]);
    EXPECT_EQ(direction.lines[2].climber, kFast);
    EXPECT_EQ(direction.lines[2].points.size(), 6u);
}

// ---- The page.

TEST(LadderPage, has_a_table_of_where_each_breaks_before_the_ladders) {
    const std::string page = visible(page_of(sample_run()));
    const std::string table = between(page, "class=\"ladders\"", "</table>");
    const std::string row = between(table, "Far from the origin", "</tr>");
    EXPECT_NE(
        row.find("<td class=\"text fail\"><span class=\"badge fail\">at 1</span><small>rung 1 "
                 "of 8: 12 of 4,096</small><small><strong>first to fail</strong></small>"),
        std::string::npos)
        << row;
    EXPECT_NE(row.find("at 10⁶</span><small>rung 7 of 8: 300 of 4,096"), std::string::npos) << row;
    EXPECT_EQ(count_of(row, "first to fail"), 1u);
    EXPECT_EQ(row.find("twin"), std::string::npos);
    const std::string direction = between(table, "A direction component", "</tr>");
    EXPECT_NE(direction.find("badge pass\">never</span><small>1 rung refused"), std::string::npos)
        << direction;
    const std::string resolution = between(table, "Grid resolution", "</tr>");
    EXPECT_NE(resolution.find("badge depends\">refused</span>"), std::string::npos) << resolution;
    EXPECT_NE(resolution.find("<td class=\"text\">–</td>"), std::string::npos)
        << "Embree did not climb";
    EXPECT_NE(page.find("The same of 4 twins"), std::string::npos);
    EXPECT_LT(page.find("class=\"ladders\""), page.find("class=\"ladder\""));
    EXPECT_NE(page.find("fails on 2 of the 3 ladders"), std::string::npos)
        << "the sentence on grid";
}

TEST(LadderPage, gives_each_ladder_its_question_judge_command_reasons_and_worst_rays) {
    const std::string page = visible(page_of(sample_run()));
    const std::string first = between(page, "id=\"ladder-0-translation\"", "</article>");
    for (const char* text :
         {"An invented question", "Judge: exact",
          "<code class=\"copy\">onepass stress translation<",
          "data-chart=\"ladder\" data-ladder=\"0\"", "<code>wrong_surface</code> 12",
          "12 of 4,096<small>0.293\u00a0%", "none of 32,768",
          "--ray 0.1,0.33333334,2.5,0.0625,-0.25,-1,0,inf</code>"}) {
        EXPECT_NE(first.find(text), std::string::npos) << text;
    }
    const std::string rungs = between(first, "Every rung", "</table>");
    EXPECT_EQ(count_of(rungs, "<th scope=\"row\">"), 8u);
    EXPECT_EQ(count_of(rungs, "<small>of 4,096</small>"), 8u * 8u);
    const std::string last = between(page, "id=\"ladder-0-resolution\"", "</article>");
    EXPECT_NE(last.find("No judge"), std::string::npos);
    EXPECT_EQ(count_of(last.substr(0, last.find("Every rung")), "expected at most 65,536"), 1u)
        << "one reason for four rungs is said once";
    EXPECT_EQ(count_of(last, ">refused</td>"), 4u);
}

TEST(LadderPage, escapes_every_text_of_a_ladder_and_of_a_point) {
    Results run;
    run.manifest.judge = kHostileText;
    run.ladders = {hostile_ladder()};
    run.tradeoffs = {invented_point(kHostileText, kHostileText, kHostileText, kHostileText, 1.0, 1),
                     invented_point("another", kHostileText, "t", "", 1.0, 1)};
    for (TradeoffPoint& point : run.tradeoffs) point.oracle = kHostileText;
    const std::string page = page_of(run);
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    EXPECT_EQ(count_of(page, "</script>"), 3u);
    EXPECT_NE(page.find("&lt;script&gt;alert(&#39;&amp;&quot;&#39;)&lt;/script&gt;"),
              std::string::npos);
    EXPECT_EQ(data_of(page)["ladders"][0]["ticks"][0]["text"], kHostileText);
}

TEST(LadderPage, of_ladders_alone_has_no_empty_summary) {
    Results run;
    run.ladders = invented_ladders();
    const std::string page = visible(page_of(run));
    EXPECT_EQ(page.find("id=\"summary\""), std::string::npos);
    EXPECT_NE(page.find("pushed until it fails"), std::string::npos);
    EXPECT_EQ(page.find("id=\"tradeoff\""), std::string::npos);
}

TEST(LadderPage, tells_ladders_of_two_runs_apart) {
    const std::string page = visible(render_report({sample_run(), sample_run()}, {".", "."}));
    EXPECT_NE(page.find("id=\"ladder-0-translation\""), std::string::npos);
    EXPECT_NE(page.find("id=\"ladder-1-translation\""), std::string::npos);
    EXPECT_NE(page.find("<small>run 2</small>"), std::string::npos);
}

TEST(TradeoffPage, shows_no_speed_without_its_errors) {
    const std::string page = visible(page_of(sample_run()));
    size_t speeds = 0;
    for (size_t at = page.find("<tr"); at != std::string::npos; at = page.find("<tr", at + 1)) {
        const std::string row = page.substr(at, page.find("</tr>", at) - at);
        if (row.find("class=\"speed\"") == std::string::npos) continue;
        ++speeds;
        EXPECT_NE(row.find("class=\"errors"), std::string::npos) << row;
    }
    EXPECT_EQ(speeds, 14u + 15u + 14u) << "over both scenes, in each";
    for (const auto& cloud : data_of(page_of(sample_run()))["tradeoffs"]) {
        for (const auto& point : cloud["points"]) EXPECT_TRUE(point.contains("errors"));
    }
}

TEST(TradeoffPage, marks_the_front_and_the_front_without_embree) {
    const Results run = sample_run();
    const std::vector<Results> runs = {run};
    const std::vector<std::filesystem::path> folders = {"."};
    const std::vector<Cloud> all = clouds(gather(runs, folders));
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].title, "All 2 scenes");
    std::vector<std::string> front, rest;
    for (size_t i = 0; i < all[0].points.size(); ++i) {
        const TradeoffPoint& point = all[0].points[i];
        if (all[0].front[i]) front.push_back(name_of({point.tracer, point.setting}));
        if (all[0].front_of_rest[i]) rest.push_back(name_of({point.tracer, point.setting}));
    }
    EXPECT_EQ(front, (std::vector<std::string>{"embree/robust/threads", "embree/fast/threads"}));
    EXPECT_EQ(rest, (std::vector<std::string>{"paper/texture2d/fragment (edge_tolerance=1)",
                                              "paper/texture2d/fragment (address=half)",
                                              "paper/texture2d/fragment (geometry=half)",
                                              "grid/buffer/fragment"}));
    const std::string page = visible(page_of(run));
    EXPECT_NE(page.find("badge pass\">On it"), std::string::npos);
    EXPECT_NE(page.find("badge depends\">Without Embree"), std::string::npos);
    EXPECT_NE(page.find("Not measured everywhere, and so not here: "
                        "<code>brute_force/texture2d/fragment (edge_tolerance=1)</code>"),
              std::string::npos);
}

TEST(TradeoffPage, puts_points_without_an_error_below_one_over_the_rays) {
    const std::vector<Results> runs = {sample_run()};
    const std::vector<std::filesystem::path> folders = {"."};
    for (const Cloud& cloud : clouds(gather(runs, folders))) {
        const CloudAxis axis = cloud_axis(cloud);
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            const auto rays = static_cast<double>(cloud.points[i].ray_count);
            if (cloud.points[i].errors == 0) {
                EXPECT_LT(axis.x[i], 1.0 / rays);
                EXPECT_GT(axis.x[i], axis.band.low);
            } else {
                EXPECT_DOUBLE_EQ(axis.x[i], static_cast<double>(cloud.points[i].errors) / rays);
            }
        }
    }
}

TEST(LadderPage, is_written_where_asked) {
    Results run = sample_run();
    run.ladders.push_back(hostile_ladder());
    const std::string page = page_of(run);
    if (const char* path = std::getenv("ONEPASS_LADDER_SAMPLE")) std::ofstream(path) << page;
    EXPECT_TRUE(page.starts_with("<!doctype html>"));
}

}  // namespace
}  // namespace onepass
