#include "compare/claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "compare/statistics.h"
#include "compare/verdict.h"
#include "core/error.h"

namespace onepass {
namespace {

// ---- The settings that experiments are put together from.

const std::string kPaper = "paper/texture2d/*";
const std::string kSwitches = "paper_claims/texture2d/*";
const std::string kStreaming = "streaming/texture2d/*";
const std::string kBruteForce = "brute_force/texture2d/*";
const std::string kEmbree = "embree/fast/threads";

/// Pixels a side of images that are streamed: a thousand passes take seconds on two cores.
constexpr uint32_t kStreamingSide = 128;

constexpr char kNoFigure[] = "no figure given";
constexpr char kText[] = "the paper's text";

constexpr Probe kSlower{Quantity::time, Expectation::above, 1.0};
constexpr Probe kHardlyFaster{Quantity::time, Expectation::above, 1.0 / kLittle};
constexpr Probe kHardlySlower{Quantity::time, Expectation::below, kLittle};
constexpr Probe kFaster{Quantity::time, Expectation::below, 1.0};
constexpr Probe kLarger{Quantity::memory, Expectation::above, 1.0};

Setting paper(ParamValues params = {}, SceneForm form = SceneForm::as_is) {
    return {kPaper, std::move(params), form, 0.0};
}
Setting with(const std::string& param, const std::string& value) {
    return {kSwitches, {{param, value}}, SceneForm::as_is, 0.0};
}

/// Its copies are timed apart from its frames.
Setting streaming(ParamValues params) {
    params["measure_copy"] = "1";
    return {kStreaming, std::move(params), SceneForm::as_is, 0.0};
}

/// The same comparison on several scenes.
std::vector<Experiment> on(const std::vector<std::string>& scenes, const Experiment& experiment) {
    std::vector<Experiment> all;
    for (const std::string& scene : scenes) {
        all.push_back(experiment);
        all.back().scene = scene;
    }
    return all;
}

std::vector<Experiment> joined(std::vector<Experiment> a, const std::vector<Experiment>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// Balls of 16 to 34,848 triangles: below the 35,000 of the paper's largest scenes.
const std::vector<std::pair<std::string, double>> kBalls = {
    {"sphere-4x3", 16},       {"sphere-8x5", 64},     {"sphere-16x9", 256},
    {"sphere-32x17", 1024},   {"sphere-64x33", 4096}, {"sphere-128x65", 16384},
    {"sphere-132x133", 34848}};

std::vector<Experiment> ball_series() {
    std::vector<Experiment> all;
    for (const auto& [scene, triangles] : kBalls) {
        all.push_back({scene,
                       "primary",
                       64,
                       paper(),
                       {{kBruteForce, {}, SceneForm::as_is, triangles}},
                       {kSlower},
                       true});
    }
    return all;
}

std::vector<Setting> densities() {
    std::vector<Setting> all;
    for (const char* density : {"1", "2", "3", "8", "16"}) {
        all.push_back(paper({{"density", density}}));
        all.back().size = std::stod(density);
    }
    all.push_back(paper({{"top_density", "4"}}));
    return all;
}

std::vector<Claim> make_claims() {
    const auto image = [](Setting baseline, std::vector<Setting> variants,
                          std::vector<Probe> probes) {
        return Experiment{
            "", "image", 256, std::move(baseline), std::move(variants), std::move(probes)};
    };
    const auto rays = [](Setting baseline, std::vector<Setting> variants,
                         std::vector<Probe> probes) {
        return Experiment{
            "", "primary", 256, std::move(baseline), std::move(variants), std::move(probes)};
    };
    return {
        {"single-pass",
         "Tracing a ray in one pass beats streaming its state through textures from pass to pass.",
         kText, kNoFigure, "streaming against one pass",
         "Streaming has to take more time and move more bytes a frame, with 1 step a pass, as its "
         "authors have it, and with 16.",
         Reading::each,
         on({"balls-1", "chair-wood"},
            {"",
             "image",
             kStreamingSide,
             paper(),
             {streaming({{"steps_per_pass", "1"}}), streaming({{"steps_per_pass", "16"}})},
             {kSlower, {Quantity::traffic, Expectation::above, 1.0}}})},
        {"compute-bound", "The tracer is bound by computation, not by bandwidth.", kText, kNoFigure,
         "fetches against a plain copy, and addresses of twice the width against half",
         "Its fetches have to ask for fewer bytes a second than a plain copy moves on the same "
         "device, and addresses of twice the width may cost at most a tenth of the time.",
         Reading::each,
         joined({{"balls-1",
                  "primary",
                  kStreamingSide,
                  streaming({{"steps_per_pass", "16"}}),
                  {paper()},
                  {{Quantity::bandwidth, Expectation::below, 1.0}}}},
                on({"balls-1", "palace"}, rays(paper({{"address", "half"}}),
                                               {paper({{"address", "float"}})}, {kHardlySlower})))},
        {"two-levels",
         "Two levels of grids cost nothing that their better resolution does not repay.", kText,
         kNoFigure, "one flat grid against two levels",
         "One flat grid over all triangles may be faster by at most a tenth, and has to take more "
         "memory and longer to build.",
         Reading::each,
         on({"balls-1", "palace"},
            rays(paper(), {paper({}, SceneForm::flattened)},
                 {kHardlyFaster, kLarger, {Quantity::build, Expectation::above, 1.0}}))},
        {"merged-loop", "Running the top level as one merged loop costs little.",
         "figure 3; only four nested loops were to be had", kNoFigure,
         "nested loops against the merged one", "Nested loops may be faster by at most a tenth.",
         Reading::each,
         on({"balls-1", "palace"},
            rays({kSwitches}, {with("top_loop", "nested")}, {kHardlyFaster}))},
        {"combined-test",
         "One combined boolean expression beats testing a triangle's conditions one after the "
         "other.",
         kText, kNoFigure, "sequential tests against one expression",
         "Sequential tests have to be slower.", Reading::each,
         on({"balls-1", "sr71a"},
            rays({kSwitches}, {with("triangle_test", "sequential")}, {kSlower}))},
        {"early-out", "Leaving the triangle test early by a branch makes the tracer faster.", kText,
         "10 % on ATI", "with the branch against without", "The branch has to make it faster.",
         Reading::each,
         on({"balls-1", "sr71a"},
            rays({kSwitches}, {with("triangle_test", "early_out")}, {kFaster}))},
        {"vectors-4d", "Arithmetic on 4D vectors beats arithmetic on 3D vectors.", kText, kNoFigure,
         "3D against 4D vectors", "3D vectors have to be slower.", Reading::each,
         on({"balls-1", "sr71a"}, rays(with("vectors", "4d"), {with("vectors", "3d")}, {kSlower}))},
        {"shared-references",
         "Lists of references to shared triangles beat copies of the triangles in every cell.",
         "section 4", kNoFigure, "copies against shared references",
         "Copies have to take more time and more memory.", Reading::each,
         on({"balls-1", "sr71a"},
            rays({kSwitches}, {{"paper_claims/texture2d_copies/*"}}, {kSlower, kLarger}))},
        {"direct-addresses", "Direct 2D and 3D texture addresses beat virtual 1D arrays.",
         "section 4", kNoFigure, "virtual 1D arrays against direct addresses",
         "Virtual 1D arrays have to be slower.", Reading::each,
         on({"balls-1", "palace"},
            rays({kSwitches}, {{"paper_claims/texture2d_virtual/*"}}, {kSlower}))},
        {"half-addresses", "16-bit floats suffice as texture addresses.", "section 4", kNoFigure,
         "16-bit against 32-bit addresses",
         "Against 32-bit addresses they may neither add errors nor take more than a tenth longer; "
         "and a scene of 319,200 triangles has to fit.",
         Reading::each,
         joined(on({"balls-1", "palace"},
                   rays(paper({{"address", "float"}}), {paper({{"address", "half"}})},
                        {kHardlySlower,
                         {Quantity::errors, Expectation::below, kLittle},
                         {Quantity::memory, Expectation::below, 1.0}})),
                {{"sphere-400x400",
                  "primary",
                  64,
                  paper({{"address", "float"}}),
                  {paper({{"address", "half"}})},
                  {{Quantity::errors, Expectation::possible}}}})},
        {"float-geometry", "Geometry needs 32-bit floats: 16-bit ones leave holes.", "section 4",
         kNoFigure, "16-bit against 32-bit geometry",
         "16-bit planes have to add errors, be they stored in the object's frame or relative to "
         "the "
         "triangle's first corner.",
         Reading::each,
         on({"knife", "balls-1", "sr71a"},
            rays(paper(),
                 {paper({{"geometry", "half"}}),
                  paper({{"geometry", "half"}, {"local_planes", "1"}})},
                 {{Quantity::errors, Expectation::above, 1.0}}))},
        {"instancing-memory", "Instancing saves memory.", kText, kNoFigure,
         "nothing shared, and one flat grid, against instances",
         "An object of its own for every instance, and one flat grid, have to take more memory.",
         Reading::each,
         on({"balls-1", "palace", "hind24"},
            {"",
             "primary",
             64,
             paper(),
             {paper({}, SceneForm::unshared), paper({}, SceneForm::flattened)},
             {kLarger}})},
        {"moving-objects", "Moving objects costs little: only the top-level grid changes.", kText,
         kNoFigure, "update and upload against tracing",
         "Rebuilding the top level and bringing it to the device may take at most a tenth of the "
         "time that tracing the frame takes. Embree's update stands beside it.",
         Reading::each,
         on({"balls-1", "hind24-flying"},
            {"",
             "animation",
             256,
             paper(),
             {paper(), {"embree/robust/threads"}},
             {{Quantity::update, Expectation::below, kLittle - 1.0}}})},
        {"default-grid", "Grids sized by a default formula come close to hand-tuned ones.", kText,
         "no figure and no formula given; here 5 cells a triangle, 1.2 an instance",
         "other densities against the default",
         "On each scene no other density may be faster by more than a tenth.", Reading::worst,
         on({"balls-1", "palace", "sr71a"}, rays(paper(), densities(), {kHardlyFaster}))},
        {"cpu-tracer", "The tracer is comparable with an optimised CPU tracer.", kText, kNoFigure,
         "the tracer against Embree",
         "It may take at most twice the time of Embree's fast mode on all threads.", Reading::each,
         joined(
             on({"balls-1", "palace"},
                rays({kEmbree}, {paper()}, {{Quantity::time, Expectation::below, kComparable}})),
             on({"balls-1", "palace"},
                image({kEmbree}, {paper()}, {{Quantity::time, Expectation::below, kComparable}})))},
        {"acceleration", "Spatial subdivision gains a factor of more than 100.", kText,
         "more than 100", "brute force against grids",
         "Brute force has to take more than 100 times as long.", Reading::each,
         on({"balls-1", "chair-wood"}, {"",
                                        "primary",
                                        64,
                                        paper(),
                                        {{kBruteForce}},
                                        {{Quantity::time, Expectation::above, 100.0}},
                                        true})},
        {"brute-force", "The grid beats brute force, however small the scene.", "not claimed",
         "not asked", "brute force against grids",
         "Brute force has to be slower on each of a series of balls of 16 to 34,848 triangles, "
         "64 x 64 rays.",
         Reading::series, ball_series()},
    };
}

// ---- Verdicts.

ClaimVerdict agreed(const std::vector<ClaimVerdict>& verdicts) {
    ClaimVerdict all = ClaimVerdict::not_measured;
    for (const ClaimVerdict verdict : verdicts) {
        if (verdict == ClaimVerdict::not_measured) continue;
        if (all == ClaimVerdict::not_measured) all = verdict;
        if (all != verdict) return ClaimVerdict::depends;
    }
    return all;
}

ClaimVerdict worst(const std::vector<ClaimVerdict>& verdicts) {
    for (const ClaimVerdict one :
         {ClaimVerdict::fails, ClaimVerdict::depends, ClaimVerdict::holds}) {
        if (std::find(verdicts.begin(), verdicts.end(), one) != verdicts.end()) return one;
    }
    return ClaimVerdict::not_measured;
}

// ---- Findings.

std::string number(double value) {
    if (std::isinf(value)) return "∞";
    return value >= 1000.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void extend(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    std::string text() const {
        const std::string a = number(low), b = number(high);
        return a == b ? a : a + " to " + b;
    }
};

bool is_compared(const ClaimMeasurement& m) {
    return m.expectation != Expectation::possible && m.expectation != Expectation::none &&
           m.verdict != ClaimVerdict::not_measured;
}

std::string ratios(const std::vector<ClaimMeasurement>& measurements) {
    std::map<std::string, Range> by_quantity;
    std::vector<std::string> order;
    for (const ClaimMeasurement& m : measurements) {
        if (!is_compared(m)) continue;
        if (!by_quantity.contains(m.quantity)) order.push_back(m.quantity);
        by_quantity[m.quantity].extend(m.ratio);
    }
    std::string text;
    for (const std::string& quantity : order) {
        text += fmt::format("{}{} × {}", text.empty() ? "" : "; ", quantity,
                            by_quantity[quantity].text());
    }
    return text;
}

/// Where a series crosses 1: the sizes at which the ratio is surely below, and surely above.
std::string crossing(const std::vector<ClaimMeasurement>& measurements) {
    double last_below = 0.0;
    double first_above = std::numeric_limits<double>::infinity();
    for (const ClaimMeasurement& m : measurements) {
        if (m.verdict == ClaimVerdict::fails) last_below = std::max(last_below, m.size);
        if (m.verdict == ClaimVerdict::holds) first_above = std::min(first_above, m.size);
    }
    std::string text;
    if (last_below > 0.0) text += fmt::format("; below 1 up to {} triangles", last_below);
    if (std::isfinite(first_above)) {
        text += fmt::format("; above 1 from {} triangles on", first_above);
    }
    return text;
}

/// Why a side's speed is none; empty for what is no speed.
std::string wrongness(const ClaimMeasurement& m) {
    const bool is_speed = m.quantity == to_string(Quantity::time) ||
                          m.quantity == to_string(Quantity::traffic) ||
                          m.quantity == to_string(Quantity::bandwidth);
    const auto most = static_cast<uint64_t>(kMostErrors * static_cast<double>(m.rays));
    if (!is_speed || std::max(m.baseline_errors, m.variant_errors) <= most) return "";
    const bool variant = m.variant_errors > most;
    return fmt::format("{} errs on {} of {} rays: its speed means nothing",
                       variant ? m.variant : m.baseline,
                       variant ? m.variant_errors : m.baseline_errors, m.rays);
}

}  // namespace

std::string_view to_string(Quantity quantity) {
    switch (quantity) {
        case Quantity::time:
            return "time";
        case Quantity::memory:
            return "memory";
        case Quantity::build:
            return "build time";
        case Quantity::errors:
            return "errors";
        case Quantity::traffic:
            return "traffic";
        case Quantity::bandwidth:
            return "bandwidth";
        case Quantity::update:
            break;
    }
    return "update";
}

std::string_view unit_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::time:
        case Quantity::build:
        case Quantity::update:
            return "ms";
        case Quantity::memory:
        case Quantity::traffic:
            return "MiB";
        case Quantity::errors:
            return "rays";
        case Quantity::bandwidth:
            break;
    }
    return "GiB/s";
}

const std::vector<Claim>& paper_claims() {
    static const std::vector<Claim> claims = make_claims();
    return claims;
}

const Claim& find_claim(const std::string& id) {
    std::string known;
    for (const Claim& claim : paper_claims()) {
        if (claim.id == id) return claim;
        known += (known.empty() ? "" : ", ") + claim.id;
    }
    throw Error({"--claim", fmt::format("'{}'", id), "one of " + known,
                 "'onepass reproduce --list' explains them."});
}

void summarise(ClaimMeasurement& m, uint64_t seed) {
    if (m.failure.empty()) m.failure = wrongness(m);
    if (!m.failure.empty()) return;
    if (m.again_samples.empty()) {  // counted, not measured
        const double a = m.baseline_samples.at(0), b = m.variant_samples.at(0);
        m.ratio = a == b ? 1.0 : b / a;
        m.ratio_low = m.ratio_high = m.ratio;
    } else {
        const RatioInterval r = ratio_of_medians(m.variant_samples, m.baseline_samples, seed);
        m.ratio = r.ratio, m.ratio_low = r.low, m.ratio_high = r.high;
        m.noise = noise_of(ratio_of_medians(m.again_samples, m.baseline_samples, seed));
    }
    m.verdict = verdict_of(m);
}

ClaimVerdict verdict_of(const ClaimMeasurement& m) {
    if (m.baseline_samples.empty() || m.variant_samples.empty() || std::isnan(m.ratio)) {
        return ClaimVerdict::not_measured;
    }
    const auto [ratio, low, high] = widened({m.ratio, m.ratio_low, m.ratio_high}, m.noise);
    switch (m.expectation) {
        case Expectation::above:
            if (low > m.bound) return ClaimVerdict::holds;
            return high < m.bound || (low == high && low == m.bound) ? ClaimVerdict::fails
                                                                     : ClaimVerdict::depends;
        case Expectation::below:
            if (high < m.bound) return ClaimVerdict::holds;
            return low > m.bound || (low == high && low == m.bound) ? ClaimVerdict::fails
                                                                    : ClaimVerdict::depends;
        case Expectation::possible:
            return ClaimVerdict::holds;
        case Expectation::none:
            break;
    }
    return ClaimVerdict::not_measured;
}

ClaimVerdict verdict_of(const std::vector<ClaimMeasurement>& measurements, Reading reading) {
    std::map<std::string, std::vector<ClaimVerdict>> by_scene;
    std::vector<ClaimVerdict> verdicts;
    for (const ClaimMeasurement& m : measurements) {
        verdicts.push_back(m.verdict);
        by_scene[m.scene].push_back(m.verdict);
    }
    if (reading != Reading::worst) return agreed(verdicts);
    verdicts.clear();
    for (const auto& [scene, of_scene] : by_scene) verdicts.push_back(worst(of_scene));
    return agreed(verdicts);
}

std::string finding_of(const Claim& claim, const std::vector<ClaimMeasurement>& measurements) {
    std::string text = ratios(measurements);
    if (!text.empty()) text = fmt::format("{}: {}", claim.compares, text);
    if (claim.reading == Reading::series) text += crossing(measurements);
    size_t missing = 0, undecided = 0;
    std::string refusal;
    for (const ClaimMeasurement& m : measurements) {
        if (m.expectation == Expectation::possible && m.verdict == ClaimVerdict::fails) {
            refusal += fmt::format("{}{} refuses {}", text.empty() && refusal.empty() ? "" : "; ",
                                   m.variant, m.scene);
        }
        const bool wanted = m.expectation != Expectation::none;
        undecided += m.verdict == ClaimVerdict::depends ? 1 : 0;
        missing += wanted && m.verdict == ClaimVerdict::not_measured ? 1 : 0;
    }
    text += refusal;
    if (undecided > 0) {
        text += fmt::format("; {} of {} within the noise", undecided, measurements.size());
    }
    if (missing > 0) {
        text += fmt::format("{}{} of {} could not be measured", text.empty() ? "" : "; ", missing,
                            measurements.size());
    }
    return text;
}

double fetched_bytes(const std::vector<RayCounters>& counters, double address_bits) {
    constexpr double kCellChannels = 4.0;
    constexpr double kReferenceChannels = 2.0;
    constexpr double kTestTexels = 3.0;
    constexpr double kInstanceTexels = 4.0 + 4.0;  // the instance and its grid
    constexpr double kTexelBytes = 16.0;
    double cells = 0.0, references = 0.0, tests = 0.0;
    for (const RayCounters& c : counters) {
        cells += c.cells;
        references += c.references;
        tests += c.tests;
    }
    return (kCellChannels * cells + kReferenceChannels * references) * address_bits / 8.0 +
           (kTestTexels * tests + kInstanceTexels * (references - tests)) * kTexelBytes;
}

}  // namespace onepass
