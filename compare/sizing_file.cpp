#include "compare/sizing_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/atomic_file.h"
#include "compare/tuning.h"
#include "core/error.h"
#include "core/grid/sizing.h"

namespace onepass {
namespace {

using json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// How to mend any of these files.
constexpr char kRemedy[] = "Make it with 'onepass tune SCENE --sizing-out FILE'.";

// ---- Writing -----------------------------------------------------------------------------------

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json object_json(const ObjectSize& object) {
    return {{"object", object.object}, {"triangles", object.triangles}, {"size", object.size}};
}

json tracer_json(const TracerSizing& sizing) {
    json objects = json::array();
    for (const ObjectSize& object : sizing.objects) objects.push_back(object_json(object));
    return {{"tracer", sizing.tracer},
            {"rays", sizing.rays},
            {"chosen", sizing.chosen},
            {"top_density", sizing.top_density},
            {"objects", objects},
            {"predicted_ns", number(sizing.predicted_ns)},
            {"measured_ns", number(sizing.measured_ns)},
            {"bytes", sizing.bytes},
            {"errors", sizing.errors}};
}

// ---- Reading -----------------------------------------------------------------------------------

/// A JSON object that is read field by field; it knows its place for messages.
class Fields {
  public:
    Fields(const json& value, std::string place) : value_(value), place_(std::move(place)) {
        if (!value_.is_object()) refuse(place_, value_.type_name(), "an object");
    }

    std::string text(const char* name) {
        const json& field = at(name);
        if (!field.is_string()) refuse(where(name), field.dump(), "a text");
        return field.get<std::string>();
    }
    uint64_t count(const char* name) {
        const json& field = at(name);
        if (!field.is_number_unsigned()) refuse(where(name), field.dump(), "a count");
        return field.get<uint64_t>();
    }
    /// null is NaN.
    double number(const char* name) {
        const json& field = at(name);
        if (field.is_null()) return std::numeric_limits<double>::quiet_NaN();
        if (!field.is_number()) refuse(where(name), field.dump(), "a number");
        return field.get<double>();
    }
    /// Calls read(element, place) for each element of a list.
    template <class Read>
    void list(const char* name, const Read& read) {
        const json& field = at(name);
        if (!field.is_array()) refuse(where(name), field.type_name(), "a list");
        for (size_t i = 0; i < field.size(); ++i) {
            read(field[i], fmt::format("{}[{}]", where(name), i));
        }
    }
    void finish() const {
        for (const auto& [name, value] : value_.items()) {
            if (!known_.contains(name)) refuse(place_, "unknown field '" + name + "'", "none");
        }
    }
    std::string where(const std::string& name) const { return place_ + ": " + name; }

    [[noreturn]] static void refuse(const std::string& where, const std::string& got,
                                    const std::string& expected) {
        constexpr size_t kShown = 60;
        throw Error({where, got.substr(0, kShown), expected, kRemedy});
    }

  private:
    const json& at(const char* name) {
        known_.insert(name);
        const auto found = value_.find(name);
        if (found == value_.end()) refuse(where(name), "nothing", "a value");
        return *found;
    }

