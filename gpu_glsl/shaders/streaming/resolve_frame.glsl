// Kernel: from the state of finished pixels to the image. Runs once, after all others.
#include "streaming/path.glsl"

void main() {
    if (!open_state()) return;
    uint control = load_control();
    vec4 t_texel = load_path_texel(control, 3);
    vec4 u_texel = load_path_texel(control, 4);
    vec4 v_texel = load_path_texel(control, 5);
    uvec4 ids = load_path_ids(control);
    Hit primary = Hit(t_texel.w, u_texel.w, v_texel.w, ids.z, ids.w);

    vec3 normal = vec3(0.0);
    if (is_hit(primary)) {
        Ray ray = primary_ray(pixel_of_ray());
        normal = surface_point(ray.dir, primary).shading_normal;
    }
    uvec4 traverse_work = load_walk_work(control);
    uvec4 intersect_work = load_hit_work(control);
    store_pixel(v_texel.xyz, primary, (control & kOutOfBudget) != 0u ? kFlagExhausted : 0u, normal,
                uvec4(traverse_work.x, intersect_work.x, traverse_work.y + intersect_work.y,
                      traverse_work.z),
                traverse_work.w + intersect_work.z);
}
