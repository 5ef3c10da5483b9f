// A small scene that shows what one ray shows in a large one: to be pasted into anybody's issue.
//
// What the ray hits, what was answered, and their neighbours, with the same bits in the same
// places. Whoever reloads the files can check by himself that the tracers still say the same.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/explain.h"

namespace onepass {

struct Reproduction {
    Scene scene;
    Ray ray;
    std::vector<uint32_t> instances;  ///< of the small scene: number in the large one
    std::vector<std::vector<uint32_t>>
        prim_ids;  ///< of each small object: numbers in its large one

    /// A hit of the small scene in the numbers of the large one.
    Hit in_large(Hit hit) const;
};

/// Keeps of the scene every triangle that the ray hits, that it passes within E_ray, or that a
/// tracer answered, and all that share a corner with one of those; in all instances concerned, with
/// their materials, lights and cameras. Nothing moves any more.
///
/// E_ray goes with the size of the scene. Where the small scene would change that, the triangles
/// that span the box of the largest instance are kept as well.
/// Of a ray that meets nothing, the first triangle stands for the scene.
Reproduction make_reproduction(const Scene& scene, const Explanation& explanation);

/// Whether a tracer says the same in the small scene as in the large one.
struct Recurrence {
    std::string tracer;
    Statement large;
    Statement small;
    bool same_class = false;
    bool same_answer = false;  ///< the same triangle, by the numbers of the large scene
    bool holds() const { return same_class && same_answer; }
};

/// `small`: the same tracers, in the same order, in the small scene.
std::vector<Recurrence> compare_statements(const Reproduction& reproduction,
                                           const Explanation& large, const Explanation& small);

/// "reproduces: yes  embree/fast/threads ...", a line a tracer.
std::string recurrence_text(const std::vector<Recurrence>& recurrences);

/// Writes scene.glb and ray.npy. The folder must exist.
void write_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder);

/// What stands beside the files, in Markdown.
struct Notes {
    std::string found_in;  ///< the large scene and the command line
    std::string options;   ///< of the command that runs it again: " -s NAME --param K=V"
    std::string program;   ///< versions
};
std::string reproduction_readme(const Reproduction& reproduction, const Explanation& small,
                                const std::vector<Recurrence>& recurrences, const Notes& notes);

}  // namespace onepass
