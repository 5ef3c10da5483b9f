// Medians and how far to trust their ratios.
#pragma once

#include <cstdint>
#include <span>

namespace onepass {

/// The middle value; the mean of the two middle ones for an even count. NaN for no samples.
double median(std::span<const double> samples);

/// Linear interpolation between order statistics; `share` in [0, 1]. NaN for no samples.
double quantile(std::span<const double> samples, double share);

/// A ratio with its 95 % interval.
struct RatioInterval {
    double ratio = 0.0;
    double low = 0.0;
    double high = 0.0;
};

/// Resamples of the bootstrap: the 2.5 % and 97.5 % quantiles then rest on 50 resamples each.
inline constexpr int kBootstrapResamples = 2000;

/// median(numerator) / median(denominator) and its percentile bootstrap interval.
///
/// Paired: sample i of both lists comes from the same round, and rounds are drawn with replacement,
/// so that what slowed a whole round down does not widen the interval. All NaN for no samples.
/// The lists have equal lengths. The same seed gives the same interval.
RatioInterval ratio_of_medians(std::span<const double> numerator,
                               std::span<const double> denominator, uint64_t seed);

/// The median of numerator[i] / denominator[i], and its percentile bootstrap interval.
///
/// Paired by round, and more so than ratio_of_medians: what slows a whole round down leaves its
/// ratio alone, however heavy the noise's tails and however slow its drift. For samples that take
/// turns in random order the interval needs no model of the noise: of two that are alike each is
/// as likely to be the slower one in a round, whatever else goes on, and the interval of a median
/// ends on order statistics, as that of the sign test. Else as ratio_of_medians.
RatioInterval median_of_ratios(std::span<const double> numerator,
                               std::span<const double> denominator, uint64_t seed);

/// y = factor * x^exponent.
struct PowerLaw {
    double exponent = 0.0;
    double standard_error = 0.0;  ///< of the exponent, from the scatter about the line
    double factor = 0.0;
};

/// Least squares on logarithms. The error is NaN for fewer than three points, and all is NaN for
/// fewer than two different x. Points that are not positive in both are left out.
PowerLaw fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace onepass
