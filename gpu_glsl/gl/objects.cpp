// Textures, buffers, framebuffers, draw, dispatch and timing. Programs are in program.cpp.
#include "gpu_glsl/gl/objects.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "gpu_glsl/gl/context_common.h"

namespace onepass::gl {
namespace {

/// Objects are edited on this unit, so that making one leaves the launch units alone. OpenGL 3.3
/// promises 48 units in all, 16 to a stage.
constexpr GLenum kEditUnit = GL_TEXTURE0 + 47;

struct FormatInfo {
    GLenum internal_format;
    GLenum pixel_format;
    GLenum scalar_type;  ///< in which it is read back
    int components;
    int scalar_bytes;
};

FormatInfo format_info(TexelFormat format) {
    switch (format) {
        case TexelFormat::r16f:
            return {GL_R16F, GL_RED, GL_FLOAT, 1, 2};
        case TexelFormat::rg16f:
            return {GL_RG16F, GL_RG, GL_FLOAT, 2, 2};
        case TexelFormat::rgba16f:
            return {GL_RGBA16F, GL_RGBA, GL_FLOAT, 4, 2};
        case TexelFormat::r32f:
            return {GL_R32F, GL_RED, GL_FLOAT, 1, 4};
        case TexelFormat::rg32f:
            return {GL_RG32F, GL_RG, GL_FLOAT, 2, 4};
        case TexelFormat::rgba32f:
            return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 4};
        case TexelFormat::r32ui:
            return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 1, 4};
        case TexelFormat::rg32ui:
            return {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 2, 4};
        case TexelFormat::rgba32ui:
            return {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4, 4};
    }
    ONEPASS_CHECK(!"a texel format without a row in this table");
    return {};
}

int64_t limit(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return value;
}

const char* renderer() { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

void check_limit(const std::string& what, uint64_t asked, const char* unit, int64_t most,
                 const char* limit_name) {
    if (asked <= static_cast<uint64_t>(std::max<int64_t>(most, 0))) return;
    throw Error({.where = fmt::format("{} on {}", what, renderer()),
                 .got = fmt::format("{} {}", asked, unit),
                 .expected = fmt::format("at most {} ({})", most, limit_name),
                 .remedy = "Make the scene smaller or its grid coarser, or choose another storage "
                           "or device."});
}

int64_t most_block_bytes() {
    return GLAD_GL_VERSION_4_3 ? limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE) : 0;
}

/// The texels must suit the format and fill the texture: the packer's duty, so a check.
void check_texels(const FormatInfo& info, const glm::uvec3& size, const Texels& texels) {
    if (texels.scalar_type == 0) return;
    const bool halves = texels.scalar_type == GL_HALF_FLOAT && info.scalar_bytes == 2;
    ONEPASS_CHECK(halves || texels.scalar_type == info.scalar_type);
    const size_t expected = size_t{size.x} * size.y * size.z * static_cast<size_t>(info.components);
    ONEPASS_CHECK_EQ(texels.scalar_count, expected);
}

Handle make_texture(GLenum target) {
    GLuint id = 0;
    glGenTextures(1, &id);
    glActiveTexture(kEditUnit);
    glBindTexture(target, id);
    return Handle(id, [](GLuint texture) { glDeleteTextures(1, &texture); });
}

/// Bound to GL_COPY_WRITE_BUFFER.
Handle generate_buffer() {
    GLuint id = 0;
    glGenBuffers(1, &id);
    glBindBuffer(GL_COPY_WRITE_BUFFER, id);
    return Handle(id, [](GLuint buffer) { glDeleteBuffers(1, &buffer); });
}

Handle make_buffer(size_t bytes, const void* data) {
    Handle made = generate_buffer();
    const auto size = static_cast<GLsizeiptr>(bytes);
    if (GLAD_GL_VERSION_4_4) {
        // A buffer that drivers cannot move: else one that is read back may end up in host memory.
        glBufferStorage(GL_COPY_WRITE_BUFFER, size, data, GL_DYNAMIC_STORAGE_BIT);
    } else {
        glBufferData(GL_COPY_WRITE_BUFFER, size, data, GL_STATIC_DRAW);
    }
    return made;
}

