// The data of one run: everything a page, a table or a later comparison is made from.
//
// Data first, pages second: `onepass check|bench|tune` fill a Results value and write it as one
// JSON file; `onepass report` reads such files and nothing else. No page needs a GPU.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/catalogue.h"
#include "core/judge.h"
#include "core/params.h"
#include "core/tracer.h"

namespace onepass {

/// Where, with what and how the figures came about.
struct Manifest {
    std::vector<std::string> arguments;  ///< the command line that remakes the run
    std::string time_utc;                ///< ISO 8601
    std::string commit;                  ///< git commit of the build; "unknown" outside git
    bool dirty = false;                  ///< the build held uncommitted changes
    std::string program_hash;            ///< of the executable: one commit can have many builds
    std::string build_type;
    std::string compiler;
    std::string cpu;
    uint32_t cores = 0;      ///< usable by this process
    std::string gl_context;  ///< "osmesa", "egl"; empty if no GL tracer ran
    std::string gl_renderer;
    std::string gl_version;  ///< version and driver
    bool software_renderer = false;
    std::string embree;    ///< version and build
    std::string judge;     ///< Judge::name()
    uint64_t seed = 0;     ///< of generated rays and of the run order
    bool complete = true;  ///< false: stopped by Ctrl-C; what is there is whole
};

struct SceneRecord {
    std::string name;
    uint64_t triangles = 0;         ///< counted once an instance
    uint64_t unique_triangles = 0;  ///< counted once an object
    uint64_t instances = 0;
    uint64_t lights = 0;
    std::string hash;                ///< of the scene's content, hex
    std::vector<std::string> notes;  ///< LoadedScene::notes
};

struct TracerRecord {
    std::string scene;
    std::string name;    ///< strategy/storage/entry
    ParamValues params;  ///< all of them, defaults included
    std::string sizing;  ///< "auto" or the sizing file that chose the grids' sizes; else empty
    std::string device;
    bool software_renderer = false;
    bool is_oracle = false;
    bool is_twin = false;
    uint32_t threads = 0;
    std::string shader_hash;  ///< of the composed text; empty for CPU tracers
    std::vector<Stat> stats;
    std::vector<Deviation> deviations;  ///< TracerInfo::deviations: a page has no catalogue
};

/// The worst ray of one class in one comparison.
struct WorstRay {
    uint64_t index = 0;  ///< in the ray set
    Ray ray;
    Hit answer;
    Hit oracle;
    Verdict verdict;
};

struct ClassTally {
    uint64_t count = 0;
    std::optional<WorstRay> worst;  ///< by backward error, then by t error; absent if count is 0
};

/// One tracer against the oracle on one ray set.
struct CheckRecord {
    std::string scene;
    std::string rays;  ///< kind ("primary", "random") or file name
    std::string ray_hash;
    uint64_t ray_count = 0;
    std::string tracer;
    std::string oracle;
    std::string judge;
    std::array<ClassTally, kHitClassCount> classes;         ///< the tracer's, by HitClass
    std::array<uint64_t, kHitClassCount> oracle_classes{};  ///< the oracle's own, on judged rays
    uint64_t judged = 0;          ///< rays that went to the judge (the rest agreed with the oracle)
    uint64_t wrong_triangle = 0;  ///< rays whose ids differ from the oracle's, both nearest hits
    uint64_t hit_count = 0;       ///< rays that the oracle says hit
    uint64_t oracle_invalid = 0;  ///< rays the oracle cannot take; not in any class
    uint64_t exhausted = 0;       ///< rays that ran out of a loop budget
    std::array<uint64_t, kHitClassCount> allowed{};  ///< bounds used; edge's is its budget
    bool passed = false;
    bool reference = false;  ///< Embree beside the tracers that are checked: fails no check
    std::string picture;     ///< PNG of the per-ray classes; as ImageRecord::pictures; or empty

    /// The wrong rays, counted by the deviation that each disappears without; see attribution.h.
    struct Attribution {
        bool asked = false;  ///< false: not looked into, and the rest is empty
        std::vector<std::pair<std::string, uint64_t>> by_deviation;  ///< id, rays; declared order
        uint64_t unattributed = 0;
    } attribution;

