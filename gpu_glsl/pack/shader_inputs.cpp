#include "gpu_glsl/pack/shader_inputs.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// `textures`: a range of TextureData, const or not.
template <class Textures>
auto& find_texture(Textures& textures, const std::string& name) {
    const auto found = std::find_if(textures.begin(), textures.end(),
                                    [&](const TextureData& t) { return t.name == name; });
    if (found == textures.end()) {
        throw Error({"texture '" + name + "'", "nothing packed under that name",
                     "a texture made by the strategy's packing",
                     "Add it to the packing of the storage that declares it."});
    }
    return *found;
}

void write_box(TextureData& texture, const TexelBox& box) {
    if (texture.texels.empty()) return;
    const auto channels = static_cast<size_t>(texture.channels);
    const size_t row = channels * box.size.x;
    ONEPASS_CHECK_EQ(box.texels.size(), row * box.size.y * box.size.z);
    const float* from = box.texels.data();
    for (uint32_t z = 0; z < box.size.z; ++z) {
        for (uint32_t y = 0; y < box.size.y; ++y, from += row) {
            const size_t texel =
                box.corner.x + size_t{texture.size.x} *
                                   (box.corner.y + y + size_t{texture.size.y} * (box.corner.z + z));
            std::copy_n(from, row,
                        texture.texels.begin() + static_cast<std::ptrdiff_t>(channels * texel));
        }
    }
}

/// Without its content. An empty buffer holds one texel, as GL has none without.
TextureData make_buffer(const std::string& name, const std::string& what, uint64_t texels,
                        uint64_t bytes_a_texel, const TextureLimits& limits, BufferKind kind) {
    const bool is_block = kind == BufferKind::block;
    const uint64_t most = is_block ? limits.max_block / bytes_a_texel : limits.max_buffer;
    if (texels > most) {
        throw Error({fmt::format("buffer '{}'", name), fmt::format("{} texels of {}", texels, what),
                     fmt::format("at most {}, the limit of a {}", most,
                                 is_block ? "storage block" : "buffer texture"),
                     "Use a smaller scene, a lower --param density, a storage or a device with "
                     "larger buffers."});
    }
    TextureData buffer;
    buffer.name = name;
    buffer.dimensions = 1;
    buffer.size = uvec3(std::max<uint64_t>(texels, 1), 1, 1);
    buffer.is_block = is_block;
    return buffer;
}

}  // namespace

void ShaderInputs::append(ShaderInputs other) {
    std::move(other.textures.begin(), other.textures.end(), std::back_inserter(textures));
    std::move(other.uniforms.begin(), other.uniforms.end(), std::back_inserter(uniforms));
}

uint64_t ShaderInputs::texture_bytes() const {
    uint64_t sum = 0;
    for (const TextureData& texture : textures) sum += texture.bytes();
    return sum;
}

const TextureData& ShaderInputs::texture(const std::string& name) const {
    return find_texture(textures, name);
}

TextureData& ShaderInputs::texture(const std::string& name) { return find_texture(textures, name); }

void ShaderInputs::apply(InputChanges changes) {
    for (TextureData& remade : changes.remade) texture(remade.name) = std::move(remade);
    for (const TexelBox& box : changes.boxes) write_box(texture(box.texture), box);
    for (const UniformData& uniform : changes.uniforms) {
        for (UniformData& own : uniforms) {
            if (own.name == uniform.name) own.value = uniform.value;
        }
    }
}

TextureData zero_texture(const std::string& name, uvec3 size) {
    TextureData texture;
    texture.name = name;
    texture.size = size;
    texture.texels.assign(size_t{4} * size.x * size.y, 0.0f);
    return texture;
}

uvec3 record_texture_size(const std::string& name, const std::string& what, uint64_t records,
                          uint32_t texels_per_record, uint32_t max_side) {
    // As square as powers of two allow: the side limits, not the area, run out first.
    const uint64_t texels = std::max<uint64_t>(records, 1) * texels_per_record;
    uint64_t width = std::bit_ceil(uint64_t{texels_per_record});
    while (width < max_side && width * width < texels) width *= 2;
    const uint64_t per_row = width / texels_per_record;
    const uint64_t height = (std::max<uint64_t>(records, 1) + per_row - 1) / per_row;
    if (width > max_side || height > max_side) {
        throw Error(
            {fmt::format("texture '{}'", name), fmt::format("{} {}", records, what),
             fmt::format("at most {} in {} x {} texels",
                         (max_side / texels_per_record) * uint64_t{max_side}, max_side, max_side),
             "Use a smaller scene, --param address=float, or a device with larger "
             "textures."});
    }
    return uvec3(width, height, 1);
}

TextureData make_float_buffer(const std::string& name, const std::string& what, uint64_t texels,
                              const TextureLimits& limits, BufferKind kind) {
    TextureData buffer = make_buffer(name, what, texels, 4 * sizeof(float), limits, kind);
    buffer.texels.assign(size_t{4} * buffer.size.x, 0.0f);
    return buffer;
}

TextureData make_word_buffer(const std::string& name, const std::string& what, uint64_t texels,
                             int channels, const TextureLimits& limits, BufferKind kind) {
    const uint64_t bytes_a_texel = static_cast<uint64_t>(channels) * sizeof(uint32_t);
    TextureData buffer = make_buffer(name, what, texels, bytes_a_texel, limits, kind);
    buffer.channels = channels;
    buffer.format = ChannelFormat::word;
    buffer.words.assign(static_cast<size_t>(channels) * buffer.size.x, 0);
    return buffer;
}

TextureData float_buffer_of(const std::string& name, const std::string& what,
                            RawVector<float> texels, const TextureLimits& limits, BufferKind kind) {
    ONEPASS_CHECK_LT(0u, texels.size());
    ONEPASS_CHECK_EQ(texels.size() % 4, 0u);
    TextureData buffer =
        make_buffer(name, what, texels.size() / 4, 4 * sizeof(float), limits, kind);
    buffer.texels = std::move(texels);
    return buffer;
}

TextureData word_buffer_of(const std::string& name, const std::string& what,
                           RawVector<uint32_t> words, const TextureLimits& limits, BufferKind kind,
                           int channels) {
    ONEPASS_CHECK_LT(0u, words.size());
    const auto a_texel = static_cast<size_t>(channels);
    ONEPASS_CHECK_EQ(words.size() % a_texel, 0u);
    TextureData buffer =
        make_buffer(name, what, words.size() / a_texel, a_texel * sizeof(uint32_t), limits, kind);
    buffer.channels = channels;
    buffer.format = ChannelFormat::word;
    buffer.words = std::move(words);
    return buffer;
}

TextureData make_record_texture(const std::string& name, const std::string& what, uint64_t records,
                                uint32_t texels_per_record, uint32_t max_side) {
    return zero_texture(name,
                        record_texture_size(name, what, records, texels_per_record, max_side));
}

uvec2 record_texel(uvec3 texture_size, uint64_t index, uint32_t texels_per_record) {
    const uint64_t per_row = texture_size.x / texels_per_record;
    return uvec2(index % per_row * texels_per_record, index / per_row);
}

float* texel_at(TextureData& texture, uvec2 texel) {
    return &texture.texels[4 * (texel.x + size_t{texture.size.x} * texel.y)];
}

}  // namespace onepass
