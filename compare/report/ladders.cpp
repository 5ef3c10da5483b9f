#include "compare/report/ladders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "compare/report/html.h"

namespace onepass::report {
namespace {

/// The strategies that every summary names first.
constexpr std::array<std::string_view, 4> kFirst = {"paper", "grid", "embree/fast",
                                                    "embree/robust"};

size_t rank_of(const std::string& family) {
    const auto found = std::find(kFirst.begin(), kFirst.end(), family);
    return static_cast<size_t>(found - kFirst.begin());
}

/// NaN is the same knob as NaN.
bool same_step(const RungRecord& a, const RungRecord& b) {
    const bool same_knob = a.knob == b.knob || (std::isnan(a.knob) && std::isnan(b.knob));
    return same_knob && a.label == b.label;
}

double share(const RungRecord& rung) {
    return static_cast<double>(rung.failed()) / static_cast<double>(rung.trials);
}

std::string superscript(int exponent) {
    static constexpr std::array kDigits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = exponent < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(exponent))) {
        text += kDigits[static_cast<size_t>(digit - '0')];
    }
    return text;
}

/// "10⁵", "2.5 × 10⁻⁷": two decimals at most.
std::string power_text(double value) {
    const std::string digits = fmt::format("{:.2e}", std::abs(value));
    const size_t e = digits.find('e');
    std::string mantissa = digits.substr(0, e);
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.ends_with('.')) mantissa.pop_back();
    const std::string power = "10" + superscript(std::atoi(digits.c_str() + e + 1));
    return (value < 0.0 ? "−" : "") + (mantissa == "1" ? power : mantissa + " × " + power);
}

}  // namespace

std::string name_of(const Climber& climber) {
    return climber.setting.empty() ? climber.tracer
                                   : fmt::format("{} ({})", climber.tracer, climber.setting);
}

bool is_twin(const Climber& climber) {
    return climber.tracer.substr(climber.tracer.rfind('/') + 1).starts_with("twin");
}

std::string family_of(const std::string& tracer) {
    const size_t slash = tracer.find('/');
    const std::string strategy = tracer.substr(0, slash);
    return strategy == "embree" ? tracer.substr(0, tracer.find('/', slash + 1)) : strategy;
}

std::vector<Climber> climbers(const std::vector<const LadderRecord*>& ladders) {
    std::vector<Climber> all;
    for (const LadderRecord* ladder : ladders) {
        for (const RungRecord& rung : ladder->rungs) {
            const Climber climber{rung.tracer, rung.setting};
            if (std::find(all.begin(), all.end(), climber) == all.end()) all.push_back(climber);
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Climber& a, const Climber& b) {
        return std::pair(is_twin(a), rank_of(family_of(a.tracer))) <
               std::pair(is_twin(b), rank_of(family_of(b.tracer)));
    });
    return all;
}

std::vector<std::string> families(const std::vector<const LadderRecord*>& ladders) {
    std::vector<std::string> all(kFirst.begin(), kFirst.end());
    for (const Climber& climber : climbers(ladders)) {
        const std::string family = family_of(climber.tracer);
        if (std::find(all.begin(), all.end(), family) == all.end()) all.push_back(family);
    }
    return all;
}

std::vector<const RungRecord*> steps(const LadderRecord& ladder) {
    std::vector<const RungRecord*> all;
    for (const RungRecord& rung : ladder.rungs) {
        const bool known = std::any_of(
            all.begin(), all.end(), [&](const RungRecord* step) { return same_step(*step, rung); });
        if (!known) all.push_back(&rung);
    }
    return all;
}

std::vector<const RungRecord*> rungs_of(const LadderRecord& ladder, const Climber& climber) {
    std::vector<const RungRecord*> all;
    for (const RungRecord* step : steps(ladder)) {
        const auto own =
            std::find_if(ladder.rungs.begin(), ladder.rungs.end(), [&](const RungRecord& rung) {
                return same_step(rung, *step) && Climber{rung.tracer, rung.setting} == climber;
            });
        all.push_back(own == ladder.rungs.end() ? nullptr : &*own);
    }
    return all;
}

std::string knob_text(const RungRecord& rung) {
    if (!rung.label.empty()) return rung.label;
    const double magnitude = std::abs(rung.knob);
    if (!std::isfinite(rung.knob) || magnitude == 0.0) return significant(rung.knob);
    if (magnitude < 1e-3 || magnitude >= 1e6) return power_text(rung.knob);
    const bool decade = magnitude >= 1e4 && std::fmod(std::log10(magnitude), 1.0) == 0.0;
    if (decade) return power_text(rung.knob);
    const std::string sign = rung.knob < 0.0 ? "−" : "";
    if (magnitude == std::floor(magnitude)) return sign + grouped(static_cast<uint64_t>(magnitude));
    return sign + fmt::format("{:.4g}", magnitude);
}