    const json& value_;
    std::string place_;
    std::set<std::string> known_;
};

ObjectSize read_object(const json& value, const std::string& place) {
    Fields fields(value, place);
    ObjectSize object{fields.text("object"), fields.count("triangles"), fields.text("size")};
    fields.finish();
    parse_grid_sizing(object.size, fields.where("size"));  // throws
    return object;
}

TracerSizing read_tracer(const json& value, const std::string& place) {
    Fields fields(value, place);
    TracerSizing sizing;
    sizing.tracer = fields.text("tracer");
    sizing.rays = fields.text("rays");
    sizing.chosen = fields.text("chosen");
    sizing.top_density = fields.number("top_density");
    fields.list("objects", [&](const json& object, const std::string& at) {
        sizing.objects.push_back(read_object(object, at));
    });
    sizing.predicted_ns = fields.number("predicted_ns");
    sizing.measured_ns = fields.number("measured_ns");
    sizing.bytes = fields.count("bytes");
    sizing.errors = fields.count("errors");
    fields.finish();
    if (!(sizing.top_density >= 0.0)) {
        Fields::refuse(fields.where("top_density"), fmt::format("{}", sizing.top_density),
                       "a number, 0 or above");
    }
    return sizing;
}

SceneSizing read_scene(const json& value, const std::string& place) {
    Fields fields(value, place);
    SceneSizing scene{fields.text("scene"), fields.text("hash"), {}};
    fields.list("tracers", [&](const json& tracer, const std::string& at) {
        scene.tracers.push_back(read_tracer(tracer, at));
    });
    fields.finish();
    return scene;
}

// ---- Looking up --------------------------------------------------------------------------------

std::string listed(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "nothing" : text;
}

const SceneSizing& scene_of(const SizingFile& file, const std::string& file_name,
                            const std::string& hash) {
    std::set<std::string> known;
    for (const SceneSizing& scene : file.scenes) {
        if (scene.hash == hash) return scene;
        known.insert(fmt::format("{} ({})", scene.scene, scene.hash));
    }
    throw Error({file_name, "sizes of " + listed(known),
                 "the scene with hash " + hash + ", which is being used", kRemedy});
}

const TracerSizing& tracer_of(const SceneSizing& scene, const std::string& file_name,
                              const std::string& tracer, const std::vector<std::string>& rays) {
    const auto storage_of = [](const std::string& name) { return name.substr(0, name.rfind('/')); };
    const TracerSizing* found = nullptr;
    int found_rank = 0;
    std::set<std::string> known;
    for (const TracerSizing& sizing : scene.tracers) {
        known.insert(sizing.tracer);
        if (storage_of(sizing.tracer) != storage_of(tracer)) continue;
        const bool same_rays = std::find(rays.begin(), rays.end(), sizing.rays) != rays.end();
        const int rank = 1 + (sizing.tracer == tracer ? 2 : 0) + (same_rays ? 1 : 0);
        if (rank <= found_rank) continue;
        found = &sizing;
        found_rank = rank;
    }
    if (found != nullptr) return *found;
    throw Error({fmt::format("{}, scene {}", file_name, scene.scene), "sizes for " + listed(known),
                 tracer, kRemedy});
}

/// Object by object, name and triangles. The hash says that the scene is the one of the study; an
/// edited file may still leave out an object, or mix two up.
void check_objects(const TracerSizing& sizing, const std::string& where, const Scene& scene) {
    const size_t count = std::max(sizing.objects.size(), scene.objects.size());
    for (size_t k = 0; k < count; ++k) {
        const auto in_scene = [&] {
            return fmt::format("'{}' of {} triangles", scene.objects[k].name,
                               scene.objects[k].triangles.size());
        };
        const auto in_file = [&] {
            return fmt::format("'{}' of {} triangles", sizing.objects[k].object,
                               sizing.objects[k].triangles);
        };
        if (k >= sizing.objects.size()) {
            throw Error({where, fmt::format("no object {}", k), in_scene(), kRemedy});
        }
        if (k >= scene.objects.size()) {
            throw Error({where, fmt::format("an object {}, {}", k, in_file()),
                         fmt::format("the scene's {} objects", scene.objects.size()), kRemedy});
        }
        // Names do not count in a scene's hash.
        if (sizing.objects[k].triangles == scene.objects[k].triangles.size()) continue;
        throw Error({fmt::format("{}, object {}", where, k), in_file(), in_scene(), kRemedy});
    }
}

}  // namespace

TracerSizing tracer_sizing(const SweepPoint& point, const Scene& scene, double measured_ns,
                           double predicted_ns) {
    TracerSizing sizing{.tracer = point.tracer,
                        .rays = point.rays,
                        .chosen = point.chosen,
                        .top_density = point.top_density,
                        .objects = {},
                        .predicted_ns = predicted_ns,
                        .measured_ns = measured_ns,
                        .bytes = point.bytes,
                        .errors = point.errors};
    std::string shared = fmt::format("{}", point.object_density);
    if (!point.resolution.empty()) shared = point.resolution;
    size_t at = 0;
    for (const Object& object : scene.objects) {
        std::string own = shared;
        if (!point.sizes.empty()) {
            const size_t end = std::min(point.sizes.find(',', at), point.sizes.size());
            own = point.sizes.substr(at, end - at);
            at = std::min(end + 1, point.sizes.size());
        }
        sizing.objects.push_back({object.name, object.triangles.size(), own});
    }
    return sizing;
}

std::string to_json(const SizingFile& file) {
    json scenes = json::array();
    for (const SceneSizing& scene : file.scenes) {
        json tracers = json::array();
        for (const TracerSizing& sizing : scene.tracers) tracers.push_back(tracer_json(sizing));
        scenes.push_back({{"scene", scene.scene}, {"hash", scene.hash}, {"tracers", tracers}});
    }
    const json document = {{"onepass_sizing", int{SizingFile::kVersion}}, {"scenes", scenes}};
    return document.dump(1) + "\n";
}

SizingFile sizing_from_json(const std::string& text, const std::string& file_name) {
    const json document = json::parse(text, nullptr, false);
    if (document.is_discarded()) {
        Fields::refuse(file_name, "text that is no JSON", "a sizing file of onepass");
    }
    Fields fields(document, file_name);
    const uint64_t version = fields.count("onepass_sizing");
    if (version != SizingFile::kVersion) {
        Fields::refuse(fields.where("onepass_sizing"), std::to_string(version),
                       std::to_string(SizingFile::kVersion));
    }
    SizingFile file;
    fields.list("scenes", [&](const json& scene, const std::string& at) {
        file.scenes.push_back(read_scene(scene, at));
    });
    fields.finish();
    return file;
}

void write_sizing_file(const SizingFile& file, const fs::path& path) {
    write_bytes_atomically(path, to_json(file));
}

SizingFile read_sizing_file(const fs::path& path) {
    std::error_code ignored;
    std::ifstream file(path, std::ios::binary);
    if (!file || fs::is_directory(path, ignored)) {
        throw Error(
            {path.string(), "a file that cannot be opened", "a sizing file of onepass", kRemedy});
    }
    return sizing_from_json({std::istreambuf_iterator<char>(file), {}}, path.string());
}

GridSize size_from(const SizingFile& file, const std::string& file_name, const std::string& tracer,
                   const Scene& scene, const std::string& scene_hash,
                   const std::vector<std::string>& rays) {
    const SceneSizing& of_scene = scene_of(file, file_name, scene_hash);
    const TracerSizing& sizing = tracer_of(of_scene, file_name, tracer, rays);
    check_objects(sizing, fmt::format("{}, scene {}, {}", file_name, of_scene.scene, sizing.tracer),
                  scene);

    GridSize size{.top_density = sizing.top_density, .chosen = kFileSize};
    const std::string& first = sizing.objects.front().size;
    const bool same = std::all_of(sizing.objects.begin(), sizing.objects.end(),
                                  [&](const ObjectSize& object) { return object.size == first; });
    const GridSizing shared = parse_grid_sizing(first, file_name);
    size.object_density = shared.density;
    if (same) {
        if (shared.resolution) size.resolution = first;
        return size;
    }
    for (const ObjectSize& object : sizing.objects) {
        size.sizes += (size.sizes.empty() ? "" : ",") + object.size;
    }
    return size;
}

}  // namespace onepass
