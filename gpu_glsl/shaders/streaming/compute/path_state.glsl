// Compute form: the path, which shade owns.
#pragma once
#include "streaming/compute/state.glsl"
#include "streaming/path.glsl"

layout(std430) buffer PathBuffer { vec4 path_texels[]; };
layout(std430) buffer PathIdBuffer { uvec4 path_ids[]; };

vec4 load_path_texel(uint control, int index) { return path_texels[ray_index + index * ray_count]; }
uvec4 load_path_ids(uint control) { return path_ids[ray_index]; }

PathTexels load_path() {
    return PathTexels(
        path_texels[ray_index], path_texels[ray_index + ray_count],
        path_texels[ray_index + 2 * ray_count], path_texels[ray_index + 3 * ray_count],
        path_texels[ray_index + 4 * ray_count], path_texels[ray_index + 5 * ray_count],
        path_ids[ray_index]);
}
void store_path(PathTexels texels) {
    path_texels[ray_index] = texels.a;
    path_texels[ray_index + ray_count] = texels.b;
    path_texels[ray_index + 2 * ray_count] = texels.c;
    path_texels[ray_index + 3 * ray_count] = texels.d;
    path_texels[ray_index + 4 * ray_count] = texels.e;
    path_texels[ray_index + 5 * ray_count] = texels.f;
    path_ids[ray_index] = texels.ids;
}
