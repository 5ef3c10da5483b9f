// The paper's claims as data: each with the experiments that it rests on, and the rule by which its
// verdict follows. experiments.h runs them; the page prints what they left.
//
// A claim's switch is a parameter of a strategy, another strategy, or another form of the scene:
// nothing here knows more of a tracer than its name and its parameters' names.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/params.h"

namespace onepass {

/// How a scene is handed to a tracer.
enum class SceneForm {
    as_is,
    flattened,  ///< one object in one instance
    unshared,   ///< an object of its own for every instance
};

/// One side of a comparison.
struct Setting {
    std::string tracer;  ///< strategy/storage/entry; an entry "*" is the one under test
    ParamValues params{};
    SceneForm form = SceneForm::as_is;
    double size = 0.0;  ///< ClaimMeasurement::size
};

/// What is compared between two sides. All are "less is better".
enum class Quantity {
    time,       ///< of casting the rays or rendering the image, ms
    memory,     ///< of the structure on the device, MiB
    build,      ///< building and packing the structure, ms
    errors,     ///< CheckRecord::errors() on the rays
    traffic,    ///< bytes a frame moves between passes, and the image itself, MiB
    bandwidth,  ///< baseline: of a plain copy; variant: what its fetches ask for; GiB/s
    update,     ///< of an animation: update and upload of the variant against the tracing of a
                ///< frame by the baseline, ms a frame
};
std::string_view to_string(Quantity quantity);
std::string_view unit_of(Quantity quantity);

/// A quantity and what the claim says of its ratio variant / baseline.
struct Probe {
    Quantity quantity = Quantity::time;
    Expectation expectation = Expectation::above;
    double bound = 1.0;
};

/// One baseline against one or more variants on one scene, all in the same rounds.
struct Experiment {
    std::string scene;
    std::string work = "primary";  ///< a ray kind, "image" or "animation"
    uint32_t side = 256;           ///< pixels a side of the square image
    Setting baseline{};
    std::vector<Setting> variants{};
    std::vector<Probe> probes{};
    bool fixed_side = false;  ///< the same number of rays on every device
};

/// How a claim's verdict follows from those of its measurements.
enum class Reading {
    each,   ///< all of one mind: that verdict; else `depends`
    worst,  ///< of a sweep: a scene's verdict is the worst of its measurements; then as `each`
    series  ///< as `each`, and `now` says up to and from how many triangles it is below and above 1
};

struct Claim {
    std::string id;
    std::string claim;
    std::string source;
    std::string then;
    std::string compares;  ///< what is held against what: "streaming against one pass"
    std::string rule;      ///< beyond the common one, kVerdictRule
    Reading reading = Reading::each;
    std::vector<Experiment> experiments;
};

/// "little", "comes close": at most a tenth.
inline constexpr double kLittle = 1.1;

/// "comparable": at most twice.
inline constexpr double kComparable = 2.0;

/// A tracer that errs on more than this share of the rays is no tracer, and has no speed: on all
/// scenes the paper's errs on far less, with its slack of 0.4 % on one of three edges.
inline constexpr double kMostErrors = 0.05;

/// How every measurement is read, for the page.
inline constexpr char kVerdictRule[] =
    "A measurement counts for or against a claim only if its 95 % interval, widened on both sides "
    "by the noise, lies wholly on one side of the bound; else it decides nothing. The noise is how "
    "far the 95 % interval of the baseline against a second run of itself, in the same rounds, "
    "reaches from 1. What is counted (bytes, errors) has neither. No time, traffic or bandwidth "
    "counts of a side that errs on more than 5 % of the rays. A claim holds, or fails, if all its "
    "measurements that could be made say so; in every other case it depends.";

/// All claims, in the order of the page.
const std::vector<Claim>& paper_claims();

/// Throws: Error listing the ids for one that is none.
const Claim& find_claim(const std::string& id);

/// Fills a measurement's figures (ratio, interval, noise, verdict) from its samples; the failure of
/// one whose sides err too much to have a speed.
void summarise(ClaimMeasurement& measurement, uint64_t seed);

/// Reads one measurement by kVerdictRule. `not_measured` without samples on both sides.
ClaimVerdict verdict_of(const ClaimMeasurement& measurement);

/// Puts the measurements' verdicts together.
ClaimVerdict verdict_of(const std::vector<ClaimMeasurement>& measurements, Reading reading);

/// What was found, in a sentence: ratios by quantity, and what could not be made.
std::string finding_of(const Claim& claim, const std::vector<ClaimMeasurement>& measurements);

/// What a cast fetches from the structure's textures, bytes.
///
/// Texels as gpu_glsl/README.md describes them: a cell has four channels and a reference two, of
/// `address_bits` each; a triangle test reads three texels of 16 bytes; an instance is four such
/// texels and so is the record of its grid. References that lead to no test lead to an instance.
double fetched_bytes(const std::vector<RayCounters>& counters, double address_bits);

}  // namespace onepass