/// A buffer for what is written once and read everywhere. A large one is sparse where drivers have
/// that, with memory behind all of it: NVIDIA's lays such buffers in larger pages than ordinary
/// ones, so that a GPU seldom has to ask where a page lies (gpu_glsl/README.md, "What a GPU is
/// bound by").
Handle make_table(size_t bytes, const void* data) {
    constexpr size_t kLeastSparse = size_t{1} << 20;
    const bool has_sparse = GLAD_GL_VERSION_4_4 && GLAD_GL_ARB_sparse_buffer;
    if (!has_sparse || bytes < kLeastSparse) return make_buffer(bytes, data);
    Handle table = generate_buffer();
    glBufferStorage(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr,
                    GL_SPARSE_STORAGE_BIT_ARB | GL_DYNAMIC_STORAGE_BIT);
    // In pieces, of whole pages but for the last: NVIDIA's driver takes seconds over a gibibyte at
    // once.
    constexpr size_t kAboutAPiece = size_t{1} << 26;
    const auto page =
        static_cast<size_t>(std::max<int64_t>(limit(GL_SPARSE_BUFFER_PAGE_SIZE_ARB), 1));
    const size_t piece = std::max(kAboutAPiece / page, size_t{1}) * page;
    for (size_t at = 0; at < bytes; at += piece) {
        const auto from = static_cast<GLintptr>(at);
        const auto size = static_cast<GLsizeiptr>(std::min(piece, bytes - at));
        glBufferPageCommitmentARB(GL_COPY_WRITE_BUFFER, from, size, GL_TRUE);
        check_gl(fmt::format("committing {} bytes of a sparse buffer of {}", size, bytes));
        glBufferSubData(GL_COPY_WRITE_BUFFER, from, size, static_cast<const std::byte*>(data) + at);
    }
    return table;
}

void set_sampling(GLenum target) {
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
}

template <class T>
std::vector<T> read_texture(const Texture& texture, GLenum scalar_type) {
    const FormatInfo info = format_info(texture.format());
    ONEPASS_CHECK_EQ(info.scalar_type, scalar_type);
    ONEPASS_CHECK(texture.target() != GL_TEXTURE_BUFFER);
    const glm::uvec3 size = texture.size();
    std::vector<T> values(size_t{size.x} * size.y * size.z * static_cast<size_t>(info.components));
    glActiveTexture(kEditUnit);
    glBindTexture(texture.target(), texture.id());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(texture.target(), 0, info.pixel_format, scalar_type, values.data());
    check_gl(fmt::format("reading texture '{}'", texture.name()));
    return values;
}

std::string gl_error_name(GLenum code) {
    switch (code) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        default:
            return fmt::format("GL error 0x{:04X}", code);
    }
}

}  // namespace

void check_gl(const std::string& doing) {
    // A lost context may report errors for ever: stop after a few.
    constexpr int kMostErrors = 8;
    std::vector<std::string> errors;
    for (int i = 0; i < kMostErrors; ++i) {
        const GLenum code = glGetError();
        if (code == GL_NO_ERROR) break;
        errors.push_back(gl_error_name(code));
    }
    const std::vector<std::string> messages = take_debug_messages();
    if (errors.empty()) return;
    errors.insert(errors.end(), messages.begin(), messages.end());
    const bool out_of_memory = errors.front() == "GL_OUT_OF_MEMORY";
    throw Error({.where = fmt::format("{}, while {}", renderer(), doing),
                 .got = fmt::format("{}", fmt::join(errors, "; ")),
                 .expected = "no OpenGL error",
                 .remedy = out_of_memory ? "Make the scene smaller or its grid coarser."
                                         : "Set ONEPASS_GL_DEBUG=1 for the driver's own message."},
                Error::Kind::device);
}

// Textures ---------------------------------------------------------------------------------------

int component_count(TexelFormat format) { return format_info(format).components; }

