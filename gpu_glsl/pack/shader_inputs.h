// What a shader reads, before it is known who runs it: named textures, uniforms and constants.
//
// Packing makes ShaderInputs from a scene; a GPU tracer uploads them, a twin reads them in place.
// So both see the same numbers, and a disagreement cannot come from two packers.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <variant>
#include <vector>

#include "core/raw_vector.h"
#include "core/types.h"

namespace onepass {

/// How a texture stores a channel. `half`: every value of `texels` is exact in 16 bits. `word`:
/// unsigned integers.
enum class ChannelFormat { half, single, word };

/// A 2D or 3D texture, or a buffer (of dimension 1). Texel (x, y, z) starts at
/// texels[channels * (x + size.x * (y + size.y * z))].
struct TextureData {
    std::string name;  ///< of the sampler
    int dimensions = 2;
    uvec3 size{1};  ///< texels; 1 in the dimensions it lacks
    int channels = 4;
    ChannelFormat format = ChannelFormat::single;
    bool is_block = false;  ///< a buffer that shaders read as a storage block
    RawVector<float> texels;
    RawVector<uint32_t> words = {};  ///< of format `word`, in place of `texels`

    uint64_t bytes() const {
        return uint64_t{size.x} * size.y * size.z * static_cast<uint64_t>(channels) *
               (format == ChannelFormat::half ? 2 : 4);
    }
};

struct UniformData {
    std::string name;
    std::variant<int32_t, float, vec3> value;
};

/// New texels for a box of a texture, in the texture's own order and channels.
struct TexelBox {
    std::string texture;  ///< its name
    uvec3 corner{0};
    uvec3 size{1};
    RawVector<float> texels;
};

/// What becomes of inputs when instances move. Deques, as in ShaderInputs.
struct InputChanges {
    std::deque<TextureData> remade;  ///< take the place of those of the same names
    std::deque<TexelBox> boxes;      ///< of textures that are not remade
    std::vector<UniformData> uniforms;
};

struct ShaderInputs {
    /// A deque, because growing a vector would copy the texels: GLM's vectors, and so TextureData,
    /// are not nothrow-movable here.
    std::deque<TextureData> textures;
    std::vector<UniformData> uniforms;

    /// Adds all of another's.
    void append(ShaderInputs other);

    uint64_t texture_bytes() const;

    /// The texture of that name. Throws: Error if there is none.
    const TextureData& texture(const std::string& name) const;
    TextureData& texture(const std::string& name);

    /// Changes textures and uniforms in place. A box of a texture whose texels were given back
    /// (an empty vector) is left out.
    void apply(InputChanges changes);
};

/// The largest textures and buffers a device holds, as packing needs to know it.
struct TextureLimits {
    uint32_t max_2d = 16384;  ///< texels a side
    uint32_t max_3d = 2048;
    uint64_t max_buffer = uint64_t{1} << 27;       ///< texels of a buffer texture
    uint64_t max_block = (uint64_t{1} << 31) - 1;  ///< bytes of a storage block
};

/// A 2D texture of RGBA32F texels, all 0.
TextureData zero_texture(const std::string& name, uvec3 size);

/// The size of make_record_texture()'s texture. Throws: as it does.
uvec3 record_texture_size(const std::string& name, const std::string& what, uint64_t records,
                          uint32_t texels_per_record, uint32_t max_side);

/// A 2D texture of `records` records of `texels_per_record` RGBA32F texels each, row-major, where
/// no record crosses a row: a power of two wide, just high enough. `what` names the records in
/// errors. Throws: Error if the records exceed `max_side`.
TextureData make_record_texture(const std::string& name, const std::string& what, uint64_t records,
                                uint32_t texels_per_record, uint32_t max_side);

/// What shaders read a buffer as: a device has a limit for each.
enum class BufferKind { texture, block };

/// Buffers of zeros: of four floats a texel, and of 1, 2 or 4 unsigned integers a texel. `what`
/// names what fills them in errors. Throws: Error if the texels exceed the limit.
TextureData make_float_buffer(const std::string& name, const std::string& what, uint64_t texels,
                              const TextureLimits& limits, BufferKind kind = BufferKind::texture);
TextureData make_word_buffer(const std::string& name, const std::string& what, uint64_t texels,
                             int channels, const TextureLimits& limits,
                             BufferKind kind = BufferKind::texture);

/// The same of numbers that are there: of four floats a texel, and of one integer or more.
TextureData float_buffer_of(const std::string& name, const std::string& what,
                            RawVector<float> texels, const TextureLimits& limits, BufferKind kind);
TextureData word_buffer_of(const std::string& name, const std::string& what,
                           RawVector<uint32_t> words, const TextureLimits& limits, BufferKind kind,
                           int channels = 1);

/// The texel where record `index` of such a texture begins.
uvec2 record_texel(uvec3 texture_size, uint64_t index, uint32_t texels_per_record);
inline uvec2 record_texel(const TextureData& texture, uint64_t index, uint32_t texels_per_record) {
    return record_texel(texture.size, index, texels_per_record);
}

/// The four floats of a texel.
float* texel_at(TextureData& texture, uvec2 texel);

}  // namespace onepass
