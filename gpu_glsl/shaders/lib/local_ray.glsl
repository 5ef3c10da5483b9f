// Rays in the frame of what they are traced through, in doubles.
#pragma once
#include "lib/bits.glsl"
#include "lib/math.glsl"
#include "lib/ray.glsl"

// t means the same in all frames.
struct LocalRay {
    dvec3 org;
    dvec3 dir;
};

// The ray from t = start on.
LocalRay moved(LocalRay ray, float start) {
    dvec3 org = ray.org + ray.dir * double(start);
    return LocalRay(org, ray.dir);
}

// For decisions a ray from afar is moved to t = start, where it enters what it is traced through:
// doubles hold some 2^-53 of its way, and what moving loses is lost for all triangles alike. One
// from close by is taken as it is, and `start` becomes 0.
bool is_from_afar(LocalRay ray) {
    const float kNear = 16.0;  // in sizes of the object
    return !(largest(abs(vec3(ray.org))) <= kNear);
}

LocalRay moved_from_afar(LocalRay ray, INOUT(float) start) {
    if (!is_from_afar(ray)) start = 0.0;
    return moved(ray, start);
}

double sharp_dot(dvec3 a, dvec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// 1 / x to 2^-52 of it, without a division of doubles, for which GPUs have no unit: two of Newton's
// steps from the float's.
double inverse_of(double x) {
    double scale = inverse_of_power(power_of_two_above(abs(x)));
    double near_one = x * scale;
    double about = double(1.0 / float(near_one));
    about = about * (double(2.0) - near_one * about);
    return (about * (double(2.0) - near_one * about)) * scale;
}

// The power of two by which the ray's direction is longer than one whose largest component is 1/2
// to 1.
double length_scale(LocalRay ray) {
    dvec3 size = abs(ray.dir);
    double largest_size = size.x > size.y ? size.x : size.y;
    return power_of_two_above(largest_size > size.z ? largest_size : size.z);
}
