// Programs: compile, link, and what their uniforms, samplers and storage blocks are given.
#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "gpu_glsl/gl/objects.h"

namespace onepass::gl {
namespace {

GLenum stage_type(const std::string& stage) {
    if (stage == "vertex") return GL_VERTEX_SHADER;
    if (stage == "fragment") return GL_FRAGMENT_SHADER;
    ONEPASS_CHECK(stage == "compute");
    return GL_COMPUTE_SHADER;
}

const char* type_name(GLenum type) {
    switch (type) {
        case GL_BOOL:
            return "bool";
        case GL_INT:
            return "int";
        case GL_UNSIGNED_INT:
            return "uint";
        case GL_FLOAT:
            return "float";
        case GL_FLOAT_VEC2:
            return "vec2";
        case GL_FLOAT_VEC3:
            return "vec3";
        case GL_FLOAT_VEC4:
            return "vec4";
        case GL_INT_VEC2:
            return "ivec2";
        case GL_INT_VEC3:
            return "ivec3";
        case GL_UNSIGNED_INT_VEC2:
            return "uvec2";
        case GL_UNSIGNED_INT_VEC3:
            return "uvec3";
        case GL_SAMPLER_2D:
            return "sampler2D";
        case GL_SAMPLER_3D:
            return "sampler3D";
        case GL_SAMPLER_BUFFER:
            return "samplerBuffer";
        case GL_UNSIGNED_INT_SAMPLER_2D:
            return "usampler2D";
        case GL_UNSIGNED_INT_SAMPLER_3D:
            return "usampler3D";
        case GL_UNSIGNED_INT_SAMPLER_BUFFER:
            return "usamplerBuffer";
        case GL_IMAGE_BUFFER:
            return "imageBuffer";
        case GL_UNSIGNED_INT_IMAGE_BUFFER:
            return "uimageBuffer";
        default:
            return "another type";
    }
}

constexpr GLenum kSamplerTypes[] = {GL_SAMPLER_2D,
                                    GL_SAMPLER_3D,
                                    GL_SAMPLER_BUFFER,
                                    GL_UNSIGNED_INT_SAMPLER_2D,
                                    GL_UNSIGNED_INT_SAMPLER_3D,
                                    GL_UNSIGNED_INT_SAMPLER_BUFFER};

constexpr GLenum kImageTypes[] = {GL_IMAGE_BUFFER, GL_UNSIGNED_INT_IMAGE_BUFFER};

bool holds_integers(const Texture& texture) {
    return texture.format() == TexelFormat::r32ui || texture.format() == TexelFormat::rg32ui ||
           texture.format() == TexelFormat::rgba32ui;
}

/// The sampler type that reads a texture.
GLenum sampler_type(const Texture& texture) {
    const bool integers = holds_integers(texture);
    switch (texture.target()) {
        case GL_TEXTURE_2D:
            return integers ? GL_UNSIGNED_INT_SAMPLER_2D : GL_SAMPLER_2D;
        case GL_TEXTURE_3D:
            return integers ? GL_UNSIGNED_INT_SAMPLER_3D : GL_SAMPLER_3D;
        default:
            return integers ? GL_UNSIGNED_INT_SAMPLER_BUFFER : GL_SAMPLER_BUFFER;
    }
}

/// The image type that reads a buffer texture.
GLenum image_type(const Texture& buffer_texture) {
    ONEPASS_CHECK(buffer_texture.buffer_id() != 0);
    return holds_integers(buffer_texture) ? GL_UNSIGNED_INT_IMAGE_BUFFER : GL_IMAGE_BUFFER;
}

Handle compile(const std::string& program_name, const ComposedShader& stage) {
    const GLuint id = glCreateShader(stage_type(stage.stage));
    check_gl(fmt::format("creating the {} shader of program '{}'", stage.stage, program_name));
    Handle shader(id, [](GLuint s) { glDeleteShader(s); });
    const char* text = stage.text.c_str();
    glShaderSource(id, 1, &text, nullptr);
    glCompileShader(id);
    GLint compiled = 0;
    glGetShaderiv(id, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;

    GLint length = 0;
    glGetShaderiv(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
    glGetShaderInfoLog(id, length, nullptr, log.data());
    log.resize(log.find('\0'));
    const std::string place = first_error_place(stage, log);
    const std::string whole =
        fmt::format("the {} shader of program '{}'", stage.stage, program_name);
    throw Error({.where = place.empty() ? whole : place,
                 .got = fmt::format("\n{}", map_errors(stage, log)),
                 .expected = fmt::format("{} to compile", whole),
                 .remedy = "Mend the shader; `onepass shader` prints the composed text."});
}

void link(GLuint id, const std::string& program_name) {
    glLinkProgram(id);
    GLint linked = 0;
    glGetProgramiv(id, GL_LINK_STATUS, &linked);
    if (linked) return;
    GLint length = 0;
    glGetProgramiv(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
    glGetProgramInfoLog(id, length, nullptr, log.data());
    log.resize(log.find('\0'));
    throw Error({.where = fmt::format("linking program '{}'", program_name),
                 .got = fmt::format("\n{}", log),
                 .expected = "stages that fit together",
                 .remedy = "Mend the shaders; `onepass shader` prints the composed text."});
}

/// One property list of one resource of a program's interface (GL 4.3).
GLint resource_property(GLuint program, GLenum interface, GLuint index, GLenum property) {
    GLint value = 0;
    glGetProgramResourceiv(program, interface, index, 1, &property, 1, nullptr, &value);
    return value;
}

/// Names of all resources of one interface, by index.
std::vector<std::string> resource_names(GLuint program, GLenum interface) {
    GLint count = 0;
    glGetProgramInterfaceiv(program, interface, GL_ACTIVE_RESOURCES, &count);
    std::vector<std::string> names;
    for (GLuint index = 0; index < static_cast<GLuint>(count); ++index) {
        const GLint length = resource_property(program, interface, index, GL_NAME_LENGTH);
        std::string name(static_cast<size_t>(length), '\0');
        glGetProgramResourceName(program, interface, index, length, nullptr, name.data());
        name.resize(name.find('\0'));
        names.push_back(name);
    }
    return names;
}

}  // namespace

Program::Program(std::string name, const std::vector<ComposedShader>& stages)
    : name_(std::move(name)) {
    const GLuint id = glCreateProgram();
    id_ = Handle(id, [](GLuint program) { glDeleteProgram(program); });
    std::vector<Handle> shaders;
    for (const ComposedShader& stage : stages) {
        shaders.push_back(compile(name_, stage));
        glAttachShader(id, shaders.back().id());
    }
    link(id, name_);
    for (const Handle& shader : shaders) glDetachShader(id, shader.id());
    read_interface();
    check_gl(fmt::format("making program '{}'", name_));
}

void Program::read_interface() {
    // Uniforms by name; an array goes by its bare name. Each sampler gets a texture unit, each
    // image an image unit.
    glUseProgram(id());
    GLint count = 0;
    GLint longest = 0;
    glGetProgramiv(id(), GL_ACTIVE_UNIFORMS, &count);
    glGetProgramiv(id(), GL_ACTIVE_UNIFORM_MAX_LENGTH, &longest);
    for (GLuint index = 0; index < static_cast<GLuint>(count); ++index) {
        std::string uniform(static_cast<size_t>(longest), '\0');
        Uniform info;
        glGetActiveUniform(id(), index, longest, nullptr, &info.array_size, &info.type,
                           uniform.data());
        uniform.resize(uniform.find('\0'));
        info.location = glGetUniformLocation(id(), uniform.c_str());
        if (info.location < 0) continue;  // a member of a block
        if (uniform.ends_with("[0]")) uniform.resize(uniform.size() - 3);
        if (std::ranges::find(kSamplerTypes, info.type) != std::end(kSamplerTypes)) {
            glUniform1i(info.location, static_cast<GLint>(samplers_.size()));
            samplers_.push_back(uniform);
        }
        if (std::ranges::find(kImageTypes, info.type) != std::end(kImageTypes)) {
            glUniform1i(info.location, static_cast<GLint>(images_.size()));
            images_.push_back(uniform);
        }
        uniforms_[uniform] = info;
    }
    textures_.resize(samplers_.size());
    image_textures_.resize(images_.size());

    // Storage blocks; each gets a binding point.
    if (!GLAD_GL_VERSION_4_3) return;
    blocks_ = resource_names(id(), GL_SHADER_STORAGE_BLOCK);
    for (GLuint index = 0; index < blocks_.size(); ++index) {
        glShaderStorageBlockBinding(id(), index, index);
    }
    buffers_.resize(blocks_.size());
}

const Program::Uniform* Program::find_uniform(const std::string& uniform, Missing missing) const {
    const auto found = uniforms_.find(uniform);
    if (found != uniforms_.end()) return &found->second;
    if (missing == Missing::allowed) return nullptr;
    std::vector<std::string> known;
    for (const auto& [known_name, info] : uniforms_) known.push_back(known_name);
    throw Error(
        {.where = fmt::format("program '{}'", name_),
         .got = fmt::format("no active uniform '{}'", uniform),
         .expected = fmt::format("one of: {}", fmt::join(known, ", ")),
         .remedy = "Declare and use it in the shader; a compiler removes what is not used."});
}

const Program::Uniform* Program::typed_uniform(const std::string& uniform, GLenum type,
                                               size_t count, Missing missing) const {
    const Uniform* info = find_uniform(uniform, missing);
    if (!info) return nullptr;
    if (info->type == type && count <= static_cast<size_t>(info->array_size)) return info;
    throw Error(
        {.where = fmt::format("program '{}', uniform '{}'", name_, uniform),
         .got = fmt::format("{} x {}", count, type_name(type)),
         .expected = fmt::format("at most {} x {}", info->array_size, type_name(info->type)),
         .remedy = "Make the shader's declaration and the C++ side agree."});
}

void Program::set_uniform(const std::string& uniform, bool value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_BOOL, 1, missing);
    glUseProgram(id());
    if (info) glUniform1i(info->location, value ? 1 : 0);
}

void Program::set_uniform(const std::string& uniform, int32_t value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_INT, 1, missing);
    glUseProgram(id());
    if (info) glUniform1i(info->location, value);
}

void Program::set_uniform(const std::string& uniform, uint32_t value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_UNSIGNED_INT, 1, missing);
    glUseProgram(id());
    if (info) glUniform1ui(info->location, value);
}

void Program::set_uniform(const std::string& uniform, float value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_FLOAT, 1, missing);
    glUseProgram(id());
    if (info) glUniform1f(info->location, value);
}

