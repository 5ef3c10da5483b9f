// Medians, quantiles and the bootstrap, on data whose answer is known.
#include "compare/statistics.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"

namespace onepass {
namespace {

TEST(Median, is_the_middle_or_the_mean_of_the_two_middle_ones) {
    EXPECT_EQ(median(std::vector{3.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(median(std::vector{4.0, 1.0, 3.0, 2.0}), 2.5);
    EXPECT_EQ(median(std::vector{7.0}), 7.0);
    EXPECT_TRUE(std::isnan(median(std::vector<double>{})));
}

TEST(Quantile, interpolates_between_order_statistics) {
    const std::vector samples{10.0, 20.0, 30.0, 40.0, 50.0};
    EXPECT_EQ(quantile(samples, 0.0), 10.0);
    EXPECT_EQ(quantile(samples, 1.0), 50.0);
    EXPECT_EQ(quantile(samples, 0.25), 20.0);
    EXPECT_EQ(quantile(samples, 0.125), 15.0);
}

TEST(RatioOfMedians, has_no_width_when_every_round_has_the_same_ratio) {
    // Rounds differ by a factor of five, but within a round the ratio is always 2: only pairing
    // by round finds the interval [2, 2].
    const std::vector numerator{2.0, 4.0, 10.0, 6.0, 2.0, 8.0, 2.0, 4.0, 6.0};
    std::vector<double> denominator;
    for (const double sample : numerator) denominator.push_back(sample / 2.0);
    const RatioInterval interval = ratio_of_medians(numerator, denominator, 1);
    EXPECT_EQ(interval.ratio, 2.0);
    EXPECT_EQ(interval.low, 2.0);
    EXPECT_EQ(interval.high, 2.0);
}

TEST(RatioOfMedians, covers_the_known_ratio_about_nineteen_times_in_twenty) {
    // Numerator uniform in [3, 5], denominator uniform in [1, 3]: the ratio of medians is 2.
    Random random(7);
    int covered = 0;
    const int trials = 200;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> numerator, denominator;
        for (int i = 0; i < 41; ++i) {
            numerator.push_back(3.0 + 2.0 * random.unit());
            denominator.push_back(1.0 + 2.0 * random.unit());
        }
        const RatioInterval interval =
            ratio_of_medians(numerator, denominator, static_cast<uint64_t>(trial));
        EXPECT_LE(interval.low, interval.ratio);
        EXPECT_GE(interval.high, interval.ratio);
        covered += interval.low <= 2.0 && 2.0 <= interval.high;
    }
    // Binomial(200, 0.95) has standard deviation 3.1: four of them below the mean, and below 200,
    // since an interval that always covers is too wide. The bootstrap of a median is a little wide.
    EXPECT_GE(covered, 178);
    EXPECT_LT(covered, 200);
}

TEST(RatioOfMedians, is_the_same_for_the_same_seed) {
    const std::vector numerator{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0};
    const std::vector denominator{9.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0, 4.0, 5.0};
    const RatioInterval a = ratio_of_medians(numerator, denominator, 3);
    const RatioInterval b = ratio_of_medians(numerator, denominator, 3);
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
    EXPECT_LT(a.low, a.high);
}

TEST(RatioOfMedians, of_nothing_is_not_a_number) {
    EXPECT_TRUE(std::isnan(ratio_of_medians({}, {}, 1).ratio));
}

TEST(FitPower, finds_the_law_of_points_that_follow_one) {
    std::vector<double> x, y;
    for (const double value : {10.0, 100.0, 1000.0, 10000.0}) {
        x.push_back(value);
        y.push_back(3.0 * std::pow(value, 0.75));
    }
    const PowerLaw law = fit_power(x, y);
    constexpr double kRounding = 1e-12;  // a few logarithms and sums in double
    EXPECT_NEAR(law.exponent, 0.75, kRounding);
    EXPECT_NEAR(law.factor, 3.0, 10 * kRounding);
    EXPECT_NEAR(law.standard_error, 0.0, 1e-7) << "the root of a sum of rounding errors";
}

TEST(FitPower, has_the_standard_error_of_a_regression) {
    // Logarithms (0, 1, 2) -> (0, 2, 1): slope 1/2, residuals -1/2, 1, -1/2; sqrt(1.5 / 1 / 2).
    const double e = std::exp(1.0);
    const std::vector<double> x = {1.0, e, e * e}, y = {1.0, e * e, e};
    EXPECT_NEAR(fit_power(x, y).exponent, 0.5, 1e-12);
    EXPECT_NEAR(fit_power(x, y).standard_error, std::sqrt(0.75), 1e-12);
}

TEST(FitPower, claims_nothing_that_the_points_do_not_tell) {
    const std::vector<double> two = {1.0, 10.0}, same = {5.0, 5.0};
    EXPECT_NEAR(fit_power(two, two).exponent, 1.0, 1e-12);
    EXPECT_TRUE(std::isnan(fit_power(two, two).standard_error)) << "a line through two points";
    EXPECT_TRUE(std::isnan(fit_power(same, two).exponent));
    EXPECT_TRUE(std::isnan(fit_power({}, {}).exponent));
    const std::vector<double> x = {1.0, 10.0, 100.0}, y = {1.0, 10.0, 0.0};
    EXPECT_NEAR(fit_power(x, y).exponent, 1.0, 1e-12) << "what has no logarithm is left out";
}

}  // namespace
}  // namespace onepass
