// What all GPU tracers have in common: scene textures and rays to the device, hits and pixels back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/tracer.h"
#include "gpu_glsl/gl/objects.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

gl::TexelFormat texel_format(const TextureData& texture);
gl::Texture upload_texture(const TextureData& texture);

/// Rays of one chunk of a batch: for fragments or for compute shaders.
struct ChunkOnDevice {
    size_t count = 0;
    std::optional<gl::Texture> texels;  ///< two a ray
    std::optional<gl::Buffer> buffer;

    /// Width and height of the fragments that answer them, `each` rays a fragment: 1 or 2. Some may
    /// get rays that are none.
    uvec2 fragments(size_t each = 1) const;

    /// What shaders/lib/given_rays.glsl asks for.
    void give_to(gl::Program& program, size_t each = 1) const;
};

struct RaysOnDevice {
    std::vector<ChunkOnDevice> chunks;
};

/// Rays that one chunk for fragments may hold, where a buffer texture may have that many texels.
size_t most_rays_in_texels(int64_t most_texels);

ChunkOnDevice upload_to_texels(std::span<const Ray> rays);
ChunkOnDevice upload_to_buffer(std::span<const Ray> rays);

/// The records of lib/records.glsl and entry/compute.glsl (std430).
struct HitRecord {
    vec4 hit;
    glm::uvec4 ids;
};
static_assert(sizeof(HitRecord) == 32);

struct PixelRecord {
    vec4 color;
    vec4 hit;
    glm::uvec4 ids;
    vec4 normal;
    glm::uvec4 counters;
};
static_assert(sizeof(PixelRecord) == 80);

/// Where a compute shader leaves its answers to the rays of a chunk.
struct AnswersOnDevice {
    AnswersOnDevice(size_t count, bool with_counters);
    void give_to(gl::Program& program) const;

    gl::Buffer hits;                     ///< HitRecords
    std::optional<gl::Buffer> counters;  ///< uvec4: cells, tests, references, rays
};

/// Adds the answers to `count` rays: from the targets of entry/cast_fragment.glsl, or from buffers.
/// Returns the sum of ids.w, where a shader may leave a count of its own.
uint64_t append_hits(const gl::Framebuffer& answers, size_t count, bool counters,
                     CastResult& result);
uint64_t append_hits(const AnswersOnDevice& answers, size_t count, CastResult& result);

/// Adds the answers of fragments that answer two rays each: entry/cast_fragment_pairs.glsl.
void append_pairs(const gl::Framebuffer& answers, size_t count, CastResult& result);

/// Adds rows of pixels: from the targets of entry/fragment.glsl, or from PixelRecords. Returns as
/// append_hits; 0 without AOVs.
uint64_t append_pixels(const gl::Framebuffer& pixels, bool aovs, Frame& frame);
uint64_t append_pixels(const gl::Buffer& pixels, size_t count, bool aovs, Frame& frame);

}  // namespace onepass
