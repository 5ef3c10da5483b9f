#include "gpu_glsl/pack/shading_tables.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/shading.h"
#include "gpu_glsl/shaders/shared/shading_layout.h"

namespace onepass {
namespace {

void put(TextureData& texture, uvec2 texel, const vec3& xyz, float w) {
    float* out = texel_at(texture, texel);
    out[0] = xyz.x;
    out[1] = xyz.y;
    out[2] = xyz.z;
    out[3] = w;
}

uvec2 right(uvec2 texel, uint32_t by) { return uvec2(texel.x + by, texel.y); }

/// An index as the float that carries it: exact below 2^24.
float index_as_float(uint64_t index, const char* what) {
    constexpr uint64_t kExactBelow = 1u << 24;
    if (index >= kExactBelow) {
        throw Error(
            {"packing for the shader", fmt::format("{} number {}", what, index),
             fmt::format("numbers below {}, which a float texel holds exactly", kExactBelow),
             "Use a smaller scene."});
    }
    return static_cast<float>(index);
}

TextureData pack_normals(const Scene& scene, bool smooth, const TextureLimits& limits) {
    uint64_t triangle_count = 0;
    for (const Object& object : scene.objects) triangle_count += object.triangles.size();
    const uint32_t texels = static_cast<uint32_t>(smooth ? kSmoothNormalTexels : kFlatNormalTexels);
    TextureData texture =
        make_record_texture("triangle_normals", "triangles", triangle_count, texels, limits.max_2d);
    uint64_t record = 0;
    for (const Object& object : scene.objects) {
        for (uint32_t group = 0; group < object.groups.size(); ++group) {
            const float group_as_float = index_as_float(group, "group");
            for (uint32_t i = 0; i < object.groups[group].triangle_count; ++i, ++record) {
                const uvec3 tri = object.triangles[object.groups[group].first_triangle + i];
                const vec3 v0 = object.positions[tri.x];
                const vec3 geometric = glm::normalize(
                    glm::cross(object.positions[tri.y] - v0, object.positions[tri.z] - v0));
                const uvec2 at = record_texel(texture, record, texels);
                put(texture, at, geometric, group_as_float);
                if (!smooth) continue;
                for (uint32_t corner = 0; corner < 3; ++corner) {
                    put(texture, right(at, corner + 1),
                        object.normals.empty() ? geometric
                                               : object.normals[tri[static_cast<int>(corner)]],
                        0.0f);
                }
            }
        }
    }
    return texture;
}

}  // namespace

TextureData pack_shading_instances(const Scene& scene, std::span<const Affine> object_from_world,
                                   const TextureLimits& limits) {
    std::vector<uint64_t> first_triangle;
    uint64_t triangles = 0;
    for (const Object& object : scene.objects) {
        first_triangle.push_back(triangles);
        triangles += object.triangles.size();
    }
    std::vector<uint64_t> first_material;
    uint64_t materials = 0;
    for (const Instance& instance : scene.instances) {
        first_material.push_back(materials);
        materials += instance.materials.size();
    }

    TextureData texture =
        make_record_texture("shading_instances", "instances", scene.instances.size(),
                            kShadingInstanceTexels, limits.max_2d);
    constexpr size_t kInstancesATask = 1024;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, scene.instances.size(), kInstancesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              const Affine& m = object_from_world[i];
                              const uvec2 at = record_texel(texture, i, kShadingInstanceTexels);
                              for (int row = 0; row < 3; ++row) {
                                  put(texture, right(at, static_cast<uint32_t>(row)),
                                      vec3(m[0][row], m[1][row], m[2][row]), 0.0f);
                              }
                              const uint64_t triangle = first_triangle[scene.instances[i].object];
                              put(texture, right(at, 3),
                                  vec3(index_as_float(triangle, "triangle"),
                                       index_as_float(first_material[i], "material"), 0.0f),
                                  0.0f);
                          }
                      });
    return texture;
}

ShaderInputs pack_shading_tables(const Scene& scene, bool smooth_normals,
                                 const TextureLimits& limits) {
    ShaderInputs inputs;
    inputs.textures.push_back(pack_normals(scene, smooth_normals, limits));

    // Instances, and a material record for each of their groups.
    std::vector<Affine> object_from_world;
    uint64_t material_records = 0;
    for (const Instance& instance : scene.instances) {
        object_from_world.emplace_back(inverse(instance.world_from_object));
        material_records += instance.materials.size();
    }
    inputs.textures.push_back(pack_shading_instances(scene, object_from_world, limits));
    TextureData materials = make_record_texture("materials", "materials", material_records,
                                                kMaterialTexels, limits.max_2d);
    uint64_t material_record = 0;
    for (const Instance& instance : scene.instances) {
        for (const uint32_t index : instance.materials) {
            const Material& material = scene.materials[index];
            const uvec2 texel = record_texel(materials, material_record++, kMaterialTexels);
            put(materials, texel, material.diffuse, material.reflectivity);
            put(materials, right(texel, 1), material.specular, material.shininess);
        }
    }
    inputs.textures.push_back(std::move(materials));

    // Lights, and the scene's few numbers.
    TextureData lights =
        make_record_texture("lights", "lights", scene.lights.size(), kLightTexels, limits.max_2d);
    for (size_t i = 0; i < scene.lights.size(); ++i) {
        const uvec2 at = record_texel(lights, i, kLightTexels);
        put(lights, at, scene.lights[i].position, 0.0f);
        put(lights, right(at, 1), scene.lights[i].intensity, 0.0f);
    }
    inputs.textures.push_back(std::move(lights));
    inputs.uniforms = {{"background", scene.background},
                       {"ambient", scene.ambient},
                       {"ray_offset", secondary_offset(scene_bounds(scene))},
                       {"ray_offset_of_way", kOffsetOfWay}};
    return inputs;
}

std::vector<gl::ShaderConstant> shading_constants(const SceneNeeds& needs) {
    return {{"light_count", static_cast<int32_t>(needs.light_count)},
            {"max_depth", static_cast<int32_t>(needs.max_depth)},
            {"has_several_lights", needs.light_count > 1},
            {"has_mirrors", needs.max_depth > 0},
            {"shadows", needs.shadows},
            {"smooth_normals", needs.smooth_normals}};
}

}  // namespace onepass