void Program::set_uniform(const std::string& uniform, const glm::vec2& value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_FLOAT_VEC2, 1, missing);
    glUseProgram(id());
    if (info) glUniform2f(info->location, value.x, value.y);
}

void Program::set_uniform(const std::string& uniform, const glm::vec3& value, Missing missing) {
    set_uniform(uniform, std::span(&value, 1), missing);
}

void Program::set_uniform(const std::string& uniform, const glm::vec4& value, Missing missing) {
    set_uniform(uniform, std::span(&value, 1), missing);
}

void Program::set_uniform(const std::string& uniform, const glm::ivec2& value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_INT_VEC2, 1, missing);
    glUseProgram(id());
    if (info) glUniform2i(info->location, value.x, value.y);
}

void Program::set_uniform(const std::string& uniform, const glm::ivec3& value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_INT_VEC3, 1, missing);
    glUseProgram(id());
    if (info) glUniform3i(info->location, value.x, value.y, value.z);
}

void Program::set_uniform(const std::string& uniform, const glm::uvec2& value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_UNSIGNED_INT_VEC2, 1, missing);
    glUseProgram(id());
    if (info) glUniform2ui(info->location, value.x, value.y);
}

void Program::set_uniform(const std::string& uniform, const glm::uvec3& value, Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_UNSIGNED_INT_VEC3, 1, missing);
    glUseProgram(id());
    if (info) glUniform3ui(info->location, value.x, value.y, value.z);
}

