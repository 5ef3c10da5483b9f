// The maps from the world to the frames of the instances' objects: rays are brought there in
// doubles.
#pragma once
#include "lib/local_ray.glsl"
#include "shared/grid_buffers_layout.h"

// Made anew when instances move (pack/top_level_update.h).
BUFFER(instance_rows)

// The ray in the frame of the instance's object. The place of the instance is taken off first,
// which is exact in doubles but for the smallest parts of far places, so that neither a large
// translation nor a cancelling rotation loses any.
#if NEEDS(has_linear_maps)
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec4 y = FETCHBUFFER(instance_rows, at + 1);
    vec4 z = FETCHBUFFER(instance_rows, at + 2);
    vec4 x_rest = FETCHBUFFER(instance_rows, at + 3);
    vec4 y_rest = FETCHBUFFER(instance_rows, at + 4);
    vec4 z_rest = FETCHBUFFER(instance_rows, at + 5);
    dvec3 row_x = dvec3(vec3(x)) + dvec3(vec3(x_rest));
    dvec3 row_y = dvec3(vec3(y)) + dvec3(vec3(y_rest));
    dvec3 row_z = dvec3(vec3(z)) + dvec3(vec3(z_rest));
    dvec3 from = dvec3(ray.org) - dvec3(vec3(x.w, y.w, z.w));
    dvec3 dir = dvec3(ray.dir);
    dvec3 origin = dvec3(vec3(x_rest.w, y_rest.w, z_rest.w));
    return LocalRay(
        dvec3(sharp_dot(row_x, from), sharp_dot(row_y, from), sharp_dot(row_z, from)) - origin,
        dvec3(sharp_dot(row_x, dir), sharp_dot(row_y, dir), sharp_dot(row_z, dir)));
}
#else
// Where no instance is turned or scaled, M is a power of two.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec3 place =
        vec3(x.w, FETCHBUFFER(instance_rows, at + 1).w, FETCHBUFFER(instance_rows, at + 2).w);
    vec3 origin = vec3(FETCHBUFFER(instance_rows, at + 3).w, FETCHBUFFER(instance_rows, at + 4).w,
                       FETCHBUFFER(instance_rows, at + 5).w);
    double scale = double(x.x);
    return LocalRay((dvec3(ray.org) - dvec3(place)) * scale - dvec3(origin),
                    dvec3(ray.dir) * scale);
}
#endif