Fate fate_of(const LadderRecord& ladder, const Climber& climber) {
    Fate fate;
    fate.breaks = breaks_at(ladder, climber.tracer, climber.setting);
    const std::vector<const RungRecord*> rungs = rungs_of(ladder, climber);
    for (size_t i = 0; i < rungs.size(); ++i) {
        const RungRecord* rung = rungs[i];
        if (!rung) continue;
        if (rung == fate.breaks) fate.step = i;
        ++(rung->trials > 0 ? fate.climbed : fate.refusals);
        if (rung->failed() > 0 && (!fate.worst || share(*rung) > share(*fate.worst))) {
            fate.worst = rung;
        }
    }
    fate.kind = fate.breaks         ? Fate::Kind::breaks
                : fate.climbed > 0  ? Fate::Kind::never
                : fate.refusals > 0 ? Fate::Kind::refused
                                    : Fate::Kind::absent;
    return fate;
}

std::string breaks_text(const Fate& fate) {
    switch (fate.kind) {
        case Fate::Kind::never:
            return "never";
        case Fate::Kind::breaks:
            return "at " + knob_text(*fate.breaks);
        case Fate::Kind::refused:
            return "refused";
        case Fate::Kind::absent:
            break;
    }
    return "not run";
}

std::vector<Climber> earliest_failures(const LadderRecord& ladder) {
    std::vector<Climber> first;
    size_t lowest = std::numeric_limits<size_t>::max();
    for (const Climber& climber : climbers({&ladder})) {
        const Fate fate = fate_of(ladder, climber);
        if (is_twin(climber) || !fate.breaks || fate.step > lowest) continue;
        if (fate.step < lowest) first.clear();
        lowest = fate.step;
        first.push_back(climber);
    }
    return first;
}

// ---- The chart.

ZeroBand zero_band(uint64_t most_trials) {
    // Wide enough for a dozen lanes, and a sixth of the axis: it says no more than "less".
    const double decades = std::max(0.6, 0.2 * std::log10(static_cast<double>(most_trials)));
    const double high = 0.7 / static_cast<double>(most_trials);
    return {high * std::pow(10.0, -decades), high};
}

double lane(const ZeroBand& band, size_t index, size_t count) {
    const double at = (static_cast<double>(index) + 0.5) / static_cast<double>(count);
    return band.high * std::pow(band.low / band.high, at);
}

LadderChart ladder_chart(const LadderRecord& ladder) {
    // Places along x, to scale where the knob has one.
    LadderChart chart;
    const std::vector<const RungRecord*> rungs = steps(ladder);
    std::vector<double> xs;
    double first = std::numeric_limits<double>::quiet_NaN(), last = first;
    for (const RungRecord* step : rungs) {
        double x = ladder.log_axis ? std::log10(step->knob) : step->knob;
        if (!std::isfinite(x) || std::find(xs.begin(), xs.end(), x) != xs.end()) {
            x = std::numeric_limits<double>::quiet_NaN();
        } else {
            if (std::isnan(first)) first = x;
            last = x;
        }
        xs.push_back(x);
    }
    if (last < first) {
        for (double& x : xs) x = -x;  // hard is to the right
    }
    double low = std::numeric_limits<double>::infinity(), high = -low, placed = 0.0;
    for (const double x : xs) {
        if (std::isnan(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
        placed += 1.0;
    }
    if (placed == 0.0) low = high = 0.0;
    const double distance = placed > 1.0 ? (high - low) / (placed - 1.0) : 1.0;
    chart.to_scale_until = high;
    for (size_t i = 0; i < rungs.size(); ++i) {
        if (std::isnan(xs[i])) xs[i] = high += distance;
        chart.ticks.push_back({xs[i], knob_text(*rungs[i])});
    }

    // The strip.
    for (const RungRecord& rung : ladder.rungs) {
        if (rung.trials == 0) continue;
        chart.most_trials = std::max(chart.most_trials, rung.trials);
        chart.least_trials =
            chart.least_trials == 0 ? rung.trials : std::min(chart.least_trials, rung.trials);
    }
    chart.band = zero_band(std::max<uint64_t>(1, chart.most_trials));

    // Lines.
    const std::vector<Climber> all = climbers({&ladder});
    for (size_t c = 0; c < all.size(); ++c) {
        LadderChart::Line& line = chart.lines.emplace_back();
        line.climber = all[c];
        const std::vector<const RungRecord*> own = rungs_of(ladder, all[c]);
        for (size_t i = 0; i < own.size(); ++i) {
            if (!own[i] || own[i]->trials == 0) continue;
            const double y =
                own[i]->failed() == 0 ? lane(chart.band, c, all.size()) : share(*own[i]);
            line.points.push_back({xs[i], y, own[i]});
        }
        std::sort(line.points.begin(), line.points.end(),
                  [](const auto& a, const auto& b) { return a.x < b.x; });
    }
    return chart;
}

}  // namespace onepass::report