void Program::set_uniform(const std::string& uniform, std::span<const glm::vec3> values,
                          Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_FLOAT_VEC3, values.size(), missing);
    if (!info || values.empty()) return;
    glUseProgram(id());
    glUniform3fv(info->location, static_cast<GLsizei>(values.size()), &values[0].x);
}

void Program::set_uniform(const std::string& uniform, std::span<const glm::vec4> values,
                          Missing missing) {
    const Uniform* info = typed_uniform(uniform, GL_FLOAT_VEC4, values.size(), missing);
    if (!info || values.empty()) return;
    glUseProgram(id());
    glUniform4fv(info->location, static_cast<GLsizei>(values.size()), &values[0].x);
}

void Program::set_texture(const std::string& sampler, const Texture& texture, Missing missing) {
    const auto image = std::ranges::find(images_, sampler);
    if (image != images_.end()) {
        typed_uniform(sampler, image_type(texture), 1, missing);
        image_textures_[static_cast<size_t>(image - images_.begin())] = {texture.id(),
                                                                         texture.gl_format()};
        return;
    }
    if (!typed_uniform(sampler, sampler_type(texture), 1, missing)) return;
    const auto unit = std::ranges::find(samplers_, sampler) - samplers_.begin();
    textures_[static_cast<size_t>(unit)] = {texture.target(), texture.id()};
}

