// A GL context for tests: one a process, of the kind that ONEPASS_GL names (osmesa, egl or auto;
// osmesa if unset). Without one a test is skipped with the reason; ONEPASS_REQUIRE_GL=1 turns that
// skip into a failure.
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu_glsl/gl/context.h"

namespace onepass::test {

inline std::string environment(const char* name, const char* fallback) {
    const char* value = std::getenv(name);
    return value && *value ? value : fallback;
}

struct SharedContext {
    std::shared_ptr<gl::GlContext> context;
    std::string problem;  ///< why there is none
};

/// Made at the first call, kept until the process ends.
inline const SharedContext& shared_gl_context() {
    static const SharedContext shared = [] {
        SharedContext made;
        try {
            made.context = gl::make_context(environment("ONEPASS_GL", "osmesa"));
        } catch (const Error& error) {
            made.problem = error.what();
        }
        return made;
    }();
    return shared;
}

/// Base of every test suite that needs a context.
class GlTest : public ::testing::Test {
  protected:
    void SetUp() override {
        context = shared_gl_context().context;
        if (context) {
            context->make_current();
            return;
        }
        const std::string& problem = shared_gl_context().problem;
        if (environment("ONEPASS_REQUIRE_GL", "0") == "1") FAIL() << problem;
        GTEST_SKIP() << problem;
    }

    std::shared_ptr<gl::GlContext> context;
};

}  // namespace onepass::test
