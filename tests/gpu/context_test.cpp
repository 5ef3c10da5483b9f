// Contexts: what they say of themselves, and the rules between them. ONEPASS_GL names the kind; the
// suite is run once a kind.
#include "gpu_glsl/gl/context.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/gl_fixture.h"

namespace onepass::gl {
namespace {

using ContextTest = test::GlTest;

TEST_F(ContextTest, a_context_describes_itself) {
    const GlDescription& description = context->description();
    const std::string wanted = test::environment("ONEPASS_GL", "osmesa");
    if (wanted != "auto") {
        EXPECT_EQ(description.kind, wanted);
    }
    EXPECT_FALSE(description.vendor.empty());
    EXPECT_FALSE(description.renderer.empty());
    EXPECT_FALSE(description.glsl_version.empty());
    EXPECT_GE(description.gl, 330);
    EXPECT_EQ(std::to_string(description.gl / 100), description.version.substr(0, 1));
    EXPECT_EQ(description.software, is_software_renderer(description.renderer));
    RecordProperty("renderer", description.renderer);
    RecordProperty("version", description.version);
}

TEST_F(ContextTest, limits_are_at_least_what_opengl_promises) {
    const GlLimits& limits = context->limits();
    EXPECT_GE(limits.max_texture_size, 1024);
    EXPECT_GE(limits.max_3d_texture_size, 256);
    EXPECT_GE(limits.max_texture_buffer_size, 65536);
    EXPECT_GE(limits.max_texture_units, 16);
    EXPECT_GE(limits.max_draw_buffers, 8);
    if (context->description().gl < 430) GTEST_SKIP() << "no compute shaders here";
    EXPECT_GE(limits.max_ssbo_bytes, 1 << 24);
    EXPECT_GE(limits.max_compute_ssbos, 8);
    EXPECT_GE(limits.max_compute_work_groups_x, 65535);
    EXPECT_GE(limits.max_compute_work_groups_y, 65535);
    EXPECT_GE(limits.max_compute_work_groups_z, 65535);
    EXPECT_GE(limits.max_compute_invocations, 1024);
}

TEST_F(ContextTest, a_second_context_of_the_same_kind_works_and_another_kind_is_refused) {
    const std::string kind = context->description().kind;
    const auto second = make_context(kind);
    EXPECT_EQ(second->description().renderer, context->description().renderer);
    EXPECT_EQ(make_context("auto")->description().kind, kind);

    const std::string other = kind == "osmesa" ? "egl" : "osmesa";
    try {
        make_context(other);
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::input);
        EXPECT_EQ(error.parts().got, "kind " + other + " in a process that uses " + kind);
    }
    context->make_current();
}

TEST(Context, an_unknown_kind_is_bad_input) {
    try {
        make_context("vulkan");
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::input);
        EXPECT_EQ(error.parts().got, "\"vulkan\"");
    }
}

TEST(Context, a_device_asked_of_osmesa_is_bad_input) {
    EXPECT_THROW(make_context("osmesa", 0), Error);
}

// In a process of its own: probing makes a context of each kind. It ends by _Exit, because what the
// drivers leave allocated is not ours to check.
TEST(ContextProbe, each_way_to_a_context_is_usable_or_says_why_not) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto probe_and_exit = [] {
        bool good = true;
        for (const GlProbe& probe : probe_contexts()) {
            std::fprintf(stderr, "%s | %s | %s | %s | %s\n", probe.kind.c_str(), probe.name.c_str(),
                         probe.renderer.c_str(), probe.version.c_str(), probe.problem.c_str());
            good = good && probe.usable == probe.problem.empty();
            good = good && probe.usable == !probe.renderer.empty();
            good = good && !probe.name.empty();
        }
        std::_Exit(good ? 0 : 1);
    };
    EXPECT_EXIT(probe_and_exit(), ::testing::ExitedWithCode(0), "osmesa.*");
}

// What an EGL device number that is not there gives. In a process of its own: the number may be
// refused only by a process that may use EGL.
TEST(ContextProbe, a_device_number_that_is_not_there_is_a_device_error) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto ask_and_exit = [] {
        try {
            make_egl_context(1000);
        } catch (const Error& error) {
            std::fprintf(stderr, "%s\n", error.what());
            std::_Exit(error.kind() == Error::Kind::device ? 0 : 1);
        }
        std::_Exit(2);
    };
    EXPECT_EXIT(ask_and_exit(), ::testing::ExitedWithCode(0), "");
}

TEST(Context, software_renderers_are_recognised_by_name) {
    EXPECT_TRUE(is_software_renderer("llvmpipe (LLVM 15.0.6, 256 bits)"));
    EXPECT_TRUE(is_software_renderer("softpipe"));
    EXPECT_TRUE(is_software_renderer("Google SwiftShader"));
    EXPECT_FALSE(is_software_renderer("NVIDIA H100 80GB HBM3/PCIe/SSE2"));
}

}  // namespace
}  // namespace onepass::gl