void Program::set_buffer(const std::string& block, const Buffer& buffer, Missing missing) {
    set_block(block, buffer.id(), missing);
}

void Program::set_buffer(const std::string& block, const Texture& buffer_texture, Missing missing) {
    ONEPASS_CHECK(buffer_texture.buffer_id() != 0);
    if (missing == Missing::allowed && std::ranges::find(blocks_, block) == blocks_.end()) return;
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (buffer_texture.bytes() > static_cast<size_t>(most)) {
        throw Error({.where = fmt::format("storage block '{}' of program '{}'", block, name_),
                     .got = fmt::format("{} bytes", buffer_texture.bytes()),
                     .expected = fmt::format("at most {} (GL_MAX_SHADER_STORAGE_BLOCK_SIZE)", most),
                     .remedy = "Take the storage 'buffer', or lower --param density."},
                    Error::Kind::device);
    }
    set_block(block, buffer_texture.buffer_id(), missing);
}

void Program::set_block(const std::string& block, GLuint buffer, Missing missing) {
    const auto found = std::ranges::find(blocks_, block);
    if (found != blocks_.end()) {
        buffers_[static_cast<size_t>(found - blocks_.begin())] = buffer;
        return;
    }
    if (missing == Missing::allowed) return;
    throw Error(
        {.where = fmt::format("program '{}'", name_),
         .got = fmt::format("no active storage block '{}'", block),
         .expected = fmt::format("one of: {}", fmt::join(blocks_, ", ")),
         .remedy = "Declare and use it in the shader; a compiler removes what is not used."});
}

void Program::use() const {
    const auto nothing_given = [&](const std::string& what) {
        return Error({.where = fmt::format("program '{}'", name_),
                      .got = fmt::format("nothing for {}", what),
                      .expected =
                          "a texture for every sampler and image, a buffer for every storage "
                          "block",
                      .remedy = "Call set_texture or set_buffer before the launch."});
    };
    glUseProgram(id());
    for (size_t unit = 0; unit < textures_.size(); ++unit) {
        if (textures_[unit].texture == 0) throw nothing_given("sampler " + samplers_[unit]);
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(textures_[unit].target, textures_[unit].texture);
    }
    for (size_t unit = 0; unit < image_textures_.size(); ++unit) {
        const ImageBinding& image = image_textures_[unit];
        if (image.texture == 0) throw nothing_given("image " + images_[unit]);
        glBindImageTexture(static_cast<GLuint>(unit), image.texture, 0, GL_FALSE, 0, GL_READ_ONLY,
                           image.format);
    }
    for (size_t binding = 0; binding < buffers_.size(); ++binding) {
        if (buffers_[binding] == 0) throw nothing_given("storage block " + blocks_[binding]);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(binding), buffers_[binding]);
    }
}

glm::uvec3 Program::work_group_size() const {
    GLint size[3] = {};
    glGetProgramiv(id(), GL_COMPUTE_WORK_GROUP_SIZE, size);
    check_gl("reading the work group size of " + name_);
    return glm::uvec3(size[0], size[1], size[2]);
}

std::map<std::string, Program::Member> Program::block_members() const {
    std::map<std::string, Member> members;
    if (!GLAD_GL_VERSION_4_3) return members;
    const std::vector<std::string> names = resource_names(id(), GL_BUFFER_VARIABLE);
    for (GLuint index = 0; index < names.size(); ++index) {
        const auto property = [&](GLenum name) {
            return resource_property(id(), GL_BUFFER_VARIABLE, index, name);
        };
        members[names[index]] = {.offset = property(GL_OFFSET),
                                 .array_stride = property(GL_ARRAY_STRIDE),
                                 .top_level_array_stride = property(GL_TOP_LEVEL_ARRAY_STRIDE)};
    }
    return members;
}

}  // namespace onepass::gl
