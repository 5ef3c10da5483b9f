#include "compare/reproduction.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "compare/npy.h"
#include "core/error.h"
#include "core/io/load.h"

namespace onepass {
namespace {

// ---- What is kept ------------------------------------------------------------------------------

/// Triangles by object, and the instances they were met in.
struct Selection {
    std::map<uint32_t, std::set<uint32_t>> prim_ids;  ///< by object
    std::set<uint32_t> instances;

    void add(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
        instances.insert(inst_id);
        prim_ids[scene.instances[inst_id].object].insert(prim_id);
    }
};

bool names_triangle(const Scene& scene, const Hit& hit) {
    return hit.inst_id < scene.instances.size() &&
           hit.prim_id < scene.objects[scene.instances[hit.inst_id].object].triangles.size();
}

/// Corners are the same if their bits are: a mesh may store one twice, for two normals.
using CornerBits = std::array<uint32_t, 3>;
CornerBits bits_of(const vec3& p) {
    return {std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y),
            std::bit_cast<uint32_t>(p.z)};
}

/// Adds the triangles that share a corner with a kept one.
void add_neighbours(const Object& object, std::set<uint32_t>& kept) {
    std::set<CornerBits> corners;
    for (const uint32_t prim_id : kept) {
        for (int k = 0; k < 3; ++k) {
            corners.insert(bits_of(object.positions[object.triangles[prim_id][k]]));
        }
    }
    for (uint32_t prim_id = 0; prim_id < object.triangles.size(); ++prim_id) {
        for (int k = 0; k < 3; ++k) {
            if (corners.contains(bits_of(object.positions[object.triangles[prim_id][k]]))) {
                kept.insert(prim_id);
            }
        }
    }
}

/// The power of two that E_ray's origin goes with: of the ray's or the boxes' largest coordinate.
int reach_exponent(const Ray& ray, float magnitude) {
    const vec3 org = glm::abs(ray.org);
    return std::ilogb(std::max({org.x, org.y, org.z, magnitude}));
}

Bounds bounds_of(const Object& object, const std::set<uint32_t>& prim_ids) {
    Bounds bounds;
    for (const uint32_t prim_id : prim_ids) {
        for (int k = 0; k < 3; ++k) bounds.extend(object.positions[object.triangles[prim_id][k]]);
    }
    return bounds;
}

float magnitude_of(const Scene& scene, const Selection& selection) {
    float magnitude = 0.0f;
    for (const uint32_t inst_id : selection.instances) {
        const Instance& instance = scene.instances[inst_id];
        const Bounds box =
            bounds_of(scene.objects[instance.object], selection.prim_ids.at(instance.object));
        magnitude =
            std::max(magnitude, transform_bounds(instance.world_from_object, box).magnitude());
    }
    return magnitude;
}

/// Adds triangles that touch all sides of an instance's object's box.
void add_spanning(const Scene& scene, uint32_t inst_id, Selection& selection) {
    const Object& object = scene.objects[scene.instances[inst_id].object];
    const Bounds box = object_bounds(object);
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const float wanted = side % 2 == 0 ? box.lower[axis] : box.upper[axis];
        const auto touches = [&](const uvec3& triangle) {
            return object.positions[triangle.x][axis] == wanted ||
                   object.positions[triangle.y][axis] == wanted ||
                   object.positions[triangle.z][axis] == wanted;
        };
        const auto found = std::find_if(object.triangles.begin(), object.triangles.end(), touches);
        if (found == object.triangles.end()) continue;  // a corner that no triangle uses
        selection.add(scene, inst_id, static_cast<uint32_t>(found - object.triangles.begin()));
    }
}

Selection select(const Scene& scene, const Explanation& explanation) {
    // What the ray meets, and what was said.
    Selection selection;
    for (const Meeting& m : explanation.truth.hits) selection.add(scene, m.inst_id, m.prim_id);
    for (const Meeting& m : explanation.truth.passed) selection.add(scene, m.inst_id, m.prim_id);
    for (const Statement& s : explanation.statements) {
        if (names_triangle(scene, s.hit)) selection.add(scene, s.hit.inst_id, s.hit.prim_id);
    }
    if (selection.instances.empty()) selection.add(scene, 0, 0);
    for (auto& [object, prim_ids] : selection.prim_ids) {
        add_neighbours(scene.objects[object], prim_ids);
    }

    // What keeps E_ray.
    const std::vector<Bounds> boxes = instance_bounds(scene);
    const auto largest = std::max_element(
        boxes.begin(), boxes.end(),
        [](const Bounds& a, const Bounds& b) { return a.magnitude() < b.magnitude(); });
    if (reach_exponent(explanation.ray, magnitude_of(scene, selection)) <
        reach_exponent(explanation.ray, largest->magnitude())) {
        add_spanning(scene, static_cast<uint32_t>(largest - boxes.begin()), selection);
    }
    return selection;
}

