// Shading tables in 2D textures: what a final hit's normal and material are looked up from.
//
// Attributes are fetched once a hit is final (paper, section 4), so nothing here is in the way of
// the traversal. Records are addressed by integers: row-major, and a record never crosses a row.
#pragma once
#include "lib/dialect.glsl"
#include "shared/shading_layout.h"

TEXTURE2D(triangle_normals)
TEXTURE2D(shading_instances)
TEXTURE2D(materials)
TEXTURE2D(lights)
CONSTANT(bool, smooth_normals)

struct Material {
    vec3 diffuse;
    vec3 specular;
    float shininess;
    float reflectivity;
};

struct Light {
    vec3 position;
    vec3 intensity;
};

struct ShadingInstance {
    vec3 row0;  // of object_from_world, linear part
    vec3 row1;
    vec3 row2;
    int first_triangle;
    int first_material;
};

struct TriangleNormals {
    vec3 geometric;
    vec3 n0;
    vec3 n1;
    vec3 n2;
    int group;
};

// The texel where record `index` begins, in a texture `width` texels wide.
ivec2 record_texel(int index, int texels, int width) {
    int per_row = width / texels;
    return ivec2((index % per_row) * texels, index / per_row);
}

ShadingInstance fetch_shading_instance(uint inst_id) {
    ivec2 at = record_texel(int(inst_id), kShadingInstanceTexels, SIZE2D(shading_instances).x);
    vec4 bases = FETCH2D(shading_instances, at + ivec2(3, 0));
    return ShadingInstance(vec3(FETCH2D(shading_instances, at)),
                           vec3(FETCH2D(shading_instances, at + ivec2(1, 0))),
                           vec3(FETCH2D(shading_instances, at + ivec2(2, 0))), int(bases.x),
                           int(bases.y));
}

TriangleNormals fetch_normals(int triangle) {
    int texels = smooth_normals ? kSmoothNormalTexels : kFlatNormalTexels;
    ivec2 at = record_texel(triangle, texels, SIZE2D(triangle_normals).x);
    vec4 first = FETCH2D(triangle_normals, at);
    TriangleNormals normals =
        TriangleNormals(vec3(first), vec3(first), vec3(first), vec3(first), int(first.w));
    if (smooth_normals) {
        normals.n0 = vec3(FETCH2D(triangle_normals, at + ivec2(1, 0)));
        normals.n1 = vec3(FETCH2D(triangle_normals, at + ivec2(2, 0)));
        normals.n2 = vec3(FETCH2D(triangle_normals, at + ivec2(3, 0)));
    }
    return normals;
}

Material fetch_material(int index) {
    ivec2 at = record_texel(index, kMaterialTexels, SIZE2D(materials).x);
    vec4 first = FETCH2D(materials, at);
    vec4 second = FETCH2D(materials, at + ivec2(1, 0));
    return Material(vec3(first), vec3(second), second.w, first.w);
}

Light fetch_light(int index) {
    ivec2 at = record_texel(index, kLightTexels, SIZE2D(lights).x);
    return Light(vec3(FETCH2D(lights, at)), vec3(FETCH2D(lights, at + ivec2(1, 0))));
}
