// The sizing file: what `onepass tune` found, for `render`, `check` and `bench` to use.
//
// JSON, by scene (found by its content's hash, not by its name) and by tracer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "compare/results.h"
#include "compare/sweep.h"
#include "core/scene.h"

namespace onepass {

/// An object's name and size, so that a reader sees which is which.
struct ObjectSize {
    std::string object;
    uint64_t triangles = 0;
    std::string size;  ///< a density ("8"), or a resolution ("64x32x32")

    bool operator==(const ObjectSize&) const = default;
};

/// The sizes of one tracer's grids in one scene.
struct TracerSizing {
    std::string tracer;  ///< strategy/storage/entry
    std::string rays;    ///< ray kind it was chosen for
    std::string chosen;  ///< as SweepPoint
    double top_density = 0.0;
    std::vector<ObjectSize> objects;  ///< all of the scene's, in its order
    double predicted_ns = 0.0;        ///< a ray, by the model fitted to the study; NaN: none
    double measured_ns = 0.0;         ///< a ray
    uint64_t bytes = 0;               ///< on the device
    uint64_t errors = 0;
};

struct SceneSizing {
    std::string scene;  ///< as it was named then
    std::string hash;   ///< SceneRecord::hash
    std::vector<TracerSizing> tracers;
};

struct SizingFile {
    static constexpr int kVersion = 1;
    std::vector<SceneSizing> scenes;
};

/// A point's size as an entry of the file.
TracerSizing tracer_sizing(const SweepPoint& point, const Scene& scene, double measured_ns,
                           double predicted_ns);

std::string to_json(const SizingFile& file);

/// Throws: Error naming the file and the place for text that is no sizing file.
SizingFile sizing_from_json(const std::string& text, const std::string& file_name);

/// Written whole or not at all.
void write_sizing_file(const SizingFile& file, const std::filesystem::path& path);
SizingFile read_sizing_file(const std::filesystem::path& path);

/// The size that the file has for a tracer in a scene of this hash. A tracer that it does not name
/// takes what it says of the same strategy and storage: the entry does not change the grids. Of
/// several ray kinds, the first in the file that `rays` names, else the first.
/// Throws: Error if the file has no such scene or tracer, if an object of the scene is missing in
/// it, or if its objects are not the scene's.
GridSize size_from(const SizingFile& file, const std::string& file_name, const std::string& tracer,
                   const Scene& scene, const std::string& scene_hash,
                   const std::vector<std::string>& rays);

}  // namespace onepass
