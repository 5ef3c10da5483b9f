// GL objects that delete themselves: textures, buffers, framebuffers, programs; draw and dispatch.
//
// Everything here needs a current GlContext and must be destroyed before it. GL 3.3 calls where
// they suffice; compute and storage buffers need 4.3. A program remembers what its samplers and
// blocks read and binds all of it at every launch, so tracers can be interleaved freely.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <glad/gl.h>
#include <glm/glm.hpp>

#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/shader_library.h"

namespace onepass::gl {

/// Throws: Error (Kind::device) naming every GL error raised since the last check. `doing`
/// completes the sentence "while ...": "uploading texture 'cells'".
void check_gl(const std::string& doing);

/// A GL object's name and the function that deletes it; move-only.
class Handle {
  public:
    using Delete = void (*)(GLuint);

    Handle() = default;
    Handle(GLuint id, Delete deleter) : id_(id), delete_(deleter) {}
    Handle(Handle&& other) noexcept
        : id_(std::exchange(other.id_, 0)), delete_(std::exchange(other.delete_, nullptr)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(delete_, other.delete_);
        return *this;
    }
    ~Handle() {
        if (id_ != 0) delete_(id_);
    }

    GLuint id() const { return id_; }

  private:
    GLuint id_ = 0;
    Delete delete_ = nullptr;
};

/// What one texel holds.
enum class TexelFormat { r16f, rg16f, rgba16f, r32f, rg32f, rgba32f, r32ui, rg32ui, rgba32ui };

int component_count(TexelFormat format);
size_t bytes_per_texel(TexelFormat format);

/// A half-float as bits, for data that is already in 16 bits.
struct Half {
    uint16_t bits = 0;
};

/// A view of texel data to upload, tightly packed: scalars or GLM vectors of float (for any float
/// format; GL rounds to half), Half (for 16-bit formats) or uint32_t (for integer formats). A
/// default one has no data: the texture is allocated and its content undefined.
struct Texels {
    const void* data = nullptr;
    size_t scalar_count = 0;
    GLenum scalar_type = 0;

    Texels() = default;
    template <std::ranges::contiguous_range Range>
    Texels(const Range& range) {  // NOLINT: implicit, so that a vector can be passed as it is
        using Element = std::ranges::range_value_t<Range>;
        data = std::ranges::data(range);
        scalar_type = scalar_type_of<Element>();
        scalar_count = std::ranges::size(range) * sizeof(Element) / scalar_size(scalar_type);
    }

  private:
    static constexpr size_t scalar_size(GLenum type) { return type == GL_HALF_FLOAT ? 2 : 4; }
    template <class Element>
    static constexpr GLenum scalar_type_of() {
        if constexpr (std::is_same_v<Element, Half>) {
            return GL_HALF_FLOAT;
        } else if constexpr (std::is_same_v<Element, float> || std::is_same_v<Element, uint32_t>) {
            return std::is_same_v<Element, float> ? GL_FLOAT : GL_UNSIGNED_INT;
        } else {
            return scalar_type_of<typename Element::value_type>();  // a GLM vector
        }
    }
};

/// What shaders read the buffer of a buffer texture as.
enum class BufferUse { texture, block };

/// A texture read texel by texel: nearest filter, edges clamped, one level.
class Texture {
  public:
    GLuint id() const { return id_.id(); }
    GLenum target() const { return target_; }
    TexelFormat format() const { return format_; }
    GLenum gl_format() const;                         ///< GL's name of it
    const glm::uvec3& size() const { return size_; }  ///< texels; 1 on axes it lacks
    size_t bytes() const;
    const std::string& name() const { return name_; }
    GLuint buffer_id() const { return storage_.id(); }  ///< of a buffer texture, else 0

  private:
    friend Texture texture_2d(std::string, TexelFormat, uint32_t, uint32_t, const Texels&);
    friend Texture texture_3d(std::string, TexelFormat, const glm::uvec3&, const Texels&);
    friend Texture texture_buffer(std::string, TexelFormat, const Texels&, BufferUse);
    Texture(std::string name, GLenum target, TexelFormat format, const glm::uvec3& size);

