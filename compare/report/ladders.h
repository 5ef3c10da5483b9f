// What ladders say, sorted for the page: who climbed, where each breaks, who fails first, and the
// places of the chart's points. Holds pointers into the Results; knows no HTML.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/results.h"

namespace onepass::report {

/// A tracer with the setting that it keeps on all rungs.
struct Climber {
    std::string tracer;
    std::string setting;

    bool operator==(const Climber&) const = default;
};

/// "paper/texture2d/fragment (address=half)". Not escaped.
std::string name_of(const Climber& climber);

/// A shader's text run as C++: its entry is twin32 or twin64.
bool is_twin(const Climber& climber);

/// What shares a colour: the strategy; of Embree, also its mode: "paper", "embree/fast".
std::string family_of(const std::string& tracer);

/// All that climbed one of the ladders: paper, grid, Embree fast, Embree robust, then others; the
/// twins after them in the same order. Within a strategy in the order of first appearance.
std::vector<Climber> climbers(const std::vector<const LadderRecord*>& ladders);

/// Families in the same order: the index of one is its colour.
std::vector<std::string> families(const std::vector<const LadderRecord*>& ladders);

/// The rungs' knobs in the order of the ladder, each by the first record that has it.
std::vector<const RungRecord*> steps(const LadderRecord& ladder);

/// What `climber` did on each step; null where it did not take part.
std::vector<const RungRecord*> rungs_of(const LadderRecord& ladder, const Climber& climber);

/// The rung as text: its label; else the knob, "0.5", "65,536", "10⁻⁷", "2.5 × 10⁹".
std::string knob_text(const RungRecord& rung);

/// What became of one climber on one ladder.
struct Fate {
    enum class Kind { absent, never, breaks, refused } kind = Kind::absent;
    const RungRecord* breaks = nullptr;  ///< breaks_at()
    size_t step = 0;                     ///< of `breaks`, from 0
    size_t climbed = 0;                  ///< steps on which it answered
    size_t refusals = 0;                 ///< steps that it refused
    const RungRecord* worst = nullptr;   ///< the largest share of failures; null if none
};

/// `never`: answered somewhere and failed nowhere; `refused`: answered nowhere.
Fate fate_of(const LadderRecord& ladder, const Climber& climber);

/// "never", "at 10⁴", "refused", "not run". Not escaped.
std::string breaks_text(const Fate& fate);

/// The climbers, twins apart, that fail on the lowest step on which any of them does.
std::vector<Climber> earliest_failures(const LadderRecord& ladder);

// ---- The chart.

/// The strip at the end of a logarithmic axis of rates where a rate of 0 is drawn. All of it is
/// below 1 / trials, for as many trials as were made: more is not known of a rate of 0.
struct ZeroBand {
    double low = 0.0;
    double high = 0.0;
};
ZeroBand zero_band(uint64_t most_trials);

/// One of `count` places across the strip, so that what is equally 0 stays apart.
double lane(const ZeroBand& band, size_t index, size_t count);

struct LadderChart {
    struct Tick {
        double x = 0.0;
        std::string text;
    };
    struct Point {
        double x = 0.0;
        double y = 0.0;  ///< failed / trials; in the strip if that is 0
        const RungRecord* rung = nullptr;
    };
    struct Line {
        Climber climber;
        std::vector<Point> points;  ///< of the rungs that it answered, from left to right
    };
    std::vector<Tick> ticks;  ///< one a step
    std::vector<Line> lines;
    ZeroBand band;
    uint64_t least_trials = 0;
    uint64_t most_trials = 0;
    double to_scale_until = 0.0;  ///< x of the last tick that is to scale
};

/// x grows from harmless to hard. It is the knob, or its decimal logarithm where the ladder asks
/// for one; a rung whose knob has no place of its own there (NaN, 0 on a logarithmic axis, -0
/// beside 0) follows the others at their mean distance.
LadderChart ladder_chart(const LadderRecord& ladder);

}  // namespace onepass::report