// ---- The small scene ---------------------------------------------------------------------------

/// The kept triangles in their order, the vertices they use, and the groups they are of.
/// `groups`: which of the large object's groups those are.
Object smaller(const Object& large, const std::set<uint32_t>& kept, std::vector<uint32_t>& groups) {
    Object small;
    small.name = large.name;
    std::map<uint32_t, uint32_t> vertex_of;
    for (const uint32_t prim_id : kept) {
        uvec3 triangle(0);
        for (int k = 0; k < 3; ++k) {
            const uint32_t vertex = large.triangles[prim_id][k];
            const auto next = static_cast<uint32_t>(small.positions.size());
            const auto [known, is_new] = vertex_of.try_emplace(vertex, next);
            triangle[k] = known->second;
            if (!is_new) continue;
            small.positions.push_back(large.positions[vertex]);
            if (!large.normals.empty()) small.normals.push_back(large.normals[vertex]);
        }
        const uint32_t group = group_of_triangle(large, prim_id);
        if (groups.empty() || groups.back() != group) {
            groups.push_back(group);
            small.groups.push_back(
                {large.groups[group].name, static_cast<uint32_t>(small.triangles.size()), 0});
        }
        ++small.groups.back().triangle_count;
        small.triangles.push_back(triangle);
    }
    return small;
}

std::string table_row(const std::vector<std::string>& cells) {
    std::string row = "|";
    for (const std::string& cell : cells) row += " " + cell + " |";
    return row + "\n";
}

}  // namespace

Hit Reproduction::in_large(Hit hit) const {
    if (!names_triangle(scene, hit)) return hit;
    hit.prim_id = prim_ids[scene.instances[hit.inst_id].object][hit.prim_id];
    hit.inst_id = instances[hit.inst_id];
    return hit;
}

Reproduction make_reproduction(const Scene& scene, const Explanation& explanation) {
    const Selection selection = select(scene, explanation);
    Reproduction result;
    result.ray = explanation.ray;
    result.scene.name = scene.name;
    result.scene.lights = scene.lights;
    result.scene.cameras = scene.cameras;
    result.scene.background = scene.background;
    result.scene.ambient = scene.ambient;

    // Objects.
    std::map<uint32_t, uint32_t> object_of;
    std::vector<std::vector<uint32_t>> groups;
    for (const auto& [object, prim_ids] : selection.prim_ids) {
        object_of[object] = static_cast<uint32_t>(result.scene.objects.size());
        groups.emplace_back();
        result.scene.objects.push_back(smaller(scene.objects[object], prim_ids, groups.back()));
        result.prim_ids.emplace_back(prim_ids.begin(), prim_ids.end());
    }

    // Instances, with the materials that are left.
    std::map<uint32_t, uint32_t> material_of;
    for (const uint32_t inst_id : selection.instances) {
        Instance instance = scene.instances[inst_id];
        const std::vector<uint32_t> materials = instance.materials;
        instance.object = object_of[instance.object];
        instance.materials.clear();
        for (const uint32_t group : groups[instance.object]) {
            const auto next = static_cast<uint32_t>(result.scene.materials.size());
            const auto [known, is_new] = material_of.try_emplace(materials[group], next);
            if (is_new) result.scene.materials.push_back(scene.materials[materials[group]]);
            instance.materials.push_back(known->second);
        }
        result.scene.instances.push_back(std::move(instance));
        result.instances.push_back(inst_id);
    }
    validate(result.scene);
    return result;
}

std::vector<Recurrence> compare_statements(const Reproduction& reproduction,
                                           const Explanation& large, const Explanation& small) {
    ONEPASS_CHECK_EQ(large.statements.size(), small.statements.size());
    std::vector<Recurrence> recurrences;
    for (size_t i = 0; i < large.statements.size(); ++i) {
        Recurrence r;
        r.large = large.statements[i];
        r.small = small.statements[i];
        r.tracer = r.large.tracer;
        r.same_class = r.large.verdict.hit_class == r.small.verdict.hit_class;
        const Hit moved = reproduction.in_large(r.small.hit);
        r.same_answer =
            moved.inst_id == r.large.hit.inst_id && moved.prim_id == r.large.hit.prim_id;
        recurrences.push_back(std::move(r));
    }
    return recurrences;
}

