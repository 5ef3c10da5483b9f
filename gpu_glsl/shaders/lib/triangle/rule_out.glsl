// Which triangles a ray may hit, in floats: the test of Woop, Benthin & Wald (2013), made one that
// never says no where rounding leaves it open.
//
// Seen along the ray, a triangle is three points of a plane, and three edge functions say whether
// the ray's own point, the origin of that plane, is inside. A triangle is ruled out only if they
// differ in sign by more than they can be wrong, and surely hit only if they agree by more than
// that. Between the two, lib/triangle/decide.glsl decides in doubles.
//
// Coordinates are those of a frame in which the triangles' are at most 1, and the ray's origin is not
// much more: errors are absolute numbers there. u = half_ulp() throughout.
#pragma once
#include "lib/bits.glsl"
#include "lib/math.glsl"
#include "lib/ray.glsl"

// A ray in the frame of what it is traced through. t means the same in all frames.
struct LocalRay {
    dvec3 org;
    dvec3 dir;
};

// The ray from t = start on.
LocalRay moved(LocalRay ray, float start) {
    PRECISE dvec3 org = ray.org + ray.dir * double(start);
    return LocalRay(org, ray.dir);
}

// For decisions a ray from afar is moved to t = start, where it enters what it is traced through:
// doubles hold some 2^-53 of its way, and what moving loses is lost for all triangles alike. One
// from close by is taken as it is, and `start` becomes 0.
LocalRay moved_from_afar(LocalRay ray, INOUT(float) start) {
    const float kNear = 16.0;  // in sizes of the object
    if (largest(abs(vec3(ray.org))) <= kNear) start = 0.0;
    return moved(ray, start);
}

double sharp_dot(dvec3 a, dvec3 b) {
    PRECISE double d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
}

// A ray made ready for testing triangles. Seen along it, a point p is at
// x = dot(right, p) - origin.x, y = dot(up, p) - origin.y, and at t = dot(along, p) - origin.z.
struct Sight {
    vec3 right;
    vec3 up;
    vec3 along;
    vec3 origin;
    float doubt;    // 16 u of the unit of length, or of the ray's origin if that is farther away
    float t_error;  // of a corner's t
};

int largest_axis(vec3 v) {
    vec3 size = abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
}

// side / ahead to half an ulp, of doubles: drivers' divisions of floats are coarser.
float slope(double side, double ahead, float inverse) {
    float about = float(side) * inverse;
    return about + float(side - double(about) * ahead) * inverse;
}

// The direction's largest component points ahead; right and up are sheared, not turned, so that
// they are made of a 1, a 0 and a slope of at most 1.
Sight sight_along(LocalRay ray) {
    vec3 dir = vec3(ray.dir);
    int axis = largest_axis(dir);
    Sight sight;
    float t_per_length;
    if (axis == 0) {
        t_per_length = 1.0 / dir.x;
        sight.right = vec3(-slope(ray.dir.y, ray.dir.x, t_per_length), 1.0, 0.0);
        sight.up = vec3(-slope(ray.dir.z, ray.dir.x, t_per_length), 0.0, 1.0);
        sight.along = vec3(t_per_length, 0.0, 0.0);
    } else if (axis == 1) {
        t_per_length = 1.0 / dir.y;
        sight.right = vec3(0.0, -slope(ray.dir.z, ray.dir.y, t_per_length), 1.0);
        sight.up = vec3(1.0, -slope(ray.dir.x, ray.dir.y, t_per_length), 0.0);
        sight.along = vec3(0.0, t_per_length, 0.0);
    } else {
        t_per_length = 1.0 / dir.z;
        sight.right = vec3(1.0, 0.0, -slope(ray.dir.x, ray.dir.z, t_per_length));
        sight.up = vec3(0.0, 1.0, -slope(ray.dir.y, ray.dir.z, t_per_length));
        sight.along = vec3(0.0, 0.0, t_per_length);
    }
    sight.origin = vec3(float(sharp_dot(dvec3(sight.right), ray.org)),
                        float(sharp_dot(dvec3(sight.up), ray.org)),
                        float(sharp_dot(dvec3(sight.along), ray.org)));
    float reach = greater(1.0, largest(abs(vec3(ray.org))));
    sight.doubt = (16.0 * half_ulp()) * reach;
    sight.t_error = (2.5 * sight.doubt) * abs(t_per_length);
    return sight;
}

struct Triangle {
    vec3 v0;
    vec3 v1;
    vec3 v2;
};

// Where a ray crosses a triangle: t, from the ray's origin on.
struct Crossing {
    float from;    // it is at least this ...
    float to;      // ... and at most this
    bool is_sure;  // false if it may be nowhere
};

// False if the ray misses the triangle.
//
// The bounds. A coordinate x = right . p - origin.x is a product, a sum of two numbers of at most 1
// and a difference of two of at most 2; with the rounded slope and origin it is wrong by at most
// 8 u. So is y; an edge function is by that times the four coordinates in it, by 2 (8 u)^2, and by
// its own three roundings: with `size` the sum of all |x| and |y|, less than 16 u (size + 16 u) in
// all. If all three are larger than 3 times that, so is the area, and t, the mean of the corners'
// t weighted by them, is wrong by their error's share of the area times the depth of the triangle,
// and by 40 u of the unit of length for the corners' own t and the arithmetic. If in doubt, t is
// within the triangle. An origin beyond 1 raises all errors alike.
bool may_cross(Triangle triangle, Sight sight, OUT(Crossing) crossing) {
    count_test();
    crossing = Crossing(infinity(), infinity(), false);
    float ax = dot3(sight.right, triangle.v0) - sight.origin.x;
    float ay = dot3(sight.up, triangle.v0) - sight.origin.y;
    float bx = dot3(sight.right, triangle.v1) - sight.origin.x;
    float by = dot3(sight.up, triangle.v1) - sight.origin.y;
    float cx = dot3(sight.right, triangle.v2) - sight.origin.x;
    float cy = dot3(sight.up, triangle.v2) - sight.origin.y;
    // Twice the areas that the ray's point makes with each edge.
    float w0 = cx * by - cy * bx;
    float w1 = ax * cy - ay * cx;
    float w2 = bx * ay - by * ax;
    float size = ((abs(ax) + abs(ay)) + (abs(bx) + abs(by))) + (abs(cx) + abs(cy));
    float doubt = sight.doubt * (size + sight.doubt);
    float least = lesser(w0, lesser(w1, w2));
    float most = greater(w0, greater(w1, w2));
    if (least < -doubt && most > doubt) return false;

    float at = dot3(sight.along, triangle.v0) - sight.origin.z;
    float bt = dot3(sight.along, triangle.v1) - sight.origin.z;
    float ct = dot3(sight.along, triangle.v2) - sight.origin.z;
    float near = lesser(at, lesser(bt, ct));
    float far = greater(at, greater(bt, ct));
    float error = sight.t_error;
    crossing.is_sure = least > doubt || most < -doubt;
    if (crossing.is_sure) {
        float share = 1.0 / (w0 + w1 + w2);
        float t = at + (w1 * share) * (bt - at) + (w2 * share) * (ct - at);
        error += lesser(3.0 * doubt * abs(share), 1.0) * (far - near);
        near = t;
        far = t;
    }
    crossing.from = near - error;
    crossing.to = far + error;
    return true;
}
