#include "compare/cli/bench_self_test.h"

#include <array>

#include <fmt/format.h>

#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/statistics.h"
#include "compare/timing_trial.h"

namespace onepass::cli {
namespace {

std::vector<std::string> row(const std::string& name, const std::array<uint32_t, 4>& counts,
                             const std::vector<double>& ratios) {
    const auto count = [&](SpeedVerdict verdict) {
        return std::to_string(counts[static_cast<size_t>(verdict)]);
    };
    return {name,
            count(SpeedVerdict::faster),
            count(SpeedVerdict::slower),
            count(SpeedVerdict::no_difference),
            fmt::format("{:.3f}", median(ratios)),
            fmt::format("{:.3f}..{:.3f}", quantile(ratios, 0.05), quantile(ratios, 0.95))};
}

std::string trial_text(const TimingTrial& trial, const TimingOptions& timing) {
    return format_table(
               {{"verdict on", "faster", "slower", "no difference", "speed", "nine in ten"},
                row("an equal", trial.of_equals, trial.equals_ratio),
                row("slowed by a twentieth", trial.of_slowed, trial.slowed_ratio)}) +
           fmt::format(
               "  noise: median {:.1f} %, nine in ten below {:.1f} %; {} rounds each; {} "
               "errors\n  {}: {} of {} equals called different (at most {:.0f} %), {} "
               "slowed found (at least {:.0f} %)\n",
               100.0 * median(trial.noise), 100.0 * quantile(trial.noise, 0.9), timing.repetitions,
               trial.errors, passed(trial) ? "passed" : "FAILED", trial.called_different(),
               trial.comparisons, 100.0 * kMostCalledDifferent, trial.found_slower(),
               100.0 * kLeastFoundSlower);
}

}  // namespace

void bench_self_test(Session& session, const BenchSelfTestCommand& options) {
    const ImageSize size = parse_size(options.rays.size);
    const RayRequest request{size.width, size.height, options.rays.camera, session.globals.seed};
    const SelectedStrategy strategy =
        select_strategies(session.catalogue, options.strategy).front();
    TimingTrialOptions trial_options{options.comparisons, options.timing};
    trial_options.timing.seed = session.globals.seed;
    check_repetitions(trial_options.timing);

    for (const std::string& name : options.scenes) {
        Court court = open_court(session, name);
        for (const std::string& kind : options.rays.kinds) {
            const Case subject = open_case(court, kind, request);
            const auto tracer = strategy.entry->make(court.open.scene, strategy.params);
            const uint64_t errors =
                check_tracer(court, subject, *tracer, {.seed = session.globals.seed})
                    .record.errors();
            TimingTrial trial;
            {
                ProgressBar bar("bench --self-test");
                trial = try_timing(*strategy.entry, court.open.scene, strategy.params, subject.rays,
                                   trial_options, bar.part(0.0, 1.0));
            }
            trial.errors = errors;
            fmt::print("{}, {} rays, {}: {} rays, {} comparisons\n", name, kind,
                       strategy.entry->info.name, subject.rays.rays.size(), trial.comparisons);
            if (trial.comparisons > 0) fmt::print("{}", trial_text(trial, trial_options.timing));
            if (stop_requested()) {
                session.exit_code = kStopped;
                return;
            }
            if (!passed(trial)) session.exit_code = kFailed;
        }
    }
}

}  // namespace onepass::cli