std::string recurrence_text(const std::vector<Recurrence>& recurrences) {
    size_t width = 0;
    for (const Recurrence& r : recurrences) width = std::max(width, r.tracer.size());
    std::string text;
    for (const Recurrence& r : recurrences) {
        text += fmt::format("  {:<{}}  reproduces: {}", r.tracer, width, r.holds() ? "yes" : "no");
        text += fmt::format(", {}", to_string(r.small.verdict.hit_class));
        if (!r.same_class) {
            text += fmt::format(" instead of {}", to_string(r.large.verdict.hit_class));
        } else if (!r.same_answer) {
            text += ", by another triangle";
        }
        text += "\n";
    }
    return text;
}

void write_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
    write_gltf(reproduction.scene, folder / "scene.glb");
    write_rays_npy(folder / "ray.npy", std::span(&reproduction.ray, 1));
}

std::string reproduction_readme(const Reproduction& reproduction, const Explanation& small,
                                const std::vector<Recurrence>& recurrences, const Notes& notes) {
    // How to run it.
    const Ray& ray = reproduction.ray;
    std::string text = fmt::format(
        "# One ray\n\n{}\n\n`scene.glb` holds the {} triangles around the ray, with the vertices "
        "and matrices of the whole\nscene bit by bit; `ray.npy` the ray (float32, 1 x 8: org, "
        "tmin, dir, tmax). Again:\n\n    onepass explain scene.glb --ray ray.npy{}\n\n",
        notes.found_in, instanced_triangle_count(reproduction.scene), notes.options);
    text += fmt::format(
        "{}\n\n## The ray\n\n    {}\n    org {:a} {:a} {:a}\n    dir {:a} {:a} "
        "{:a}\n    t   [{}, {}]\n\n",
        notes.program, ray_text(ray), ray.org.x, ray.org.y, ray.org.z, ray.dir.x, ray.dir.y,
        ray.dir.z, ray.tmin, ray.tmax);

    // What is right.
    text += fmt::format("## The exact answer\n\nBy {}. Right answers:\n\n", small.judge);
    text += table_row({"t", "instance", "triangle", "u", "v"}) + "|---|---|---|---|---|\n";
    for (const Meeting& m : small.truth.hits) {
        if (!m.is_right) continue;
        text += table_row({m.t_digits, fmt::format("{}", m.inst_id), fmt::format("{}", m.prim_id),
                           fmt::format("{}", m.u), fmt::format("{}", m.v)});
    }
    if (small.truth.miss_is_right) text += table_row({"miss", "", "", "", ""});

    // What was said.
    text +=
        "\n## The tracers\n\nHere, and in the whole scene; triangles by their numbers here.\n\n";
    text += table_row({"tracer", "answer", "class", "class in the whole scene", "reproduces"}) +
            "|---|---|---|---|---|\n";
    for (const Recurrence& r : recurrences) {
        text += table_row(
            {r.tracer, answer_text(r.small.hit), std::string(to_string(r.small.verdict.hit_class)),
             std::string(to_string(r.large.verdict.hit_class)), r.holds() ? "yes" : "no"});
    }

    // Where it comes from.
    text += "\n## Numbers in the whole scene\n\n";
    text += table_row({"instance here", "there"}) + "|---|---|\n";
    for (size_t i = 0; i < reproduction.instances.size(); ++i) {
        text += table_row({fmt::format("{}", i), fmt::format("{}", reproduction.instances[i])});
    }
    for (size_t k = 0; k < reproduction.prim_ids.size(); ++k) {
        const auto user =
            std::find_if(reproduction.scene.instances.begin(), reproduction.scene.instances.end(),
                         [&](const Instance& i) { return i.object == k; });
        text += fmt::format("\nTriangles of the object of instance {}:\n\n",
                            user - reproduction.scene.instances.begin());
        text += table_row({"triangle here", "there"}) + "|---|---|\n";
        for (size_t i = 0; i < reproduction.prim_ids[k].size(); ++i) {
            text +=
                table_row({fmt::format("{}", i), fmt::format("{}", reproduction.prim_ids[k][i])});
        }
    }
    return text;
}

}  // namespace onepass