size_t bytes_per_texel(TexelFormat format) {
    const FormatInfo info = format_info(format);
    return static_cast<size_t>(info.components * info.scalar_bytes);
}

Texture::Texture(std::string name, GLenum target, TexelFormat format, const glm::uvec3& size)
    : name_(std::move(name)), target_(target), format_(format), size_(size) {}

GLenum Texture::gl_format() const { return format_info(format_).internal_format; }

size_t Texture::bytes() const {
    return size_t{size_.x} * size_.y * size_.z * bytes_per_texel(format_);
}

Texture texture_2d(std::string name, TexelFormat format, uint32_t width, uint32_t height,
                   const Texels& texels) {
    // Check.
    const FormatInfo info = format_info(format);
    const std::string what = fmt::format("2D texture '{}'", name);
    const int64_t most = limit(GL_MAX_TEXTURE_SIZE);
    check_limit(what, std::max(width, height), "texels a side", most, "GL_MAX_TEXTURE_SIZE");
    check_texels(info, {width, height, 1}, texels);

    // Upload.
    Texture texture(std::move(name), GL_TEXTURE_2D, format, {width, height, 1});
    texture.id_ = make_texture(GL_TEXTURE_2D);
    set_sampling(GL_TEXTURE_2D);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(info.internal_format),
                 static_cast<GLsizei>(width), static_cast<GLsizei>(height), 0, info.pixel_format,
                 texels.scalar_type ? texels.scalar_type : info.scalar_type, texels.data);
    check_gl(fmt::format("uploading {} ({} bytes)", what, texture.bytes()));
    return texture;
}

Texture texture_3d(std::string name, TexelFormat format, const glm::uvec3& size,
                   const Texels& texels) {
    // Check.
    const FormatInfo info = format_info(format);
    const std::string what = fmt::format("3D texture '{}'", name);
    const int64_t most = limit(GL_MAX_3D_TEXTURE_SIZE);
    check_limit(what, std::max({size.x, size.y, size.z}), "texels a side", most,
                "GL_MAX_3D_TEXTURE_SIZE");
    check_texels(info, size, texels);

    // Upload.
    Texture texture(std::move(name), GL_TEXTURE_3D, format, size);
    texture.id_ = make_texture(GL_TEXTURE_3D);
    set_sampling(GL_TEXTURE_3D);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, static_cast<GLint>(info.internal_format),
                 static_cast<GLsizei>(size.x), static_cast<GLsizei>(size.y),
                 static_cast<GLsizei>(size.z), 0, info.pixel_format,
                 texels.scalar_type ? texels.scalar_type : info.scalar_type, texels.data);
    check_gl(fmt::format("uploading {} ({} bytes)", what, texture.bytes()));
    return texture;
}