    uint64_t errors() const;  ///< false_miss + false_hit + wrong_surface + t_error
};

/// One tracer's rendered image against the oracle's.
struct ImageRecord {
    std::string scene;
    std::string tracer;
    std::string oracle;
    uint32_t width = 0;
    uint32_t height = 0;
    double rmse = 0.0;            ///< linear RGB
    double psnr_db = 0.0;         ///< 20 log10(1 / rmse); +inf for equal images
    double max_difference = 0.0;  ///< largest |difference| of any channel
    uint32_t max_x = 0;
    uint32_t max_y = 0;
    uint64_t differing_pixels = 0;  ///< pixels with any channel off by more than the tolerance
    double tolerance = 0.0;         ///< of a channel
    uint64_t allowed_pixels = 0;
    std::string reason;  ///< why the tolerance and the allowance are what they are
    bool passed = false;
    double rays_per_pixel = 0.0;
    double cells_full_scale = 0.0;  ///< cells a pixel at the bright end of the "cells" picture
    /// PNGs, as paths relative to the JSON's folder, by role: "image", "oracle", "difference",
    /// "cells".
    std::vector<std::pair<std::string, std::string>> pictures;
};

/// What one cast of a ray set did, counted in a pass of its own: no timed cast counts.
struct CastCounts {
    uint64_t cells = 0;       ///< visited by all rays, as RayCounters
    uint64_t tests = 0;       ///< ray-triangle tests
    uint64_t references = 0;  ///< list entries read
    /// Of this many of the rays, evenly spread, it is known which triangles they tested; 0 where a
    /// tracer does not tell its way (Capabilities::walks).
    uint64_t walked_rays = 0;
    uint64_t walked_tests = 0;    ///< of these rays
    uint64_t repeated_tests = 0;  ///< of these tests, those of a triangle that the ray had tested
};

/// One tracer's timed casts of one ray set. Samples are in run order.
struct TimingRecord {
    std::string scene;
    std::string rays;
    uint64_t ray_count = 0;
    std::string tracer;
    std::string oracle;  ///< what the ratio is to
    std::vector<double> wall_ms;
    std::vector<double> device_ms;       ///< empty where the device has no timer to trust
    std::vector<double> oracle_wall_ms;  ///< of the same rounds
    double median_ms = 0.0;
    double mrays_per_s = 0.0;
    double ratio = 0.0;      ///< speed relative to the oracle: oracle / tracer, median
    double ratio_low = 0.0;  ///< 95 % bootstrap interval
    double ratio_high = 0.0;
    uint64_t errors = 0;  ///< CheckRecord::errors() on the same rays, this run
    uint64_t edges = 0;   ///< its `edge` count
    /// Of a second cast in each round, where this tracer had an identical rival
    /// (compare/verdict.h); else empty.
    std::vector<double> again_wall_ms{};
    std::vector<double> again_device_ms{};
    std::optional<CastCounts> counts{};  ///< absent where the tracer does not count
};

/// How long a tracer takes before its first ray, build by build: structure and packing. Neither the
/// compiling of shaders nor the way to the device is in it.
struct BuildRecord {
    std::string scene;
    std::string tracer;
    std::vector<double> build_ms;
};

/// Rendered frames, timed: all rays of an image, as the paper's frame rates count.
struct FrameTimingRecord {
    std::string scene;
    std::string tracer;
    std::string oracle;   ///< what the ratio is to; its own record names itself
    std::string setting;  ///< parameters other than the defaults, "steps_per_pass=1"; or empty
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t frames = 0;        ///< different frames of an animation; 1 for a still image
    uint64_t primary_rays = 0;  ///< of one frame (of an animation: the mean)
    uint64_t secondary_rays =
        0;  ///< shadow and reflection rays of one frame, by the tracer's count
    std::vector<double> wall_ms;         ///< one a frame rendered: the tracing alone
    std::vector<double> device_ms;       ///< empty where the device has no timer to trust
    std::vector<double> update_ms;       ///< of an animation: rebuilding the top level; else empty
    std::vector<double> upload_ms;       ///< of an animation; else empty
    std::vector<double> oracle_wall_ms;  ///< of the same rounds
    std::vector<Stat> costs;             ///< Frame::costs of the last frame
    double median_ms = 0.0;
    double frames_per_s = 0.0;
    double ratio = 0.0;  ///< as in TimingRecord
    double ratio_low = 0.0;
    double ratio_high = 0.0;
    uint64_t differing_pixels = 0;  ///< of the oracle's image, as ImageRecord; of all frames
    uint64_t compared_pixels = 0;   ///< of all frames
};

/// What a claim says of the ratio variant / baseline.
enum class Expectation {
    above,     ///< it is larger than `bound`
    below,     ///< it is smaller than `bound`
    possible,  ///< nothing, but the variant can be made at all
    none,      ///< nothing: measured to be shown beside the others
};
std::string_view to_string(Expectation expectation);

/// `holds`, `fails` and `not_measured` speak for themselves; `depends`: of one measurement, that it
/// decides nothing; of a claim, that its measurements disagree or decide nothing.
enum class ClaimVerdict { holds, fails, depends, not_measured };
std::string_view to_string(ClaimVerdict verdict);

/// One comparison of two settings that a claim rests on: all else is equal, and so is the run.
struct ClaimMeasurement {
    std::string scene;
    std::string work;      ///< the ray kind, "image", "animation" or "build"
    std::string quantity;  ///< "time", "memory", "bandwidth", ...
    std::string unit;      ///< of the samples: "ms", "MiB", ...
    std::string baseline;  ///< tracer and setting, as the page names them
    std::string variant;
    double size = 0.0;  ///< what a series runs over (triangles, density); 0: belongs to no series
    std::vector<double> baseline_samples;  ///< in run order; what is not measured but counted: one
    std::vector<double> variant_samples;   ///< of the same rounds
    std::vector<double> again_samples;     ///< of a second run of the baseline in the same rounds
    double ratio = 0.0;                    ///< variant / baseline, median
    double ratio_low = 0.0;  ///< 95 % bootstrap interval; equal to the ratio for what is counted
    double ratio_high = 0.0;
    double noise = 0.0;  ///< largest |r - 1| in the interval of again / baseline; 0: counted
    Expectation expectation = Expectation::none;
    double bound = 1.0;  ///< that the ratio is held against
    ClaimVerdict verdict = ClaimVerdict::not_measured;
    uint64_t rays = 0;             ///< cast by each side
    uint64_t baseline_errors = 0;  ///< CheckRecord::errors() of that setting on these rays
    uint64_t variant_errors = 0;
    std::string failure;  ///< why a side could not be made; else empty
};

/// A claim of the paper, and what is left of it.
struct ClaimRecord {
    std::string id;       ///< "single-pass"
    std::string entry;    ///< "fragment" or "compute": a GPU runs the two on different processors
    std::string claim;    ///< in our words
    std::string source;   ///< where the paper says it
    std::string then;     ///< the paper's figure, or that it gives none
    std::string rule;     ///< how the verdict follows from the measurements
    std::string now;      ///< made from the measurements
    std::string command;  ///< repeats this experiment alone
    ClaimVerdict verdict = ClaimVerdict::not_measured;
    std::vector<ClaimMeasurement> measurements;
};

/// One grid size of a sweep.
struct SweepPoint {
    std::string scene;
    std::string rays;
    std::string tracer;
    double top_density = 0.0;
    double object_density = 0.0;
    std::string resolution;  ///< "64x32x32", of every object grid instead of a density; or empty
    std::string sizes;       ///< each object's own, as the parameter `sizes` takes them; or empty
    std::string chosen;      ///< how this size came to be measured (compare/tuning.h)
    uint64_t ray_count = 0;
    uint64_t cells = 0;  ///< of all grids
    uint64_t references = 0;
    uint64_t bytes = 0;  ///< on the device
    double build_ms = 0.0;
    double cells_per_ray = 0.0;  ///< from a separate, counted pass
    double tests_per_ray = 0.0;
    uint64_t errors = 0;
    std::string failure;                 ///< why this size could not be built; else empty
    std::vector<double> wall_ms;         ///< empty after a failure
    std::vector<double> device_ms;       ///< empty where the device has no timer to trust
    std::vector<double> oracle_wall_ms;  ///< of the same rounds
    double ratio = 0.0;                  ///< as in TimingRecord
    double ratio_low = 0.0;
    double ratio_high = 0.0;
};

/// Trials of one rung that failed alike.
struct FailureCount {
    std::string kind;  ///< an error class, or "self_hit", "leak", "changed", ...
    uint64_t count = 0;
};

/// One tracer on one rung of a ladder (core/ladder.h).
struct RungRecord {
    double knob = 0.0;
    std::string label{};    ///< Rung::label
    std::string tracer{};   ///< strategy/storage/entry
    std::string setting{};  ///< parameters other than the defaults, "address=half"; or empty
    uint64_t trials = 0;    ///< answers looked at: rays, or pairs of answers where two are compared
    uint64_t ties = 0;
    uint64_t edges = 0;
    std::vector<FailureCount> failures{};  ///< kinds that occurred only
    std::string refusal{};  ///< why the tracer could not take part, and trials is 0; or how many of
                            ///< the rays it took; else empty
    std::optional<WorstRay> worst{};  ///< of the failures{}; absent where no judge looked

