// Loads buffer textures as images.
layout(local_size_x = 1) in;

layout(r32ui) readonly uniform uimageBuffer words;
layout(rgba32f) readonly uniform imageBuffer vectors;
layout(std430) writeonly buffer Sums { vec4 sums[]; };

void main() {
    int i = int(gl_GlobalInvocationID.x);
    sums[i] = imageLoad(vectors, i) + float(imageLoad(words, i).x);
}
