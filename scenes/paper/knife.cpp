// knife: a kitchen knife in one mesh: handle S(25,24) and blade K(66). Lengths in decimetres; it
// points along +z, its edge down.
#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

Object make_handle() {
    // at, half width, bottom, waist, top, exponent
    const Section keys[] = {
        {-1.28f, 0, 0, -0.02f, 0, 2},
        {-1.28f, 0.06f, -0.14f, -0.02f, 0.07f, 2.5f},
        {-1.2f, 0.115f, -0.2f, -0.02f, 0.12f, 2.5f},
        {-1.0f, 0.11f, -0.15f, 0, 0.15f, 2.5f},
        {-0.6f, 0.13f, -0.17f, 0, 0.15f, 2.5f},
        {-0.3f, 0.1f, -0.11f, 0, 0.13f, 2.5f},
        {-0.14f, 0.1f, -0.12f, 0, 0.14f, 2.5f},
        {-0.13f, 0.115f, -0.14f, 0, 0.155f, 2.5f},
        {0.02f, 0.09f, -0.17f, 0, 0.165f, 2.5f},
        {0.02f, 0, 0, 0, 0, 2.5f},
    };
    Object handle = lofted(keys, 25, 24);
    set_groups(handle, {"grip", "bolster"}, [](const vec3& c) { return c.z > -0.137f ? 1u : 0u; });
    set_normals(handle, 30);
    return handle;
}

Object make_knife_blade() {
    // at, half width, edge, bevel, spine
    const Section keys[] = {
        {0, 0.014f, -0.13f, 0.02f, 0.145f},       {0.07f, 0.014f, -0.13f, 0.02f, 0.145f},
        {0.11f, 0.034f, -0.36f, 0.02f, 0.145f},   {0.7f, 0.031f, -0.36f, 0.02f, 0.15f},
        {1.4f, 0.026f, -0.31f, 0.01f, 0.12f},     {1.9f, 0.018f, -0.2f, -0.02f, 0.06f},
        {2.2f, 0.008f, -0.09f, -0.035f, -0.005f}, {2.28f, 0, -0.05f, -0.05f, -0.05f},
    };
    Object blade = bladed(keys, 66);
    set_normals(blade, 4);
    return blade;
}

}  // namespace

Scene make_knife() {
    Scene scene;
    scene.name = "knife";
    scene.background = vec3(0.07f, 0.1f, 0.14f);
    scene.ambient = vec3(0.22f);
    const uint32_t grip =
        add_material(scene, glossy("grip", vec3(0.055f, 0.024f, 0.013f), 35, 0.3f));
    const uint32_t steel = add_material(scene, {.name = "steel",
                                                .diffuse = vec3(0.42f, 0.44f, 0.47f),
                                                .specular = vec3(0.9f),
                                                .shininess = 18.0f,
                                                .reflectivity = 0.4f});

    Object knife;
    append_shape(knife, make_handle(), affine_identity());
    append_shape(knife, make_knife_blade(), affine_identity(), "blade");
    add_instance(scene, "knife", add_object(scene, "knife", std::move(knife)),
                 rotation(vec3(1, 0, 0), -24), {grip, steel, steel});

    scene.lights = {light("lamp", vec3(3.0f, 0.7f, 1.7f), vec3(1.1f))};
    scene.cameras = {camera(vec3(4.8f, 1.1f, 1.4f), vec3(0, 0.2f, 0.55f))};
    return scene;
}

}  // namespace onepass