    uint64_t failed() const;  ///< sum of the failures
};

/// What became of one ladder. Rungs in order, and within a rung the tracers in order.
struct LadderRecord {
    std::string id;
    std::string title;
    std::string question;
    std::string knob;
    std::string unit;
    bool log_axis = true;
    std::string judge;    ///< Judge::name(); empty where answers are compared among themselves
    std::string command;  ///< climbs this ladder alone
    std::vector<RungRecord> rungs;
};

/// The first rung, in order, on which the tracer failed a trial; null if it failed none. A refusal
/// is an answer, and no failure.
const RungRecord* breaks_at(const LadderRecord& ladder, const std::string& tracer,
                            const std::string& setting);

/// One tracer with one setting on one scene: how fast, and how wrong. Every ray is judged.
struct TradeoffPoint {
    std::string scene;
    std::string rays;
    std::string tracer;
    std::string setting;  ///< as in RungRecord
    std::string oracle;   ///< what the ratio is to
    uint64_t ray_count = 0;
    uint64_t errors = 0;  ///< of the error classes
    uint64_t edges = 0;
    std::vector<double> wall_ms;
    std::vector<double> oracle_wall_ms;  ///< of the same rounds
    double ratio = 0.0;                  ///< as in TimingRecord
    double ratio_low = 0.0;
    double ratio_high = 0.0;
};

/// A device's clocks as its driver tells them. NaN: it does not tell this one.
struct ClockReading {
    double sm_mhz = 0.0;
    double memory_mhz = 0.0;
    double temperature_c = 0.0;
};

/// How steady the device was while one set of rays was timed.
struct PaceRecord {
    std::string scene;
    std::string rays;
    uint64_t ray_count = 0;
    uint32_t warm_up_rounds = 0;
    double warm_up_ms = 0.0;
    double change = 0.0;    ///< of the last two paces of the warm-up, a share; NaN: no device timer
    bool steady = false;    ///< the change was within the bound before the warm-up's time was over
    std::string clocks_of;  ///< the device whose clocks these are, or why there are none
    std::optional<ClockReading> before;  ///< the counted casts
    std::optional<ClockReading> after;
};

/// One size of a growth study: what a tracer built of the growing scene.
struct GrowthBuild {
    std::string scene;  ///< the shape's name
    uint64_t triangles = 0;
    std::string tracer;
    std::string setting;           ///< as in RungRecord
    std::vector<double> build_ms;  ///< wall time, packing included; one a build
    uint64_t bytes = 0;            ///< of the structure
    uint64_t cells = 0;            ///< 0: it has none
    uint64_t references = 0;
    std::string failure;  ///< why it could not be built; else empty
};

/// ... and how it traced.
struct GrowthTrace {
    std::string scene;
    uint64_t triangles = 0;
    std::string tracer;
    std::string setting;
    std::string rays;
    uint64_t ray_count = 0;
    bool growing_rays = false;  ///< a step of the rays' growth, not of the triangles'
    std::vector<double> wall_ms;
    std::vector<double> device_ms;  ///< empty where the device has no timer to trust
    uint64_t judged = 0;            ///< rays of the sample whose answers were compared
    uint64_t errors = 0;            ///< among these, as CheckRecord::errors()
    uint64_t edges = 0;
};

/// A strategy as it is, or with one of its steps taken out, on one kind of work.
struct AblationRecord {
    std::string scene;
    std::string work;     ///< the ray kind, or "image"
    std::string tracer;   ///< strategy/storage/entry
    std::string without;  ///< the step that is taken out; empty: the strategy as it is
    std::string setting;  ///< how: parameters as in RungRecord, or another storage
    uint64_t rays = 0;    ///< cast; of an image, pixels
    uint64_t errors = 0;  ///< CheckRecord::errors(); of an image, pixels unlike the strategy's as
                          ///< it is
    uint64_t edges = 0;
    std::vector<double> wall_ms;
    std::vector<double> device_ms;  ///< empty where the device has no timer to trust
    double ratio = 0.0;  ///< speed relative to the strategy as it is; by device_ms where there is
    double ratio_low = 0.0;  ///< 95 % bootstrap interval
    double ratio_high = 0.0;
    std::string failure;  ///< why it could not be made; else empty
};

/// A bounded set of an image's pixels with every tracer's answer to each: what the page's inspector
/// reads. The answers lie in a file of their own (compare/pixels.h).
struct PixelSheetRecord {
    std::string scene;
    uint32_t width = 0;
    uint32_t height = 0;
    uint64_t pixels = 0;
    uint64_t left_out = 0;  ///< pixels with an answer that is not `agree` for which was no room
    std::string file;       ///< as ImageRecord::pictures
    std::string digest;     ///< SHA-256 of that file
};

/// A strategy that could not take a scene.
struct RefusalRecord {
    std::string scene;
    std::string tracer;
    std::string reason;
};

/// A share of a study's points: every `count`-th, from the `index`-th on.
struct Shard {
    uint32_t index = 1;  ///< 1 to count
    uint32_t count = 1;

