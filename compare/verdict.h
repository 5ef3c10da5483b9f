// Faster, slower, or no difference: when two strategies' samples of one run tell them apart.
//
// Shared by all that calls one speed better than another: `onepass bench`, its page, the paper's
// claims and `onepass compare`. Everything here is a function of samples that a result file holds,
// so that any reader can derive it again.
//
// The rule. Two strategies take turns in random order, so both are timed in every round. Of the
// rounds' ratios the median is taken, with its 95 % percentile bootstrap interval over rounds
// (median_of_ratios): that is what chance can do, at 5 % of all comparisons of equals. What it
// cannot tell is whether equals look equal on this machine at all: memory that lies elsewhere, or a
// neighbour that disturbs one place in the round. Therefore one strategy meets, in every
// round, a rival identical to it (A/A; timing.h). The noise is how far the interval of that pair
// reaches from 1. Faster or slower is said only if the interval, widened on both sides by the
// noise, leaves 1 out. The price is that a difference has to be about twice the interval's half
// width to be found: more rounds narrow both.
//
// The error rate aimed at is that of the interval, 5 %, and the widening keeps the true one below
// it. compare/timing_trial.h puts both halves, equals and a strategy slowed on purpose, to the
// test.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "compare/results.h"
#include "compare/statistics.h"

namespace onepass {

/// Of a tracer against another. `unknown`: there are no samples of both.
enum class SpeedVerdict { faster, slower, no_difference, unknown };
std::string_view to_string(SpeedVerdict verdict);

/// How far the interval of two equals reaches from 1, a share. NaN for an interval that is.
double noise_of(const RatioInterval& of_equals);

/// The interval made longer by the noise on both sides; as it is where the noise is not known
/// (NaN).
RatioInterval widened(const RatioInterval& interval, double noise);

/// By the rule above, for a ratio of speeds. One whole way from 1 is faster, or slower.
SpeedVerdict speed_verdict(const RatioInterval& speed, double noise);

/// One tracer's speed relative to another's in the same rounds.
struct SpeedComparison {
    RatioInterval speed;  ///< above 1: the first is faster; median_of_ratios
    double noise = 0.0;   ///< that it was held against; NaN: the run has no rival
    SpeedVerdict verdict = SpeedVerdict::unknown;
    bool by_device = false;  ///< both by their device's own timer; else by wall time
};

/// `first` against `second`, records of one case: by the device's timer if both have one, over the
/// rounds that both took part in.
SpeedComparison compare_speeds(const TimingRecord& first, const TimingRecord& second, double noise,
                               uint64_t seed);

/// ... against the oracle of its record, by wall time.
SpeedComparison compare_with_oracle(const TimingRecord& record, double noise, uint64_t seed);

/// The noise of a case (one scene, one set of rays): of its records' rivals the largest. By the
/// device's timer (`by_device`) where the rival has one. NaN without a rival.
double noise_of_case(std::span<const TimingRecord* const> records, bool by_device, uint64_t seed);

/// The record that had a rival: what the other tracers are held against in pairs. Null: none had.
const TimingRecord* baseline_of(std::span<const TimingRecord* const> records);

}  // namespace onepass
