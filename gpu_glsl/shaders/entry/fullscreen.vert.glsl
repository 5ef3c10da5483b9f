// Entry: the corners of the viewport, from no vertex data: three make a triangle that is half of
// it, four a strip of two (gl/objects.cpp: draw_over).
void main() {
    ivec2 corner = ivec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(vec2(2 * corner - 1), 0.0, 1.0);
}
