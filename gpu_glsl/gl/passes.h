// What a tracer of many passes needs beside objects.h: targets that share textures, masks in the
// depth buffer, counts of samples, and dispatches whose size the GPU decides.
//
// Every function leaves the depth state as OpenGL's defaults have it, so that single-pass tracers
// can run in between.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu_glsl/gl/objects.h"

namespace onepass::gl {

/// A depth buffer of 32-bit floats, which holds any depth exactly.
class DepthBuffer {
  public:
    /// Throws: Error if the device cannot hold it.
    DepthBuffer(uint32_t width, uint32_t height);

    GLuint id() const { return id_.id(); }

  private:
    Handle id_;
};

/// Textures and a depth buffer that are drawn into together. Owns none of them, unlike Framebuffer:
/// the same texture may belong to several targets.
class PassTarget {
  public:
    /// The fragment output at location i goes to `by_location[i]`, or nowhere for a null pointer.
    /// All have one size and must outlive the target. `depth` may be null. Throws: Error if the
    /// device has fewer locations, or cannot draw into these together.
    PassTarget(const std::vector<const Texture*>& by_location, const DepthBuffer* depth);

    GLuint id() const { return id_.id(); }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

    /// Sets the whole texture of unsigned integers at `location` to 0.
    void clear_uints(uint32_t location) const;

  private:
    uint32_t width_ = 0;
    uint32_t height_ = 0;
    Handle id_;
};

/// How a pass uses the depth buffer.
enum class DepthUse {
    none,
    write,       ///< the fragment's depth replaces what is there
    only_equal,  ///< only fragments whose pixel holds the pass's depth run; nothing is written
};

/// Draws over the whole target, at depth `depth` (objects.h: draw_over).
void draw_pass(const Program& program, const PassTarget& target, DepthUse use, float depth = 0.0f);

/// An occlusion query: counts the samples of the draws between begin() and end() that pass the
/// depth test. One at a time.
class SampleCount {
  public:
    SampleCount();

    void begin() const;
    void end() const;
    /// Waits for the draws to finish.
    uint64_t result() const;

  private:
    Handle id_;
};

/// Runs as many groups as three integers at `offset` bytes in `arguments` say. No barrier follows.
void dispatch_indirect(const Program& program, const Buffer& arguments, size_t offset);

/// Makes the writes of all dispatches so far visible to everything that follows.
void barrier();

/// Sets a buffer to 0.
void clear(const Buffer& buffer);

}  // namespace onepass::gl
