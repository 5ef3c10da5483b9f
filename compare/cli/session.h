// What the commands share in one process: the catalogue, the GL context, the oracle and the
// results.
//
// The one file that joins all modules. A GL context is made only when a GL tracer asks for it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compare/clocks.h"
#include "compare/hits.h"
#include "compare/rays.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/catalogue.h"
#include "core/io/load.h"
#include "gpu_glsl/gl/context.h"

namespace onepass::cli {

/// The tracer that every check is against.
inline constexpr char kOracleName[] = "embree/robust/threads";
/// The tracer that is judged beside the oracle: Embree as most use it.
inline constexpr char kFastEmbreeName[] = "embree/fast/threads";

/// Exit codes of the program.
enum ExitCode : int {
    kPassed = 0,
    kFailed = 1,     ///< compared, and failed
    kBadInput = 2,   ///< bad input or usage
    kNoDevice = 3,   ///< no usable device
    kInternal = 4,   ///< an error of ours
    kStopped = 130,  ///< Ctrl-C; what was written is whole, and says that it is not complete
};

/// Options before the command; `onepass --help` explains them.
struct GlobalOptions {
    std::string gl = "auto";
    int device = gl::kAnyDevice;
    uint64_t seed = 1;
};

class Session {
  public:
    explicit Session(std::vector<std::string> arguments);
    Session(const Session&) = delete;  // the catalogue's tracers ask this one for the context

    GlobalOptions globals;
    Catalogue catalogue;
    int exit_code = kPassed;

    /// The process's GL context, made at the first call.
    /// Throws: Error (device) if there is none.
    gl::GlContext& gl_context();

    /// The clocks of the device that the context is on; none yet, and why, where they cannot be
    /// read.
    DeviceClocks device_clocks();

    /// The manifest of this run so far.
    Manifest manifest() const;

  private:
    std::vector<std::string> arguments_;
    std::unique_ptr<gl::GlContext> gl_context_;
    std::unique_ptr<ClockReader> clock_reader_;  ///< made when first asked for
};

/// A loaded scene with its record; notes of the import have been said on stderr.
struct OpenScene {
    std::string name;
    ScenePtr scene;
    SceneRecord record;
};
OpenScene open_scene(const std::string& name_or_path);

/// A scene with those who know the truth about it.
struct Court {
    OpenScene open;
    std::unique_ptr<Tracer> oracle;
    std::unique_ptr<Judge> judge;
};
Court open_court(const Session& session, const std::string& name_or_path);

/// Moves the court to a frame of its scene's animation: from then on its scene and its name are the
/// frame's, its oracle is updated, and its judge is another. Returns the frame's transforms.
/// Throws: Error for a scene in which nothing moves.
std::vector<Affine> move_to_frame(Court& court, uint32_t frame, double frames_per_s);

/// Rays with the oracle's answers.
struct Case {
    RaySet rays;
    CastResult truth;
};
Case open_case(Court& court, const std::string& kind_or_file, const RayRequest& request);

/// The tracer's answers to the case's rays.
CastResult answers_of(const Case& subject, Tracer& tracer);

/// Compares several tracers' answers, each ray judged once for all; the records are filled in
/// whole. Rays aimed at edges have no budget of `edge` unless the options state one.
std::vector<HitComparison> check_answers(const Court& court, const Case& subject,
                                         std::span<const CastResult> answers,
                                         std::span<const std::string> tracers,
                                         const HitCheckOptions& options);

/// Casts and compares one tracer.
HitComparison check_tracer(const Court& court, const Case& subject, Tracer& tracer,
                           const HitCheckOptions& options);

/// Writes the results to `json` ("-": stdout, empty: nowhere), marked incomplete if `stopped`.
void finish(Session& session, Results& results, const std::string& json, bool stopped);

/// Where tables go: stdout, or stderr while stdout carries JSON.
std::FILE* table_stream(const std::string& json);

}  // namespace onepass::cli