void update_region(const Texture& texture, const glm::uvec3& corner, const glm::uvec3& size,
                   const Texels& texels) {
    // Check.
    const FormatInfo info = format_info(texture.format());
    for (int axis = 0; axis < 3; ++axis) {
        ONEPASS_CHECK_LE(uint64_t{corner[axis]} + size[axis], uint64_t{texture.size()[axis]});
    }
    ONEPASS_CHECK(texels.scalar_type != 0);
    check_texels(info, size, texels);

    // Upload.
    const glm::ivec3 at(corner);
    const glm::ivec3 box(size);
    glActiveTexture(kEditUnit);
    glBindTexture(texture.target(), texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (texture.target() == GL_TEXTURE_3D) {
        glTexSubImage3D(GL_TEXTURE_3D, 0, at.x, at.y, at.z, box.x, box.y, box.z, info.pixel_format,
                        texels.scalar_type, texels.data);
    } else {
        ONEPASS_CHECK(texture.target() == GL_TEXTURE_2D);
        glTexSubImage2D(GL_TEXTURE_2D, 0, at.x, at.y, box.x, box.y, info.pixel_format,
                        texels.scalar_type, texels.data);
    }
    check_gl(fmt::format("updating texture '{}'", texture.name()));
}

Texture texture_buffer(std::string name, TexelFormat format, const Texels& texels, BufferUse use) {
    // Check. The data goes into a plain buffer, which converts nothing.
    const FormatInfo info = format_info(format);
    const std::string what = fmt::format("buffer texture '{}'", name);
    const size_t texel_count = texels.scalar_count / static_cast<size_t>(info.components);
    const GLenum stored_type = info.scalar_bytes == 2 ? GL_HALF_FLOAT : info.scalar_type;
    ONEPASS_CHECK_EQ(texels.scalar_type, stored_type);
    ONEPASS_CHECK_EQ(texels.scalar_count, texel_count * static_cast<size_t>(info.components));
    if (use == BufferUse::texture) {
        check_limit(what, texel_count, "texels", limit(GL_MAX_TEXTURE_BUFFER_SIZE),
                    "GL_MAX_TEXTURE_BUFFER_SIZE");
    } else {
        const size_t scalar_bytes = static_cast<size_t>(info.scalar_bytes);
        check_limit(what, texels.scalar_count * scalar_bytes, "bytes", most_block_bytes(),
                    "GL_MAX_SHADER_STORAGE_BLOCK_SIZE");
    }

    // Upload.
    const glm::uvec3 size(static_cast<uint32_t>(texel_count), 1, 1);
    Texture texture(std::move(name), GL_TEXTURE_BUFFER, format, size);
    texture.storage_ = make_table(texture.bytes(), texels.data);
    texture.id_ = make_texture(GL_TEXTURE_BUFFER);
    glTexBuffer(GL_TEXTURE_BUFFER, info.internal_format, texture.storage_.id());
    check_gl(fmt::format("uploading {} ({} bytes)", what, texture.bytes()));
    return texture;
}

std::vector<float> read_floats(const Texture& texture) {
    return read_texture<float>(texture, GL_FLOAT);
}

std::vector<uint32_t> read_uints(const Texture& texture) {
    return read_texture<uint32_t>(texture, GL_UNSIGNED_INT);
}

// Buffers ----------------------------------------------------------------------------------------

Buffer::Buffer(std::string name, size_t bytes) : Buffer(std::move(name), bytes, nullptr) {
    glClearBufferData(GL_COPY_WRITE_BUFFER, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, nullptr);
    check_gl(fmt::format("clearing storage buffer '{}'", name_));
}

Buffer::Buffer(std::string name, size_t bytes, const void* data)
    : name_(std::move(name)), bytes_(bytes) {
    constexpr size_t kLeastBytes = 16;
    const std::string what = fmt::format("storage buffer '{}'", name_);
    check_limit(what, bytes, "bytes", most_block_bytes(), "GL_MAX_SHADER_STORAGE_BLOCK_SIZE");
    id_ = bytes == 0 ? make_buffer(kLeastBytes, nullptr) : make_buffer(bytes, data);
    check_gl(fmt::format("uploading {} ({} bytes)", what, bytes));
}

void Buffer::write_bytes(const void* data, size_t bytes) const {
    ONEPASS_CHECK(bytes <= bytes_);
    glBindBuffer(GL_COPY_WRITE_BUFFER, id());
    glBufferSubData(GL_COPY_WRITE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data);
    check_gl(fmt::format("writing storage buffer '{}'", name_));
}

void Buffer::read_bytes(void* data, size_t bytes) const {
    glBindBuffer(GL_COPY_READ_BUFFER, id());
    glGetBufferSubData(GL_COPY_READ_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data);
    check_gl(fmt::format("reading storage buffer '{}'", name_));
}

// Framebuffers -----------------------------------------------------------------------------------

Framebuffer::Framebuffer(uint32_t width, uint32_t height, const std::vector<TexelFormat>& targets)
    : width_(width), height_(height) {
    const int64_t most = std::min(limit(GL_MAX_DRAW_BUFFERS), limit(GL_MAX_COLOR_ATTACHMENTS));
    check_limit("framebuffer", targets.size(), "targets", most, "GL_MAX_DRAW_BUFFERS");

    GLuint id = 0;
    glGenFramebuffers(1, &id);
    id_ = Handle(id, [](GLuint framebuffer) { glDeleteFramebuffers(1, &framebuffer); });
    glBindFramebuffer(GL_FRAMEBUFFER, id);
    std::vector<GLenum> draw_buffers;
    for (const TexelFormat format : targets) {
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(targets_.size());
        targets_.push_back(
            texture_2d(fmt::format("render target {}", targets_.size()), format, width, height));
        glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, targets_.back().id(), 0);
        draw_buffers.push_back(attachment);
    }
    glDrawBuffers(static_cast<GLsizei>(draw_buffers.size()), draw_buffers.data());
    check_gl("making a framebuffer");

    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return;
    throw Error({.where = fmt::format("framebuffer on {}", renderer()),
                 .got = fmt::format("status 0x{:04X}", status),
                 .expected = "a complete framebuffer",
                 .remedy = "The device cannot render to these formats: choose another device."},
                Error::Kind::device);
}

