#include "gpu_glsl/pack/shader_inputs.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {

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
    const auto found = std::find_if(textures.begin(), textures.end(),
                                    [&](const TextureData& t) { return t.name == name; });
    if (found == textures.end()) {
        throw Error({"texture '" + name + "'", "nothing packed under that name",
                     "a texture made by the strategy's packing",
                     "Add it to the packing of the storage that declares it."});
    }
    return *found;
}

TextureData& ShaderInputs::texture(const std::string& name) {
    return const_cast<TextureData&>(std::as_const(*this).texture(name));
}

TextureData make_record_texture(const std::string& name, const std::string& what, uint64_t records,
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
    TextureData texture;
    texture.name = name;
    texture.size = uvec3(width, height, 1);
    texture.texels.assign(width * height * 4, 0.0f);
    return texture;
}

uvec2 record_texel(const TextureData& texture, uint64_t index, uint32_t texels_per_record) {
    const uint64_t per_row = texture.size.x / texels_per_record;
    return uvec2(index % per_row * texels_per_record, index / per_row);
}

float* texel_at(TextureData& texture, uvec2 texel) {
    return &texture.texels[4 * (texel.x + size_t{texture.size.x} * texel.y)];
}

}  // namespace onepass
