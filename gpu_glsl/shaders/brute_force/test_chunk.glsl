// Brute force: a ray against every triangle of every instance, a chunk of them in each pass. What a
// structure is to be compared with; the paper says that one gains a factor over 100.
//
// A software renderer may end all loops of an invocation after 65,535 turns, and a GPU does not
// like to be kept for seconds, so that the hit so far travels from pass to pass.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"
#include "lib/paper/triangle.glsl"

CONSTANT(int, instance_count)
UNIFORM(int, first_instance)  // where this chunk begins
UNIFORM(int, first_test)      // triangles of that instance that are done
UNIFORM(int, chunk_tests)

void test_chunk(Ray ray, INOUT(Hit) hit) {
    int left = chunk_tests;
    int begin = first_test;
    for (int i = first_instance; i < instance_count && left > 0; ++i) {
        ListedInstance instance = fetch_listed_instance(i);
        vec3 org = vec3(plane_at(instance.row0, ray.org), plane_at(instance.row1, ray.org),
                        plane_at(instance.row2, ray.org));
        vec3 dir = vec3(plane_along(instance.row0, ray.dir), plane_along(instance.row1, ray.dir),
                        plane_along(instance.row2, ray.dir));
        int end = min(instance.triangle_count, begin + left);
        int k = begin;
        for (; k < end; ++k) {
            intersect_triangle(instance.first_triangle + k, org, dir, ray.tmin, ray.tmax, uint(i),
                               instance.first_triangle, hit);
        }
        left -= k - begin;
        if (k < end) break;  // the driver ended the loop: `left` stays above 0
        begin = 0;
    }
    if (left > 0) ray_flags |= kFlagExhausted;
}
