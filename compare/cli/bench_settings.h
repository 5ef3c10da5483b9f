// onepass bench --settings: the data of the speed-accuracy chart.
#pragma once

#include <string>
#include <vector>

#include "compare/cli/options.h"
#include "compare/cli/session.h"
#include "compare/cli/study_run.h"
#include "compare/timing.h"

namespace onepass::cli {

/// Unless the user states others. Kinds on which methods err (corners), and kinds that they are
/// made for; few rays, because each is judged.
inline const std::vector<std::string> kSettingsKinds = {"primary", "vertex", "random"};
inline constexpr char kSettingsSize[] = "128x128";

struct BenchSettingsCommand {
    std::vector<std::string> scenes;
    RayOptions rays;
    TimingOptions timing;
    std::string entry;  ///< for "*" in compare/tradeoff.h's list
    StudyOptions study;
};

/// Times and judges compare/tradeoff.h's list on every scene and ray kind. A setting that a scene
/// is too large for is left out, with a line on stderr.
void bench_settings(Session& session, const BenchSettingsCommand& options);

}  // namespace onepass::cli