// Launches ---------------------------------------------------------------------------------------

void draw_over(uint32_t width, uint32_t height) {
    // Half of a viewport of twice the size is one triangle. Where that is too large, two are drawn:
    // a software renderer shades the blocks that their common edge crosses for either.
    GLint most[2] = {};
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, most);
    const auto w = static_cast<GLsizei>(width);
    const auto h = static_cast<GLsizei>(height);
    const bool is_one = w <= most[0] / 2 && h <= most[1] / 2;
    glViewport(0, 0, is_one ? 2 * w : w, is_one ? 2 * h : h);

    // A core profile draws nothing without a vertex array, even an empty one.
    GLuint id = 0;
    glGenVertexArrays(1, &id);
    const Handle vertex_array(id, [](GLuint array) { glDeleteVertexArrays(1, &array); });
    glBindVertexArray(id);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, is_one ? 3 : 4);
}

void draw_fullscreen(const Program& program, const Framebuffer& framebuffer) {
    program.use();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    draw_over(framebuffer.width(), framebuffer.height());
    check_gl(fmt::format("drawing with program '{}'", program.name()));
}

void dispatch(const Program& program, const glm::uvec3& groups) {
    constexpr GLenum kLimit = GL_MAX_COMPUTE_WORK_GROUP_COUNT;
    const std::string what = fmt::format("dispatch of program '{}'", program.name());
    for (GLuint axis = 0; axis < 3; ++axis) {
        GLint most = 0;
        glGetIntegeri_v(kLimit, axis, &most);
        check_limit(what, groups[static_cast<int>(axis)], "work groups on one axis", most,
                    "GL_MAX_COMPUTE_WORK_GROUP_COUNT");
    }
    program.use();
    glDispatchCompute(groups.x, groups.y, groups.z);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    check_gl(fmt::format("dispatching program '{}'", program.name()));
}

LaunchTime finish_and_time(const GlContext& context, const std::function<void()>& launch) {
    // llvmpipe's GL_TIME_ELAPSED reads 19 to 60 times too small, and 0 for compute.
    const bool timer = !context.description().software;
    GLuint id = 0;
    if (timer) glGenQueries(1, &id);
    const Handle query(id, [](GLuint q) { glDeleteQueries(1, &q); });

    // Launch. A launch that throws must not leave the query running: no other could begin.
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    if (timer) glBeginQuery(GL_TIME_ELAPSED, id);
    try {
        launch();
    } catch (...) {
        if (timer) glEndQuery(GL_TIME_ELAPSED);
        throw;
    }
    if (timer) glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const auto end = std::chrono::steady_clock::now();

    // Read.
    LaunchTime time;
    time.wall_ms = std::chrono::duration<double, std::milli>(end - start).count();
    time.device_ms = std::numeric_limits<double>::quiet_NaN();
    if (timer) {
        GLuint64 elapsed_ns = 0;
        glGetQueryObjectui64v(id, GL_QUERY_RESULT, &elapsed_ns);
        time.device_ms = 1e-6 * static_cast<double>(elapsed_ns);
    }
    check_gl("timing a launch");
    return time;
}

}  // namespace onepass::gl
