// What a twin reads in place of a GPU's textures, uniforms and constants.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass::twin {

/// A fetch outside a texture: an error in the twin, where a GPU would quietly return something.
/// Throws: Error naming the texture and the coordinates.
[[noreturn]] void fetch_out_of_range(const TextureData& texture, double x, double y, double z);

/// Throws: as fetch_out_of_range, if `index` lies outside the buffer.
inline void check_index(const TextureData& buffer, int index) {
    if (index < 0 || static_cast<uint32_t>(index) >= buffer.size.x) {
        fetch_out_of_range(buffer, index, 0, 0);
    }
}

/// Constants, uniforms and textures by the names the shader text uses.
class Bindings {
  public:
    /// All arguments must outlive the bindings. `uniforms` are searched after those of `inputs`.
    Bindings(const ShaderInputs& inputs, std::span<const UniformData> uniforms,
             std::span<const gl::ShaderConstant> constants)
        : inputs_(inputs), uniforms_(uniforms), constants_(constants) {}

    /// Throws: Error if nothing of that name was given, or it does not convert to T.
    template <class T>
    T constant(const char* name) const {
        return std::visit([](auto value) { return static_cast<T>(value); },
                          find_constant(name).value);
    }

    template <class T>
    T uniform(const char* name) const {
        return std::visit(
            [&](auto value) -> T {
                if constexpr (std::is_constructible_v<T, decltype(value)>) {
                    return T(value);
                } else {
                    wrong_type(name);
                }
            },
            find_uniform(name).value);
    }

    const TextureData& texture(const char* name, int dimensions) const;

  private:
    const gl::ShaderConstant& find_constant(std::string_view name) const;
    const UniformData& find_uniform(std::string_view name) const;
    [[noreturn]] static void wrong_type(const char* name);

    const ShaderInputs& inputs_;
    std::span<const UniformData> uniforms_;
    std::span<const gl::ShaderConstant> constants_;
};

/// A texture as a twin samples it: texel floor(u * W), which is what the nearest filter does, and
/// every access checked.
template <class Real>
class Sampler {
  public:
    using Vec2 = glm::vec<2, Real>;
    using Vec3 = glm::vec<3, Real>;
    using Vec4 = glm::vec<4, Real>;

    explicit Sampler(const TextureData& texture) : texture_(&texture) {}

    Vec4 sample(const Vec2& uv) const {
        return texel(std::floor(uv.x * static_cast<Real>(texture_->size.x)),
                     std::floor(uv.y * static_cast<Real>(texture_->size.y)), Real(0));
    }
    Vec4 sample(const Vec3& uvw) const {
        return texel(std::floor(uvw.x * static_cast<Real>(texture_->size.x)),
                     std::floor(uvw.y * static_cast<Real>(texture_->size.y)),
                     std::floor(uvw.z * static_cast<Real>(texture_->size.z)));
    }
    Vec4 fetch(const glm::ivec2& at) const {
        return texel(static_cast<Real>(at.x), static_cast<Real>(at.y), Real(0));
    }

    glm::ivec2 size2() const { return glm::ivec2(texture_->size); }
    glm::ivec3 size3() const { return glm::ivec3(texture_->size); }

  private:
    Vec4 texel(Real x, Real y, Real z) const {
        const glm::uvec3& size = texture_->size;
        // Written so that NaN fails.
        const bool inside = x >= 0 && x < static_cast<Real>(size.x) && y >= 0 &&
                            y < static_cast<Real>(size.y) && z >= 0 &&
                            z < static_cast<Real>(size.z);
        if (!inside) {
            fetch_out_of_range(*texture_, static_cast<double>(x), static_cast<double>(y),
                               static_cast<double>(z));
        }
        const size_t index =
            static_cast<size_t>(x) +
            size_t{size.x} * (static_cast<size_t>(y) + size_t{size.y} * static_cast<size_t>(z));
        const int channels = texture_->channels;
        const float* values = &texture_->texels[index * static_cast<size_t>(channels)];
        // Missing channels read as (0, 0, 1), as in GL.
        return Vec4(values[0], channels > 1 ? values[1] : 0.0f, channels > 2 ? values[2] : 0.0f,
                    channels > 3 ? values[3] : 1.0f);
    }

    const TextureData* texture_;
};

/// A buffer of floats, read by index.
template <class Real>
class BufferSampler {
  public:
    using Vec4 = glm::vec<4, Real>;

    explicit BufferSampler(const TextureData& buffer) : buffer_(&buffer) {}

    Vec4 fetch(int index) const {
        check_index(*buffer_, index);
        const float* values = &buffer_->texels[4 * static_cast<size_t>(index)];
        return Vec4(values[0], values[1], values[2], values[3]);
    }

  private:
    const TextureData* buffer_;
};

/// A buffer of unsigned integers, read by index. Missing channels read as (0, 0, 1), as in GL.
class WordSampler {
  public:
    explicit WordSampler(const TextureData& buffer) : buffer_(&buffer) {}

    glm::uvec4 fetch(int index) const {
        check_index(*buffer_, index);
        const auto channels = static_cast<size_t>(buffer_->channels);
        const uint32_t* values = &buffer_->words[channels * static_cast<size_t>(index)];
        return glm::uvec4(values[0], channels > 1 ? values[1] : 0, channels > 2 ? values[2] : 0,
                          channels > 3 ? values[3] : 1);
    }

  private:
    const TextureData* buffer_;
};

/// A storage block's array of T, read by index: unsigned integers, or vectors of four of them or of
/// four floats.
template <class T>
class StorageSampler : public BufferSampler<typename T::value_type> {
  public:
    using BufferSampler<typename T::value_type>::BufferSampler;
};

template <>
class StorageSampler<glm::uint> {
  public:
    explicit StorageSampler(const TextureData& buffer) : words_(buffer) {}

    glm::uint fetch(int index) const { return words_.fetch(index).x; }

  private:
    WordSampler words_;
};

template <>
class StorageSampler<glm::uvec4> : public WordSampler {
  public:
    using WordSampler::WordSampler;
};

}  // namespace onepass::twin
