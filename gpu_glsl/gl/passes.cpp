#include "gpu_glsl/gl/passes.h"

#include <fmt/format.h>

#include "core/error.h"

namespace onepass::gl {
DepthBuffer::DepthBuffer(uint32_t width, uint32_t height) {
    GLuint id = 0;
    glGenRenderbuffers(1, &id);
    id_ = Handle(id, [](GLuint buffer) { glDeleteRenderbuffers(1, &buffer); });
    glBindRenderbuffer(GL_RENDERBUFFER, id);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(width),
                          static_cast<GLsizei>(height));
    check_gl(fmt::format("making a depth buffer of {} x {}", width, height));
}

PassTarget::PassTarget(const std::vector<const Texture*>& by_location, const DepthBuffer* depth) {
    // Check.
    GLint most = 0;
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &most);
    if (by_location.size() > static_cast<size_t>(most)) {
        throw Error({.where = "the targets of a pass",
                     .got = fmt::format("{} outputs", by_location.size()),
                     .expected = fmt::format("at most {} (GL_MAX_DRAW_BUFFERS)", most),
                     .remedy = "Choose another device."},
                    Error::Kind::device);
    }

    // Attach.
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    id_ = Handle(id, [](GLuint framebuffer) { glDeleteFramebuffers(1, &framebuffer); });
    glBindFramebuffer(GL_FRAMEBUFFER, id);
    std::vector<GLenum> draw_buffers;
    for (const Texture* texture : by_location) {
        if (texture == nullptr) {
            draw_buffers.push_back(GL_NONE);
            continue;
        }
        width_ = texture->size().x;
        height_ = texture->size().y;
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draw_buffers.size());
        glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture->id(), 0);
        draw_buffers.push_back(attachment);
    }
    glDrawBuffers(static_cast<GLsizei>(draw_buffers.size()), draw_buffers.data());
    if (depth != nullptr) {
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                  depth->id());
    }
    check_gl("making the target of a pass");
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return;
    throw Error({.where = "the targets of a pass",
                 .got = fmt::format("framebuffer status 0x{:04X}", status),
                 .expected = "a complete framebuffer",
                 .remedy = "The device cannot render to these formats: choose another device."},
                Error::Kind::device);
}

void PassTarget::clear_uints(uint32_t location) const {
    constexpr GLuint kZero[4] = {};
    glBindFramebuffer(GL_FRAMEBUFFER, id());
    glClearBufferuiv(GL_COLOR, static_cast<GLint>(location), kZero);
    check_gl("clearing the target of a pass");
}

void draw_pass(const Program& program, const PassTarget& target, DepthUse use, float depth) {
    program.use();
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());

    // What is drawn has depth 0 in clip space; an empty depth range maps that to the one wanted.
    if (use != DepthUse::none) glEnable(GL_DEPTH_TEST);
    if (use == DepthUse::write) glDepthFunc(GL_ALWAYS);
    if (use == DepthUse::only_equal) {
        glDepthFunc(GL_EQUAL);
        glDepthMask(GL_FALSE);
        glDepthRange(static_cast<GLdouble>(depth), static_cast<GLdouble>(depth));
    }

    draw_over(target.width(), target.height());

    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDepthRange(0.0, 1.0);
    check_gl(fmt::format("drawing a pass of program '{}'", program.name()));
}

SampleCount::SampleCount() {
    GLuint id = 0;
    glGenQueries(1, &id);
    id_ = Handle(id, [](GLuint query) { glDeleteQueries(1, &query); });
}

void SampleCount::begin() const { glBeginQuery(GL_SAMPLES_PASSED, id_.id()); }

void SampleCount::end() const { glEndQuery(GL_SAMPLES_PASSED); }

uint64_t SampleCount::result() const {
    GLuint64 samples = 0;
    glGetQueryObjectui64v(id_.id(), GL_QUERY_RESULT, &samples);
    check_gl("reading a count of samples");
    return samples;
}

void dispatch_indirect(const Program& program, const Buffer& arguments, size_t offset) {
    program.use();
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, arguments.id());
    glDispatchComputeIndirect(static_cast<GLintptr>(offset));
    check_gl(fmt::format("dispatching program '{}'", program.name()));
}

void barrier() { glMemoryBarrier(GL_ALL_BARRIER_BITS); }

void clear(const Buffer& buffer) {
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffer.id());
    glClearBufferData(GL_COPY_WRITE_BUFFER, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, nullptr);
    check_gl(fmt::format("clearing storage buffer '{}'", buffer.name()));
}

}  // namespace onepass::gl
