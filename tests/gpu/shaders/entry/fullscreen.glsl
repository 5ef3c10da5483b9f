// The corners of the viewport, as the shaders' entry of that name has them.
void main() {
    gl_Position = vec4(2 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID >> 1) - 1, 0.0, 1.0);
}
