// What `onepass render` does of one image and of the frames of an animation alike. Internal to
// render.cpp and render_frames.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "compare/cli/options.h"
#include "compare/cli/session.h"
#include "compare/cli/sizing.h"

namespace onepass::cli {

struct RenderCommand {
    std::string scene;
    std::string strategy;
    std::vector<std::string> params;
    SizingOptions sizing;
    std::string size = "512x512";
    std::string output;
    std::vector<std::string> aovs;
    uint32_t camera = 0;
    uint32_t depth = RenderSettings{}.max_depth;
    bool no_shadows = false;

    // Of an animation.
    std::string frames;  ///< empty: one image, of the scene at rest
    double fps = 24.0;
    bool check = true;
    bool resume = false;
    std::string json;
};

/// The file, or the pattern of files, to write: -o, or a name made from the scene's.
std::string output_path(const RenderCommand& options);

/// What both kinds of rendering start from.
struct Stage {
    OpenScene open;
    SelectedStrategy strategy;
    std::unique_ptr<Tracer> tracer;
    Camera camera;
    RenderSettings settings;
    std::vector<std::string> aovs;
};

/// Reads the options, checks `output` and loads the scene, in this order.
/// Throws: Error for what cannot be rendered or written; nothing was computed then.
Stage set_up(Session& session, const RenderCommand& options, const std::filesystem::path& output);

void write_frame(const std::filesystem::path& path, const Frame& frame,
                 const std::vector<std::string>& aovs);

/// Pixels of which some ray ran out of its loop budget.
size_t exhausted_pixels(const Frame& frame);

/// `render --frames`: renders, checks and reports.
void render_frames(Session& session, const RenderCommand& options);

}  // namespace onepass::cli
