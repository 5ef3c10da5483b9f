// onepass explain: one ray, every tracer, the exact answer, and a small scene that shows the same.
#include "compare/explain.h"

#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/npy.h"
#include "compare/reproduction.h"
#include "core/camera.h"
#include "core/error.h"
#include "cpu_ref/exact_judge.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct ExplainCommand {
    std::string scene;
    std::string ray;
    std::string pixel;
    std::string size = "512x512";
    uint32_t camera = 0;
    StrategyOptions strategy;
    std::string folder;
    std::string json;
};

// ---- Which ray ---------------------------------------------------------------------------------

std::optional<uint64_t> parse_number(std::string_view text) {
    uint64_t value = 0;
    const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = failure == std::errc() && stop == text.data() + text.size();
    return whole ? std::optional(value) : std::nullopt;
}

Ray ray_of_pixel(const ExplainCommand& options, const Scene& scene) {
    const ImageSize size = parse_size(options.size);
    const size_t comma = options.pixel.find(',');
    const auto x = parse_number(std::string_view(options.pixel).substr(0, comma));
    const auto y = comma == std::string::npos
                       ? std::nullopt
                       : parse_number(std::string_view(options.pixel).substr(comma + 1));
    if (!x || !y || *x >= size.width || *y >= size.height) {
        throw Error({"--pixel", fmt::format("'{}'", options.pixel),
                     fmt::format("X,Y within {} x {} pixels, from 0,0 at the top left", size.width,
                                 size.height),
                     "Name a pixel, or another --size."});
    }
    if (options.camera >= scene.cameras.size()) {
        throw Error({"--camera", std::to_string(options.camera),
                     fmt::format("0 to {}", scene.cameras.size() - 1), "Choose another."});
    }
    return primary_ray(camera_frame(scene.cameras[options.camera], size.width, size.height),
                       static_cast<uint32_t>(*x), static_cast<uint32_t>(*y));
}

/// "vertex#17", "rays.npy#3", or "ray.npy", which then holds one ray.
Ray ray_of_set(const ExplainCommand& options, const std::string& text, const OpenScene& open,
               const Session& session) {
    const size_t mark = text.rfind('#');
    const std::string name = text.substr(0, mark);
    const ImageSize size = parse_size(options.size);
    const auto oracle = session.catalogue.at(kOracleName).make(open.scene, {});
    const RaySet set =
        make_ray_set(name, *open.scene, *oracle,
                     {size.width, size.height, options.camera, session.globals.seed});
    std::optional<uint64_t> index = 0;
    if (mark != std::string::npos) {
        index = parse_number(std::string_view(text).substr(mark + 1));
    } else if (set.rays.size() != 1) {
        index = std::nullopt;
    }
    if (!index || *index >= set.rays.size()) {
        throw Error({"--ray", fmt::format("'{}'", text),
                     fmt::format("{}#INDEX, INDEX from 0 to {}", name, set.rays.size() - 1),
                     "'onepass check' prints the indices of its worst rays."});
    }
    return set.rays[*index];
}

Ray ray_asked_for(const ExplainCommand& options, const OpenScene& open, const Session& session) {
    if (!options.pixel.empty()) return ray_of_pixel(options, *open.scene);
    if (options.ray.find(',') != std::string::npos) return parse_ray(options.ray);
    return ray_of_set(options, options.ray, open, session);
}

// ---- Which tracers -----------------------------------------------------------------------------

std::vector<SelectedStrategy> selected(const Session& session, const ExplainCommand& options) {
    StrategyOptions strategy = options.strategy;
    if (strategy.patterns.empty()) {
        strategy.patterns = {kOracleName, "embree/fast/threads"};
        for (const CatalogueEntry& entry : session.catalogue.entries()) {
            const TracerInfo& info = entry.info;
            if (info.by_default && !info.is_oracle) strategy.patterns.push_back(info.name);
        }
    }
    return select_strategies(session.catalogue, strategy);
}

/// Makes them for a scene and lets them answer.
Explanation explain_in(const ScenePtr& scene, const Ray& ray,
                       const std::vector<SelectedStrategy>& strategies) {
    std::vector<std::unique_ptr<Tracer>> tracers;
    std::vector<Tracer*> pointers;
    for (const SelectedStrategy& strategy : strategies) {
        tracers.push_back(strategy.entry->make(scene, strategy.params));
        pointers.push_back(tracers.back().get());
    }
    return explain_ray(ray, *make_exact_judge(scene), pointers);
}

// ---- The reproduction --------------------------------------------------------------------------

/// The same -s and --param again.
std::string options_text(const ExplainCommand& options) {
    std::string text;
    for (const std::string& name : options.strategy.patterns) text += " -s '" + name + "'";
    for (const std::string& param : options.strategy.params) text += " --param " + param;
    return text;
}

