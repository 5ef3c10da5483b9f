#include "gpu_glsl/device_io.h"

#include <bit>

namespace onepass {
namespace {

/// Given rays go to fragments in blocks of 4 x 4, and those to strips
/// (shaders/lib/given_rays.glsl). A fragment has a place in that order.
constexpr size_t kBlockFragments = 16;
constexpr size_t kStripWidth = 64;
constexpr size_t kBlockRowFragments = 4 * kStripWidth;
constexpr size_t kFragmentsWide = 31 * kStripWidth;  // odd: rows begin in unlike sets of a cache
constexpr size_t kFragmentRow = 4 * kFragmentsWide;

/// A chunk is filled up to a multiple of so many rays: a row of blocks with two rays a fragment.
constexpr size_t kFullChunk = 2 * kFragmentRow;

/// Fragments that a software renderer runs together (shaders/entry/cast_fragment_pairs.glsl).
constexpr size_t kLanes = 8;

size_t fragments_in_strip(uint32_t height) { return kStripWidth * height; }

/// The texel of the fragment at a place.
size_t texel_at(size_t place, uint32_t height) {
    const size_t strip = place / fragments_in_strip(height);
    const size_t row = place % fragments_in_strip(height) / kBlockRowFragments;
    const size_t block = place % kBlockRowFragments / kBlockFragments;
    const size_t lane = place % kBlockFragments;
    const size_t x = kStripWidth * strip + 4 * block + lane % 4;
    const size_t y = 4 * row + lane / 4;
    return x + kFragmentsWide * y;
}

/// A ray that no structure answers: it ends before it begins. Fills up a chunk.
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

uvec2 ChunkOnDevice::fragments(size_t each) const {
    const size_t rows = (count + each * kFragmentRow - 1) / (each * kFragmentRow);
    return {kFragmentsWide, 4 * rows};
}

void ChunkOnDevice::give_to(gl::Program& program, size_t each) const {
    program.set_texture("given_rays", *texels);
    program.set_uniform("strip_fragments",
                        static_cast<int32_t>(fragments_in_strip(fragments(each).y)));
}

size_t most_rays_in_texels(int64_t most_texels) {
    const size_t rays = static_cast<size_t>(most_texels) / 2;
    return rays / kFullChunk * kFullChunk;
}

ChunkOnDevice upload_to_texels(std::span<const Ray> rays) {
    const size_t filled = (rays.size() + kFullChunk - 1) / kFullChunk * kFullChunk;
    std::vector<vec4> texels;
    texels.reserve(2 * filled);
    for (size_t i = 0; i < filled; ++i) {
        const Ray& ray = i < rays.size() ? rays[i] : kPaddingRay;
        texels.emplace_back(ray.org, ray.tmin);
        texels.emplace_back(ray.dir, ray.tmax);
    }
    ChunkOnDevice chunk;
    chunk.count = rays.size();
    chunk.texels = gl::texture_buffer("given_rays", gl::TexelFormat::rgba32f, texels);
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
        const size_t at = 4 * texel_at(i, answers.height());
        result.hits.push_back(make_hit(&hits[at], &ids[at]));
        result.flags.push_back(ids[at + 2]);
        sum += ids[at + 3];
    }
    if (!counters) return sum;
    const std::vector<uint32_t> counts = gl::read_uints(answers.target(2));
    for (size_t i = 0; i < count; ++i) {
        result.counters.push_back(make_counters(&counts[4 * texel_at(i, answers.height())]));
    }
    return sum;
}

void append_pairs(const gl::Framebuffer& answers, size_t count, CastResult& result) {
    const std::vector<uint32_t> hits[2] = {gl::read_uints(answers.target(0)),
                                           gl::read_uints(answers.target(1))};
    const std::vector<uint32_t> instances = gl::read_uints(answers.target(2));
    const auto number = [](uint32_t bits) { return std::bit_cast<float>(bits); };
    for (size_t i = 0; i < count; ++i) {
        const size_t which = i / kLanes % 2;
        const size_t place = i / (2 * kLanes) * kLanes + i % kLanes;
        const size_t at = 4 * texel_at(place, answers.height());
        const uint32_t* const hit = &hits[which][at];
        const uint32_t* const instance = &instances[at + 2 * which];
        result.hits.push_back(
            {number(hit[1]), number(hit[2]), number(hit[3]), hit[0], instance[0]});
        result.flags.push_back(instance[1]);
    }
}

AnswersOnDevice::AnswersOnDevice(size_t count, bool with_counters)
    : hits("hits", count * sizeof(HitRecord)) {
    if (with_counters) counters.emplace("counters", count * sizeof(glm::uvec4));
}

void AnswersOnDevice::give_to(gl::Program& program) const {
    program.set_buffer("HitBuffer", hits);
    if (counters) program.set_buffer("CounterBuffer", *counters);
}

uint64_t append_hits(const AnswersOnDevice& answers, size_t count, CastResult& result) {
    uint64_t sum = 0;
    const std::vector<HitRecord> records = answers.hits.read<HitRecord>();
    for (const HitRecord& record : std::span(records).first(count)) {
        result.hits.push_back(make_hit(&record.hit.x, &record.ids.x));
        result.flags.push_back(record.ids.z);
        sum += record.ids.w;
    }
    if (!answers.counters) return sum;
    const std::vector<glm::uvec4> counters = answers.counters->read<glm::uvec4>();
    for (const glm::uvec4& counts : std::span(counters).first(count)) {
        result.counters.push_back(make_counters(&counts.x));
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
