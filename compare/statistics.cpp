#include "compare/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
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
    std::vector<double> values(samples.begin(), samples.end());
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = values.begin() + static_cast<ptrdiff_t>(place);
    const double weight = place - std::floor(place);
    std::nth_element(values.begin(), below, values.end());
    const auto above = std::min_element(below + 1, values.end());  // all there are not below it
    return *below * (1.0 - weight) + (above == values.end() ? *below : *above) * weight;
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

RatioInterval median_of_ratios(std::span<const double> numerator,
                               std::span<const double> denominator, uint64_t seed) {
    ONEPASS_CHECK_EQ(numerator.size(), denominator.size());
    const size_t rounds = numerator.size();
    if (rounds == 0) return {kNoValue, kNoValue, kNoValue};

    std::vector<double> of_rounds(rounds), drawn(rounds), medians(kBootstrapResamples);
    for (size_t i = 0; i < rounds; ++i) of_rounds[i] = numerator[i] / denominator[i];
    Random random(seed);
    for (double& middle : medians) {
        for (double& ratio : drawn) ratio = of_rounds[random.below(rounds)];
        middle = median(drawn);
    }
    return {median(of_rounds), quantile(medians, 0.025), quantile(medians, 0.975)};
}

PowerLaw fit_power(std::span<const double> x, std::span<const double> y) {
    ONEPASS_CHECK_EQ(x.size(), y.size());
    std::vector<double> log_x, log_y;
    for (size_t i = 0; i < x.size(); ++i) {
        if (!(x[i] > 0.0 && y[i] > 0.0)) continue;
        log_x.push_back(std::log(x[i]));
        log_y.push_back(std::log(y[i]));
    }
    const double n = static_cast<double>(log_x.size());
    const double mean_x = std::accumulate(log_x.begin(), log_x.end(), 0.0) / n;
    const double mean_y = std::accumulate(log_y.begin(), log_y.end(), 0.0) / n;
    double xx = 0.0, xy = 0.0;
    for (size_t i = 0; i < log_x.size(); ++i) {
        xx += (log_x[i] - mean_x) * (log_x[i] - mean_x);
        xy += (log_x[i] - mean_x) * (log_y[i] - mean_y);
    }
    if (!(xx > 0.0)) return {kNoValue, kNoValue, kNoValue};

    PowerLaw law;
    law.exponent = xy / xx;
    law.factor = std::exp(mean_y - law.exponent * mean_x);
    double scatter = 0.0;
    for (size_t i = 0; i < log_x.size(); ++i) {
        const double off = log_y[i] - mean_y - law.exponent * (log_x[i] - mean_x);
        scatter += off * off;
    }
    law.standard_error = n > 2.0 ? std::sqrt(scatter / (n - 2.0) / xx) : kNoValue;
    return law;
}

}  // namespace onepass
