#include "compare/cost_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace onepass {
namespace {

constexpr size_t kTerms = 3;
using Vector = std::array<double, kTerms>;
using Matrix = std::array<Vector, kTerms>;

/// Solves M x = y in the terms of `active`, the others 0, by Gauss with pivots. Nothing if M is
/// singular there.
std::optional<Vector> solve(const Matrix& m, const Vector& y, unsigned active) {
    std::array<size_t, kTerms> terms{};
    size_t count = 0;
    for (size_t i = 0; i < kTerms; ++i) {
        if (active >> i & 1u) terms[count++] = i;
    }
    std::array<std::array<double, kTerms + 1>, kTerms> rows{};
    for (size_t r = 0; r < count; ++r) {
        for (size_t c = 0; c < count; ++c) rows[r][c] = m[terms[r]][terms[c]];
        rows[r][count] = y[terms[r]];
    }
    for (size_t k = 0; k < count; ++k) {
        size_t pivot = k;
        for (size_t r = k + 1; r < count; ++r) {
            if (std::abs(rows[r][k]) > std::abs(rows[pivot][k])) pivot = r;
        }
        std::swap(rows[k], rows[pivot]);
        // Columns that rounding alone tells apart say nothing.
        constexpr double kSingular = 1e-12;
        if (std::abs(rows[k][k]) <= kSingular * m[terms[k]][terms[k]]) return std::nullopt;
        for (size_t r = 0; r < count; ++r) {
            if (r == k) continue;
            const double factor = rows[r][k] / rows[k][k];
            for (size_t c = k; c <= count; ++c) rows[r][c] -= factor * rows[k][c];
        }
    }
    Vector x{};
    for (size_t k = 0; k < count; ++k) x[terms[k]] = rows[k][count] / rows[k][k];
    return x;
}

/// A sample's terms over its time: the model says that costs times these are 1.
Vector row_of(const WorkSample& sample, double scale) {
    const double share = scale / sample.ns;
    return {share, share * sample.cells, share * sample.tests};
}

double predicted(const Vector& costs, const Vector& row) {
    return costs[0] * row[0] + costs[1] * row[1] + costs[2] * row[2];
}

/// The costs that are not negative and leave the least squares.
Vector best_costs(std::span<const WorkSample> samples, std::span<const double> scales) {
    Matrix m{};
    Vector y{};
    for (const WorkSample& sample : samples) {
        const Vector row = row_of(sample, scales[sample.scene]);
        for (size_t i = 0; i < kTerms; ++i) {
            y[i] += row[i];
            for (size_t j = 0; j < kTerms; ++j) m[i][j] += row[i] * row[j];
        }
    }
    Vector best{};
    double least = std::numeric_limits<double>::infinity();
    for (unsigned active = 1; active < 1u << kTerms; ++active) {
        const std::optional<Vector> x = solve(m, y, active);
        if (!x || (*x)[0] < 0.0 || (*x)[1] < 0.0 || (*x)[2] < 0.0) continue;
        double squares = 0.0;
        for (const WorkSample& sample : samples) {
            const double error = predicted(*x, row_of(sample, scales[sample.scene])) - 1.0;
            squares += error * error;
        }
        if (squares < least) {
            least = squares;
            best = *x;
        }
    }
    return best;
}

/// Each scene's best scale for these costs, then all turned so that their geometric mean is 1.
void fit_scales(std::span<const WorkSample> samples, const Vector& costs,
                std::vector<double>& scales) {
    std::vector<double> sum(scales.size(), 0.0), squares(scales.size(), 0.0);
    for (const WorkSample& sample : samples) {
        const double p = predicted(costs, row_of(sample, 1.0));
        sum[sample.scene] += p;
        squares[sample.scene] += p * p;
    }
    double logs = 0.0;
    size_t used = 0;
    for (size_t s = 0; s < scales.size(); ++s) {
        if (squares[s] <= 0.0) continue;
        scales[s] = sum[s] / squares[s];
        logs += std::log(scales[s]);
        ++used;
    }
    const double mean = used > 0 ? std::exp(logs / static_cast<double>(used)) : 1.0;
    for (double& scale : scales) scale /= mean;
}

/// The costs of a strategy, whatever its storage and entry.
struct KnownCosts {
    std::string_view strategy;
    CostModel costs;
};

// What `onepass tune --fit results/tune/fitted-on.json` prints; the manifest of that file holds the
// `onepass tune` that made it: knot2, camel, cheese, fandisk_large, couplingdown, knife, sr71a and
// balls-1, primary rays, llvmpipe on two cores. Only the ratios of the costs decide; other
// machines have others, and `--costs RESULT.json` takes them from a tune run made there.
constexpr KnownCosts kKnownCosts[] = {
    {"grid", {.ray = 39.73, .cell = 20.322, .test = 2.096, .relative_error = 0.066}},
    {"paper", {.ray = 41.04, .cell = 13.879, .test = 5.818, .relative_error = 0.072}},
};

}  // namespace

std::optional<CostModel> fit_costs(std::span<const WorkSample> samples) {
    if (samples.size() < kTerms) return std::nullopt;
    size_t scenes = 0;
    for (const WorkSample& sample : samples) scenes = std::max(scenes, sample.scene + 1);

    // Costs and scales by turns: each turn lessens the squares.
    constexpr int kTurns = 100;
    std::vector<double> scales(scenes, 1.0);
    Vector costs = best_costs(samples, scales);
    if (scenes > 1) {
        for (int turn = 0; turn < kTurns; ++turn) {
            fit_scales(samples, costs, scales);
            costs = best_costs(samples, scales);
        }
    }

    double squares = 0.0;
    for (const WorkSample& sample : samples) {
        const double error = predicted(costs, row_of(sample, scales[sample.scene])) - 1.0;
        squares += error * error;
    }
    return CostModel{costs[0], costs[1], costs[2],
                     std::sqrt(squares / static_cast<double>(samples.size()))};
}

const CostModel* known_costs_of(const std::string& tracer) {
    const std::string_view strategy = std::string_view(tracer).substr(0, tracer.find('/'));
    for (const KnownCosts& known : kKnownCosts) {
        if (known.strategy == strategy) return &known.costs;
    }
    return nullptr;
}

}  // namespace onepass
