// The rule that tells fast from slow: by hand-made intervals, and by a hundred comparisons under
// noise as a busy machine has it.
#include "compare/verdict.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random.h"

namespace onepass {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SpeedVerdict, needs_an_interval_that_leaves_1_out_by_more_than_the_noise) {
    EXPECT_EQ(speed_verdict({1.10, 1.05, 1.15}, 0.0), SpeedVerdict::faster);
    EXPECT_EQ(speed_verdict({1.10, 1.05, 1.15}, 0.04), SpeedVerdict::faster);
    EXPECT_EQ(speed_verdict({1.10, 1.05, 1.15}, 0.06), SpeedVerdict::no_difference);
    EXPECT_EQ(speed_verdict({0.90, 0.85, 0.95}, 0.04), SpeedVerdict::slower);
    EXPECT_EQ(speed_verdict({0.90, 0.85, 0.95}, 0.06), SpeedVerdict::no_difference);
    EXPECT_EQ(speed_verdict({1.00, 0.99, 1.01}, 0.0), SpeedVerdict::no_difference);
    EXPECT_EQ(speed_verdict({1.10, 1.05, 1.15}, kNan), SpeedVerdict::faster)
        << "no rival, no noise";
    EXPECT_EQ(speed_verdict({kNan, kNan, kNan}, 0.0), SpeedVerdict::unknown);
}

TEST(NoiseOf, is_how_far_equals_reach_from_1_on_either_side) {
    EXPECT_DOUBLE_EQ(noise_of({1.0, 0.875, 1.0625}), 0.125);
    EXPECT_DOUBLE_EQ(noise_of({1.0, 0.9375, 1.25}), 0.25);
    EXPECT_TRUE(std::isnan(noise_of({kNan, kNan, kNan})));
}

TimingRecord timed(std::vector<double> wall_ms, std::vector<double> device_ms = {}) {
    TimingRecord record;
    record.wall_ms = std::move(wall_ms);
    record.device_ms = std::move(device_ms);
    return record;
}

TEST(CompareSpeeds, takes_the_devices_timer_only_if_both_have_one) {
    const TimingRecord quick = timed({2.0, 2.0}, {1.0, 1.0});
    const TimingRecord slow = timed({4.0, 4.0}, {3.0, 3.0});
    const TimingRecord untimed = timed({8.0, 8.0});
    EXPECT_EQ(compare_speeds(quick, slow, 0.0, 0).speed.ratio, 3.0);
    EXPECT_TRUE(compare_speeds(quick, slow, 0.0, 0).by_device);
    EXPECT_EQ(compare_speeds(quick, untimed, 0.0, 0).speed.ratio, 4.0);
    EXPECT_FALSE(compare_speeds(quick, untimed, 0.0, 0).by_device);
    EXPECT_EQ(compare_speeds(quick, untimed, 0.0, 0).verdict, SpeedVerdict::faster);
}

TEST(CompareSpeeds, pairs_the_rounds_that_both_took_part_in) {
    const TimingRecord left_early = timed({1.0, 10.0});
    const TimingRecord stayed = timed({2.0, 20.0, 7.0, 7.0, 7.0});
    EXPECT_EQ(compare_speeds(left_early, stayed, 0.0, 0).speed.ratio, 2.0);
    EXPECT_EQ(compare_speeds(timed({}), stayed, 0.0, 0).verdict, SpeedVerdict::unknown);
}

TEST(NoiseOfCase, is_that_of_the_record_with_a_rival) {
    TimingRecord with_rival = timed({1.0, 1.0}, {1.0, 1.0});
    with_rival.again_wall_ms = {1.25, 1.25};
    with_rival.again_device_ms = {1.125, 1.125};
    const TimingRecord other = timed({1.0, 1.0});
    const TimingRecord* const all[] = {&other, &with_rival};
    EXPECT_EQ(noise_of_case(all, false, 0), 0.25);
    EXPECT_EQ(noise_of_case(all, true, 0), 0.125);
    EXPECT_EQ(baseline_of(all), &with_rival);
    EXPECT_TRUE(std::isnan(noise_of_case(std::span(all).first(1), false, 0)));
    EXPECT_EQ(baseline_of(std::span(all).first(1)), nullptr);
}

// ---- A hundred comparisons.

/// A busy machine: whole stretches of time are slower, the pace drifts, each cast scatters, and
/// some take far longer. All of it runs on from cast to cast; the order in a round is random.
class BusyMachine {
  public:
    explicit BusyMachine(uint64_t seed) : random_(seed) {}