/// Writes the files, reads them back, and asks everybody again. What is said of it.
std::string write_and_verify(const Session& session, const ExplainCommand& options,
                             const OpenScene& open, const Explanation& explanation,
                             const std::vector<SelectedStrategy>& strategies) {
    const fs::path folder = options.folder;
    const Reproduction reproduction = make_reproduction(*open.scene, explanation);
    write_reproduction(reproduction, folder);

    const fs::path scene_path = folder / "scene.glb";
    const OpenScene small = open_scene(scene_path.string());
    const std::vector<Ray> rays = read_rays_npy(folder / "ray.npy");
    const Explanation again = explain_in(small.scene, rays.at(0), strategies);
    const std::vector<Recurrence> recurrences =
        compare_statements(reproduction, explanation, again);

    const Manifest manifest = session.manifest();
    const Notes notes{
        .found_in = fmt::format("Found in scene `{}` (content hash {}), {} triangles.", open.name,
                                open.record.hash, open.record.triangles),
        .options = options_text(options),
        .program = fmt::format("onepass {}{}; {}{}", manifest.commit,
                               manifest.dirty ? " with changes" : "", manifest.embree,
                               manifest.gl_renderer.empty() ? "" : "; " + manifest.gl_renderer)};
    write_bytes_atomically(folder / "README.md",
                           reproduction_readme(reproduction, again, recurrences, notes));
    return fmt::format("reproduction: {} triangles in {}, reloaded and judged again\n{}",
                       instanced_triangle_count(*small.scene), scene_path.string(),
                       recurrence_text(recurrences));
}

void make_folder(const std::string& folder) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed || !fs::is_directory(folder)) {
        throw Error({"-o " + folder, failed ? failed.message() : "no folder",
                     "a folder, or a name for one", "Choose another."});
    }
}

void run(Session& session, const ExplainCommand& options) {
    // Everything that can be wrong with the options.
    if (options.ray.empty() == options.pixel.empty()) {
        throw Error({"onepass explain", options.ray.empty() ? "no ray" : "--ray and --pixel",
                     "one of --ray and --pixel", "Name one ray."});
    }
    const std::vector<SelectedStrategy> strategies = selected(session, options);
    if (!options.json.empty() && options.json != "-") check_writable(options.json);
    const OpenScene open = open_scene(options.scene);
    const Ray ray = ray_asked_for(options, open, session);
    if (!options.folder.empty()) make_folder(options.folder);

    const Explanation explanation = explain_in(open.scene, ray, strategies);
    std::FILE* const out = table_stream(options.json);
    fmt::print(out, "{}\n{}", open.name, explanation_text(explanation, *open.scene));
    if (!options.folder.empty()) {
        fmt::print(out, "{}", write_and_verify(session, options, open, explanation, strategies));
    }

    // Data.
    const std::string json = options.json.empty() ? "" : explanation_json(explanation, *open.scene);
    if (options.json == "-") {
        fmt::print("{}", json);
    } else if (!options.json.empty()) {
        write_bytes_atomically(options.json, json);
        fmt::print(stderr, "onepass: wrote {}\n", options.json);
    }
}

}  // namespace

void add_explain(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "explain", "One ray: the exact answer, what each tracer said and did, and why");
    auto options = std::make_shared<ExplainCommand>();
    command->add_option("scene", options->scene, "Scene name or file")->required();
    command
        ->add_option("--ray", options->ray,
                     "The ray as numbers, decimal or hexadecimal: ox,oy,oz,dx,dy,dz[,tmin,tmax] "
                     "(default interval: 0,inf); or the ray of a file or of a kind that 'onepass "
                     "check --rays' knows, by the index that it prints")
        ->type_name("NUMBERS|FILE.npy[#INDEX]|KIND#INDEX");
    command
        ->add_option("--pixel", options->pixel,
                     "The primary ray of a pixel, from 0,0 at the "
                     "top left")
        ->type_name("X,Y");
    command
        ->add_option("--size", options->size,
                     "Image size in pixels, for --pixel and for the rays of a kind")
        ->type_name("WxH")
        ->capture_default_str();
    command->add_option("--camera", options->camera, "Which of the scene's cameras, from 0")
        ->capture_default_str();
    command
        ->add_option("-s,--strategy", options->strategy.patterns,
                     "Strategy: NAME[/STORAGE[/ENTRY]] or a pattern with '*'; may be repeated. "
                     "Default: all, with their twins, and Embree robust and fast")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--param", options->strategy.params, "A strategy's parameter; may be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    command
        ->add_option("-o,--output", options->folder,
                     "Folder for a small scene that shows the same: scene.glb, ray.npy and "
                     "README.md; made if it is not there, then read back and judged again")
        ->type_name("DIR");
    command
        ->add_option("--json", options->json,
                     "Writes the explanation as JSON; '-' is standard output")
        ->type_name("FILE");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