    std::string name_;
    GLenum target_;
    TexelFormat format_;
    glm::uvec3 size_;
    Handle storage_;  ///< of a buffer texture; declared first so that it is deleted last
    Handle id_;
};

/// `name` stands in error messages. The data must fill the texture exactly.
///
/// Layout: row by row; texel (x, y, z) has index x + width * (y + height * z).
/// Throws: Error naming the size asked and the limit if the device cannot hold it.
Texture texture_2d(std::string name, TexelFormat format, uint32_t width, uint32_t height,
                   const Texels& texels = {});
Texture texture_3d(std::string name, TexelFormat format, const glm::uvec3& size,
                   const Texels& texels = {});

/// Replaces the texels of a box of a 2D or 3D texture; the data must fill the box exactly, in the
/// layout of a texture of its size. Cost: that of the box.
void update_region(const Texture& texture, const glm::uvec3& corner, const glm::uvec3& size,
                   const Texels& texels);

/// A buffer texture (`samplerBuffer`), as long as its data. 32-bit formats are what GLSL needs.
/// As a block its buffer may be longer than textures can be: they would see its beginning only.
/// Throws: Error as texture_2d, by the limit of its use.
Texture texture_buffer(std::string name, TexelFormat format, const Texels& texels,
                       BufferUse use = BufferUse::texture);

/// The whole texture read back (2D and 3D, float formats), in upload order.
std::vector<float> read_floats(const Texture& texture);
std::vector<uint32_t> read_uints(const Texture& texture);

/// A shader storage buffer. GL has no empty storage block: an empty one holds 16 unused bytes.
class Buffer {
  public:
    /// Zero-filled.
    /// Throws: Error naming size and limit if the device cannot hold it.
    Buffer(std::string name, size_t bytes);

    template <std::ranges::contiguous_range Range>
    static Buffer of(std::string name, const Range& range) {
        const auto bytes = std::as_bytes(std::span(range));
        return Buffer(std::move(name), bytes.size(), bytes.data());
    }

    template <class T>
    std::vector<T> read() const {
        // GLM's vectors are plain bytes, though not trivially copyable in the standard's words.
        static_assert(std::is_standard_layout_v<T> && std::is_trivially_destructible_v<T>);
        std::vector<T> values(bytes_ / sizeof(T));
        read_bytes(values.data(), values.size() * sizeof(T));
        return values;
    }

    /// Overwrites the first bytes. The data must fit.
    template <std::ranges::contiguous_range Range>
    void write(const Range& range) const {
        const auto bytes = std::as_bytes(std::span(range));
        write_bytes(bytes.data(), bytes.size());
    }

    GLuint id() const { return id_.id(); }
    size_t bytes() const { return bytes_; }
    const std::string& name() const { return name_; }

  private:
    Buffer(std::string name, size_t bytes, const void* data);
    void write_bytes(const void* data, size_t bytes) const;
    void read_bytes(void* data, size_t bytes) const;

    std::string name_;
    size_t bytes_;
    Handle id_;
};

/// Several render targets of one size. Row 0 is the one with gl_FragCoord.y = 0.5.
class Framebuffer {
  public:
    /// Target i takes the fragment output at location i.
    /// Throws: Error naming the limit if there are too many targets or they are too large.
    Framebuffer(uint32_t width, uint32_t height, const std::vector<TexelFormat>& targets);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    GLuint id() const { return id_.id(); }
    const Texture& target(size_t index) const { return targets_[index]; }

  private:
    uint32_t width_;
    uint32_t height_;
    std::vector<Texture> targets_;
    Handle id_;
};

/// Whether a name that a linked program lacks is an error. A compiler removes what a variant does
/// not use: say so where that may happen.
enum class Missing { error, allowed };

/// A linked program with its uniforms, textures and buffers.
class Program {
  public:
    /// Throws: Error whose `where` is the file:line of the first error and whose `got` is the
    /// driver's log with places mapped back to files.
    Program(std::string name, const std::vector<ComposedShader>& stages);