    /// Samples of contestants that take `factors` times as long as each other.
    std::vector<std::vector<double>> rounds(size_t count, const std::vector<double>& factors) {
        std::vector<std::vector<double>> samples(factors.size(), std::vector<double>(count));
        std::vector<size_t> order(factors.size());
        for (size_t i = 0; i < order.size(); ++i) order[i] = i;
        for (size_t round = 0; round < count; ++round) {
            random_.shuffle(std::span(order));
            drift_ += kDrift * normal();
            for (const size_t i : order) samples[i][round] = factors[i] * cast_ms();
        }
        return samples;
    }

  private:
    static constexpr double kDrift = 0.003;          ///< of the pace's logarithm, a round
    static constexpr double kScatter = 0.02;         ///< of each cast
    static constexpr double kTurns = 0.02;           ///< a neighbour comes or goes before a cast
    static constexpr double kBesideNeighbour = 1.8;  ///< ... and slows all meanwhile
    static constexpr double kInterrupted = 0.03;     ///< of the casts ...
    static constexpr double kInterruption = 0.5;     ///< ... by this share more, in the mean

    double unit() { return (static_cast<double>(random_.below(1u << 24)) + 0.5) / (1u << 24); }
    double normal() {
        return std::sqrt(-2.0 * std::log(unit())) * std::cos(2.0 * std::numbers::pi * unit());
    }
    double cast_ms() {
        if (unit() < kTurns) beside_neighbour_ = !beside_neighbour_;
        double ms = std::exp(drift_ + kScatter * normal());
        if (beside_neighbour_) ms *= kBesideNeighbour;
        if (unit() < kInterrupted) ms *= 1.0 - kInterruption * std::log(unit());
        return ms;
    }

    Random random_;
    double drift_ = 0.0;
    bool beside_neighbour_ = false;
};

constexpr int kComparisons = 100;
constexpr size_t kRounds = 51;

struct Tally {
    int different = 0;  ///< of equals
    int slower = 0;     ///< of the slowed
};

Tally compare_often(double slowed_by) {
    BusyMachine machine(1);
    Tally tally;
    for (int i = 0; i < kComparisons; ++i) {
        auto samples = machine.rounds(kRounds, {1.0, 1.0, 1.0, slowed_by});
        TimingRecord strategy = timed(samples[0]);
        strategy.again_wall_ms = samples[1];
        const TimingRecord* const with_rival[] = {&strategy};
        const double noise = noise_of_case(with_rival, false, 1);
        const auto verdict = [&](const std::vector<double>& of) {
            return compare_speeds(timed(of), strategy, noise, 1).verdict;
        };
        tally.different += verdict(samples[2]) != SpeedVerdict::no_difference ? 1 : 0;
        tally.slower += verdict(samples[3]) == SpeedVerdict::slower ? 1 : 0;
    }
    return tally;
}

TEST(SpeedVerdict, calls_equals_different_in_at_most_10_of_100_comparisons) {
    EXPECT_LE(compare_often(1.05).different, 10);
}

TEST(SpeedVerdict, finds_a_strategy_that_is_slower_by_5_percent) {
    EXPECT_GE(compare_often(1.05).slower, 90);
}

TEST(SpeedVerdict, is_not_fooled_by_the_interval_alone_where_places_are_unequal) {
    // Two that differ by 2 % for a reason that every pair of equals has as well: the interval alone
    // would tell them apart, the noise of the rival does not let it.
    BusyMachine machine(2);
    int by_interval = 0, by_rule = 0;
    for (int i = 0; i < 20; ++i) {
        const auto samples = machine.rounds(201, {1.0, 1.02, 1.02});
        TimingRecord strategy = timed(samples[0]);
        strategy.again_wall_ms = samples[1];
        const TimingRecord* const with_rival[] = {&strategy};
        const double noise = noise_of_case(with_rival, false, 1);
        const auto different = [&](double by) {
            return compare_speeds(timed(samples[2]), strategy, by, 1).verdict !=
                   SpeedVerdict::no_difference;
        };
        by_interval += different(0.0) ? 1 : 0;
        by_rule += different(noise) ? 1 : 0;
    }
    EXPECT_GE(by_interval, 15);
    EXPECT_LE(by_rule, 2);
}

}  // namespace
}  // namespace onepass
