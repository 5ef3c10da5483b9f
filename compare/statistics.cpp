#include "compare/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double median(std::span<const double> samples) { return quantile(samples, 0.5); }

double quantile(std::span<const double> samples, double share) {
    if (samples.empty()) return kNoValue;
    std::vector<double> sorted(samples.begin(), samples.end());
    std::sort(sorted.begin(), sorted.end());
    const double place = share * static_cast<double>(sorted.size() - 1);
    const size_t below = static_cast<size_t>(place);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    const double weight = place - static_cast<double>(below);
    return sorted[below] * (1.0 - weight) + sorted[above] * weight;
}

RatioInterval ratio_of_medians(std::span<const double> numerator,
                               std::span<const double> denominator, uint64_t seed) {
    ONEPASS_CHECK_EQ(numerator.size(), denominator.size());
    const size_t rounds = numerator.size();
    if (rounds == 0) return {kNoValue, kNoValue, kNoValue};

    Random random(seed);
    std::vector<double> ratios(kBootstrapResamples);
    std::vector<double> drawn_numerator(rounds), drawn_denominator(rounds);
    for (double& ratio : ratios) {
        for (size_t i = 0; i < rounds; ++i) {
            const size_t round = random.below(rounds);
            drawn_numerator[i] = numerator[round];
            drawn_denominator[i] = denominator[round];
        }
        ratio = median(drawn_numerator) / median(drawn_denominator);
    }
    return {median(numerator) / median(denominator), quantile(ratios, 0.025),
            quantile(ratios, 0.975)};
}

}  // namespace onepass
