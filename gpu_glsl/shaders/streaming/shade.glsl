// Kernel: takes the answer to a ray and makes the pixel's next ray, or ends the pixel.
#include "streaming/path.glsl"

void shade(Hit hit, INOUT(PathState) s, INOUT(uint) control) {
    // The path again, as the single pass would have it in its registers.
    Ray ray = Ray(s.org, 0.0, s.dir, path_tmax(light_of(control)));
    Path path = begin_path();
    path.light = light_of(control);
    path.depth = depth_of(control);
    path.weight = s.weight;
    path.direct = s.direct;
    path.pixel.color = s.color;
    path.pixel.primary = s.primary;
    if (path.light == kSurfaceRay) {
        s.seen_along = ray.dir;
        s.surface = hit;
    } else {
        path.point = surface_point(s.seen_along, s.surface);
        path.point.origin = ray.org;  // the shadow ray in flight starts there
        path.contribution = phong(path.point, fetch_light(path.light));
    }

    bool goes_on = next_ray(path, hit, ray);

    s.org = ray.org;
    s.dir = ray.dir;
    s.weight = path.weight;
    s.direct = path.direct;
    s.color = path.pixel.color;
    s.primary = path.pixel.primary;
    control = goes_on ? with_new_ray(control, path.light, path.depth)
                      : with_turn(control, kTurnNone);
}

void main() {
    bool has_ray = open_state();
    uint control = kTurnNone;
    if (has_ray) {
        control = load_control();
        Hit hit = load_hit(control);
        PathState path = unpack_path(load_path());
        if (copy_only) {
            control |= touched(hit);
        } else {
            shade(hit, path, control);
        }
        store_path(pack_path(path));
        store_control(control);
    }
    close_state(has_ray, turn_of(control));
}