    /// Throws: Error if there is no such uniform (and that is not allowed) or its type is another.
    void set_uniform(const std::string& uniform, bool value, Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, int32_t value, Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, uint32_t value, Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, float value, Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::vec2& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::vec3& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::vec4& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::ivec2& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::ivec3& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::uvec2& value,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, const glm::uvec3& value,
                     Missing missing = Missing::error);
    /// An array `uniform vec3 NAME[N]`; at most N values.
    void set_uniform(const std::string& uniform, std::span<const glm::vec3> values,
                     Missing missing = Missing::error);
    void set_uniform(const std::string& uniform, std::span<const glm::vec4> values,
                     Missing missing = Missing::error);

    /// Lets a sampler read `texture`, or an image of that name a buffer texture. It must outlive
    /// every launch.
    /// Throws: Error as set_uniform.
    void set_texture(const std::string& sampler, const Texture& texture,
                     Missing missing = Missing::error);

    /// Lets a storage block (by its block name) use `buffer`, which must outlive every launch.
    /// Throws: Error if there is no such block (and that is not allowed).
    void set_buffer(const std::string& block, const Buffer& buffer,
                    Missing missing = Missing::error);

    /// The same with the data of a buffer texture.
    void set_buffer(const std::string& block, const Texture& buffer_texture,
                    Missing missing = Missing::error);

    /// Makes it current, with all its textures and buffers.
    /// Throws: Error naming the samplers and blocks that were given nothing.
    void use() const;

    const std::string& name() const { return name_; }
    GLuint id() const { return id_.id(); }

    /// Byte offset and array stride of each member of the storage blocks, by the name GL gives it
    /// ("rays[0].org"): the driver's word on a layout shared with C++.
    struct Member {
        int offset = 0;
        int array_stride = 0;  ///< of the member itself
        int top_level_array_stride = 0;
    };
    std::map<std::string, Member> block_members() const;

    /// Invocations of a work group, as the compute shader declares them.
    glm::uvec3 work_group_size() const;

  private:
    struct Uniform {
        GLint location = -1;
        GLenum type = 0;
        GLint array_size = 1;
    };
    struct TextureBinding {
        GLenum target = 0;
        GLuint texture = 0;
    };
    struct ImageBinding {
        GLuint texture = 0;
        GLenum format = 0;
    };

    const Uniform* find_uniform(const std::string& uniform, Missing missing) const;
    const Uniform* typed_uniform(const std::string& uniform, GLenum type, size_t count,
                                 Missing missing) const;
    void set_block(const std::string& block, GLuint buffer, Missing missing);
    void read_interface();

    std::string name_;
    Handle id_;
    std::map<std::string, Uniform> uniforms_;
    std::vector<std::string> samplers_;         ///< index = texture unit
    std::vector<TextureBinding> textures_;      ///< by texture unit
    std::vector<std::string> images_;           ///< index = image unit
    std::vector<ImageBinding> image_textures_;  ///< by image unit
    std::vector<std::string> blocks_;           ///< index = binding point
    std::vector<GLuint> buffers_;               ///< by binding point
};

/// Draws over all of a target of that size that is bound, with the program in use and without
/// vertex buffers: the vertex shader makes the viewport's corners from gl_VertexID 0 to 3
/// (shaders/entry/fullscreen.vert.glsl).
void draw_over(uint32_t width, uint32_t height);

/// Shades the whole framebuffer; the vertex shader is as above.
void draw_fullscreen(const Program& program, const Framebuffer& framebuffer);

/// Runs `groups` work groups, then makes their writes visible to everything that follows.
/// Throws: Error naming the limit if there are too many groups.
void dispatch(const Program& program, const glm::uvec3& groups);

struct LaunchTime {
    double wall_ms = 0.0;
    double device_ms = 0.0;  ///< NaN on a software renderer, whose timer queries are wrong
};

/// Runs `launch` between two glFinish and times it. One timer query at a time: `launch` must not
/// call this.
LaunchTime finish_and_time(const GlContext& context, const std::function<void()>& launch);

}  // namespace onepass::gl
