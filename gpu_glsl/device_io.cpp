#include "gpu_glsl/device_io.h"

namespace onepass {
namespace {

/// Width of the textures that rays and hits lie in: tiles of 8 x 4 texels, and in them parts of
/// 4 x 2. Fragments next to each other run together (8 on a CPU, those of a part; on a GPU those of
/// a tile, more or less), so rays that follow each other lie in a tile, and 8 of them in a part.
constexpr uint32_t kRayTextureWidth = 1024;
constexpr size_t kTileRays = 32;
constexpr size_t kPartRays = 8;
constexpr size_t kTilesARow = kRayTextureWidth / 8;

/// The texel where a ray lies, and its hit.
size_t texel_of_ray(size_t ray) {
    const size_t tile = ray / kTileRays;
    const size_t part = ray % kTileRays / kPartRays;
    const size_t lane = ray % kPartRays;
    const size_t x = 8 * (tile % kTilesARow) + 4 * (part % 2) + lane % 4;
    const size_t y = 4 * (tile / kTilesARow) + 2 * (part / 2) + lane / 4;
    return x + kRayTextureWidth * y;
}

/// A ray that no structure answers: it ends before it begins. Fills the last row of a chunk.
constexpr Ray kPaddingRay{.org = vec3(0.0f), .tmin = 0.0f, .dir = vec3(0, 0, 1), .tmax = -1.0f};

Hit make_hit(const float* t_u_v, const uint32_t* ids) {
    return {t_u_v[0], t_u_v[1], t_u_v[2], ids[0], ids[1]};
}

RayCounters make_counters(const uint32_t* c) { return {c[0], c[1], c[2], c[3]}; }

gl::Texture upload_buffer(const TextureData& buffer) {
    const gl::BufferUse use = buffer.is_block ? gl::BufferUse::block : gl::BufferUse::texture;
    if (buffer.format == ChannelFormat::single) {
        return gl::texture_buffer(buffer.name, gl::TexelFormat::rgba32f, buffer.texels, use);
    }
    const gl::TexelFormat format = buffer.channels == 1   ? gl::TexelFormat::r32ui
                                   : buffer.channels == 2 ? gl::TexelFormat::rg32ui
                                                          : gl::TexelFormat::rgba32ui;
    return gl::texture_buffer(buffer.name, format, buffer.words, use);
}

}  // namespace

gl::TexelFormat texel_format(const TextureData& texture) {
    const bool half = texture.format == ChannelFormat::half;
    switch (texture.channels) {
        case 1:
            return half ? gl::TexelFormat::r16f : gl::TexelFormat::r32f;
        case 2:
            return half ? gl::TexelFormat::rg16f : gl::TexelFormat::rg32f;
        default:
            return half ? gl::TexelFormat::rgba16f : gl::TexelFormat::rgba32f;
    }
}

gl::Texture upload_texture(const TextureData& texture) {
    if (texture.dimensions == 1) return upload_buffer(texture);
    if (texture.dimensions == 3) {
        return gl::texture_3d(texture.name, texel_format(texture), texture.size, texture.texels);
    }
    return gl::texture_2d(texture.name, texel_format(texture), texture.size.x, texture.size.y,
                          texture.texels);
}

ChunkOnDevice upload_to_textures(std::span<const Ray> rays) {
    ChunkOnDevice chunk;
    chunk.count = rays.size();
    chunk.width = kRayTextureWidth;
    constexpr size_t kRowRays = kTileRays * kTilesARow;
    chunk.height = static_cast<uint32_t>(4 * ((rays.size() + kRowRays - 1) / kRowRays));
    const size_t texels = size_t{chunk.width} * chunk.height;
    std::vector<vec4> origins(texels, vec4(kPaddingRay.org, kPaddingRay.tmin));
    std::vector<vec4> directions(texels, vec4(kPaddingRay.dir, kPaddingRay.tmax));
    for (size_t i = 0; i < rays.size(); ++i) {
        const size_t at = texel_of_ray(i);
        origins[at] = vec4(rays[i].org, rays[i].tmin);
        directions[at] = vec4(rays[i].dir, rays[i].tmax);
    }
    chunk.origins =
        gl::texture_2d("ray_origins", gl::TexelFormat::rgba32f, chunk.width, chunk.height, origins);
    chunk.directions = gl::texture_2d("ray_directions", gl::TexelFormat::rgba32f, chunk.width,
                                      chunk.height, directions);
    return chunk;
}

ChunkOnDevice upload_to_buffer(std::span<const Ray> rays) {
    ChunkOnDevice chunk;
    chunk.count = rays.size();
    chunk.buffer = gl::Buffer::of("rays", rays);
    return chunk;
}

uint64_t append_hits(const gl::Framebuffer& answers, size_t count, bool counters,
                     CastResult& result) {
    const std::vector<float> hits = gl::read_floats(answers.target(0));
    const std::vector<uint32_t> ids = gl::read_uints(answers.target(1));
    uint64_t sum = 0;
    for (size_t i = 0; i < count; ++i) {
        const size_t at = 4 * texel_of_ray(i);
        result.hits.push_back(make_hit(&hits[at], &ids[at]));
        result.flags.push_back(ids[at + 2]);
        sum += ids[at + 3];
    }
    if (!counters) return sum;
    const std::vector<uint32_t> counts = gl::read_uints(answers.target(2));
    for (size_t i = 0; i < count; ++i) {
        result.counters.push_back(make_counters(&counts[4 * texel_of_ray(i)]));
    }
    return sum;
}

uint64_t append_hits(const gl::Buffer& answers, size_t count, bool counters, CastResult& result) {
    uint64_t sum = 0;
    const std::vector<HitRecord> records = answers.read<HitRecord>();
    for (const HitRecord& record : std::span(records).first(count)) {
        result.hits.push_back(make_hit(&record.hit.x, &record.ids.x));
        result.flags.push_back(record.ids.z);
        sum += record.ids.w;
        if (counters) result.counters.push_back(make_counters(&record.counters.x));
    }
    return sum;
}

uint64_t append_pixels(const gl::Framebuffer& pixels, bool aovs, Frame& frame) {
    const size_t count = size_t{pixels.width()} * pixels.height();
    const std::vector<float> color = gl::read_floats(pixels.target(0));
    frame.color.reserve(frame.color.size() + count);
    for (size_t i = 0; i < count; ++i) {
        frame.color.push_back(vec3(color[4 * i], color[4 * i + 1], color[4 * i + 2]));
    }
    if (!aovs) return 0;
    const std::vector<float> hits = gl::read_floats(pixels.target(1));
    const std::vector<uint32_t> ids = gl::read_uints(pixels.target(2));
    const std::vector<float> normals = gl::read_floats(pixels.target(3));
    const std::vector<uint32_t> counters = gl::read_uints(pixels.target(4));
    uint64_t sum = 0;
    for (size_t i = 0; i < count; ++i) {
        frame.hits.push_back(make_hit(&hits[4 * i], &ids[4 * i]));
        frame.flags.push_back(ids[4 * i + 2]);
        sum += ids[4 * i + 3];
        frame.normals.push_back(vec3(normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]));
        frame.counters.push_back(make_counters(&counters[4 * i]));
    }
    return sum;
}

uint64_t append_pixels(const gl::Buffer& pixels, size_t count, bool aovs, Frame& frame) {
    uint64_t sum = 0;
    frame.color.reserve(frame.color.size() + count);
    const std::vector<PixelRecord> records = pixels.read<PixelRecord>();
    for (const PixelRecord& record : std::span(records).first(count)) {
        frame.color.push_back(vec3(record.color));
        if (!aovs) continue;
        frame.hits.push_back(make_hit(&record.hit.x, &record.ids.x));
        frame.flags.push_back(record.ids.z);
        sum += record.ids.w;
        frame.normals.push_back(vec3(record.normal));
        frame.counters.push_back(make_counters(&record.counters.x));
    }
    return sum;
}

}  // namespace onepass