    bool operator==(const Shard&) const = default;
};

/// Rows of one list of Results.
struct ListRows {
    std::string list;
    std::vector<uint32_t> rows;
};

/// A finished point of a study, and which records are its own.
struct StudyPoint {
    std::string key;
    std::vector<ListRows> records;
};

/// One of the runs that were merged: each measured its own points on its own machine.
struct StudyPart {
    Shard shard;
    Manifest manifest;
};

/// A run that is made of points, each finished as a whole; see compare/study.h.
struct StudyRecord {
    Shard shard;
    std::vector<std::string> keys;   ///< of all points of all shards, in order
    std::vector<StudyPoint> points;  ///< the finished ones, in order
    std::vector<StudyPart> parts;    ///< of a merged file, by shard; else empty
};

struct Results {
    static constexpr int kSchemaVersion = 3;
    Manifest manifest;
    std::vector<SceneRecord> scenes;
    std::vector<TracerRecord> tracers;
    std::vector<CheckRecord> checks;
    std::vector<ImageRecord> images;
    std::vector<TimingRecord> timings;
    std::vector<FrameTimingRecord> frame_timings;
    std::vector<ClaimRecord> claims;
    std::vector<SweepPoint> sweeps;
    std::vector<LadderRecord> ladders;
    std::vector<TradeoffPoint> tradeoffs;
    std::vector<PaceRecord> paces;
    std::vector<GrowthBuild> growth_builds;
    std::vector<GrowthTrace> growth_traces;
    std::vector<AblationRecord> ablations;
    std::vector<PixelSheetRecord> pixel_sheets;
    std::vector<RefusalRecord> refusals;
    std::vector<BuildRecord> builds;
    std::optional<StudyRecord> study;  ///< absent where the run is not made of points
};

/// Calls visit(name, &Results::list) for every list of records, in the order of the file.
template <class Visit>
void for_each_list(Visit&& visit) {
    visit("scenes", &Results::scenes), visit("tracers", &Results::tracers);
    visit("checks", &Results::checks), visit("images", &Results::images);
    visit("timings", &Results::timings), visit("frame_timings", &Results::frame_timings);
    visit("claims", &Results::claims), visit("sweeps", &Results::sweeps);
    visit("ladders", &Results::ladders), visit("tradeoffs", &Results::tradeoffs);
    visit("paces", &Results::paces), visit("growth_builds", &Results::growth_builds);
    visit("growth_traces", &Results::growth_traces), visit("ablations", &Results::ablations);
    visit("pixel_sheets", &Results::pixel_sheets), visit("refusals", &Results::refusals);
    visit("builds", &Results::builds);
}

/// JSON text of a run, closed by a digest of all the rest. Infinities are the strings "inf" and
/// "-inf", NaN is null; all else reads back as the very value that was written.
std::string to_json(const Results& results);

/// Throws: Error naming the file and the field for text that is not a Results of this version: no
/// JSON, another version, a field that is missing, unknown or of another type.
Results results_from_json(const std::string& text, const std::string& file_name);

/// The digest that a result file holds, and the one that its content has.
///
/// SHA-256 of all members but the digest itself, as JSON without blanks and with sorted keys: what
/// a record means decides, not how the file is laid out, and a new record type is covered at once.
struct Seal {
    std::string stored;  ///< "" in a file from before there were digests
    std::string derived;

    bool intact() const { return stored == derived; }
};
/// Throws: Error for text that is no JSON object.
Seal seal_of(const std::string& text, const std::string& file_name);

/// Written whole or not at all: temporary file, then rename. "-" writes to standard output.
void write_results(const Results& results, const std::filesystem::path& path);
Results read_results(const std::filesystem::path& path);

}  // namespace onepass
