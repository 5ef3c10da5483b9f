// GL objects against a real context: what goes in comes out, and what cannot be is said aloud.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/types.h"
#include "gpu_glsl/gl/objects.h"
#include "tests/support/gl_fixture.h"

namespace onepass::gl {
namespace {

constexpr uint32_t kWidth = 5;  // odd sizes: rows that are not multiples of four bytes
constexpr uint32_t kHeight = 3;

std::vector<float> ramp(size_t count, float step = 0.5f) {
    std::vector<float> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = step * static_cast<float>(i) - 1.0f;
    return values;
}

std::vector<uint32_t> large_numbers(size_t count) {
    std::vector<uint32_t> values(count);
    std::iota(values.begin(), values.end(), 0xFFFFFF00u);
    return values;
}

class GlObjects : public test::GlTest {
  protected:
    ComposedShader compose(const std::string& stage, const std::string& entry,
                           const std::vector<ShaderConstant>& constants = {}) const {
        const int version = stage == "compute" ? 430 : 330;
        return library.compose({version, stage, {entry}, constants});
    }

    Program fragment_program(const std::string& entry) const {
        return Program(entry,
                       {compose("vertex", "entry/fullscreen.glsl"), compose("fragment", entry)});
    }

    ShaderLibrary library = ShaderLibrary::from_directory(ONEPASS_SOURCE_DIR "/tests/gpu/shaders");
};

/// Tests that need OpenGL 4.3.
class GlCompute : public GlObjects {
  protected:
    void SetUp() override {
        GlObjects::SetUp();
        if (context && context->description().gl < 430) GTEST_SKIP() << "no compute shaders here";
    }
};

/// The Error that `action` throws.
template <class Action>
Error::Parts error_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.parts();
    }
    ADD_FAILURE() << "did not throw";
    return {};
}

// Textures and buffers ---------------------------------------------------------------------------

TEST_F(GlObjects, float_textures_read_back_bit_by_bit) {
    const std::vector<float> values = ramp(kWidth * kHeight, 1.0f / 3.0f);
    EXPECT_EQ(read_floats(texture_2d("t", TexelFormat::r32f, kWidth, kHeight, values)), values);

    const std::vector<float> volume = ramp(kWidth * kHeight * 2 * 4, 1.0f / 3.0f);
    const Texture texture = texture_3d("t", TexelFormat::rgba32f, {kWidth, kHeight, 2}, volume);
    EXPECT_EQ(read_floats(texture), volume);
    EXPECT_EQ(texture.bytes(), volume.size() * sizeof(float));
}

TEST_F(GlObjects, vectors_of_glm_vectors_upload_as_their_components) {
    const std::vector<glm::vec4> values = {{1, 2, 3, 4}, {5, 6, 7, 8}};
    EXPECT_EQ(read_floats(texture_2d("t", TexelFormat::rgba32f, 2, 1, values)),
              (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(GlObjects, integer_textures_keep_all_32_bits) {
    const std::vector<uint32_t> values = large_numbers(kWidth * kHeight);
    EXPECT_EQ(read_uints(texture_2d("t", TexelFormat::r32ui, kWidth, kHeight, values)), values);
}

TEST_F(GlObjects, a_16_bit_texture_takes_floats_or_ready_halves) {
    const std::vector<float> floats = {1.0f, -2.0f, 0.5f, 2048.0f};
    const std::vector<Half> halves = {{0x3C00}, {0xC000}, {0x3800}, {0x6800}};
    EXPECT_EQ(read_floats(texture_2d("t", TexelFormat::rg16f, 2, 1, floats)), floats);
    EXPECT_EQ(read_floats(texture_2d("t", TexelFormat::rg16f, 2, 1, halves)), floats);
    EXPECT_EQ(bytes_per_texel(TexelFormat::rg16f), 4u);
}

TEST_F(GlObjects, a_texture_over_the_limit_names_size_and_limit) {
    const auto limit = static_cast<uint32_t>(context->limits().max_texture_size);
    const Error::Parts parts =
        error_of([&] { texture_2d("triangles", TexelFormat::r32f, limit + 1, 1); });
    EXPECT_NE(parts.where.find("'triangles'"), std::string::npos);
    EXPECT_EQ(parts.got, std::to_string(limit + 1) + " texels a side");
    EXPECT_EQ(parts.expected, "at most " + std::to_string(limit) + " (GL_MAX_TEXTURE_SIZE)");

    const auto limit_3d = static_cast<uint32_t>(context->limits().max_3d_texture_size);
    EXPECT_EQ(error_of([&] {
                  texture_3d("cells", TexelFormat::r32f, {1, 1, limit_3d + 1});
              }).got,
              std::to_string(limit_3d + 1) + " texels a side");
}

TEST_F(GlCompute, a_storage_buffer_reads_back_what_it_was_given) {
    const std::vector<uint32_t> values = large_numbers(1000);
    EXPECT_EQ(Buffer::of("values", values).read<uint32_t>(), values);
    EXPECT_EQ(Buffer("zeros", 12).read<uint32_t>(), std::vector<uint32_t>(3, 0));
    EXPECT_TRUE(Buffer::of("none", std::vector<uint32_t>{}).read<uint32_t>().empty());
}

TEST_F(GlCompute, a_storage_buffer_over_the_limit_is_an_error) {
    const auto limit = static_cast<size_t>(context->limits().max_ssbo_bytes);
    if (limit > (size_t{1} << 28)) GTEST_SKIP() << "the limit is beyond this test's memory";
    EXPECT_EQ(error_of([&] { Buffer("rays", limit + 1); }).expected,
              "at most " + std::to_string(limit) + " (GL_MAX_SHADER_STORAGE_BLOCK_SIZE)");
}

// Draws ------------------------------------------------------------------------------------------

TEST_F(GlObjects, a_draw_fills_float_and_integer_targets_together) {
    const std::vector<float> values = ramp(kWidth * kHeight * 4);
    const Texture table = texture_2d("table", TexelFormat::rgba32f, kWidth, kHeight, values);
    Program program = fragment_program("entry/two_targets.glsl");
    program.set_texture("table", table);
    program.set_uniform("scale", glm::vec3(1.0f, 2.0f, -3.0f));
    program.set_uniform("image_width", static_cast<int>(kWidth));
    const Framebuffer framebuffer(kWidth, kHeight, {TexelFormat::rgba32f, TexelFormat::rgba32ui});
    draw_fullscreen(program, framebuffer);

    const std::vector<float> floats = read_floats(framebuffer.target(0));
    const std::vector<uint32_t> uints = read_uints(framebuffer.target(1));
    for (uint32_t pixel = 0; pixel < kWidth * kHeight; ++pixel) {
        EXPECT_EQ(floats[4 * pixel], values[4 * pixel]);
        EXPECT_EQ(floats[4 * pixel + 1], values[4 * pixel + 1] * 2.0f);
        EXPECT_EQ(floats[4 * pixel + 2], values[4 * pixel + 2] * -3.0f);
        EXPECT_EQ(floats[4 * pixel + 3], values[4 * pixel + 3]);
        EXPECT_EQ(uints[4 * pixel], pixel);
        EXPECT_EQ(uints[4 * pixel + 1], 0xFFFFFFFFu);
        EXPECT_EQ(uints[4 * pixel + 2], pixel % kWidth);
        EXPECT_EQ(uints[4 * pixel + 3], pixel / kWidth);
    }
}

TEST_F(GlObjects, a_draw_fills_targets_of_any_size) {
    const auto most = static_cast<uint32_t>(context->limits().max_texture_size);
    const uint32_t half = most / 2;
    const Texture table = texture_2d("table", TexelFormat::rgba32f, 1, 1, std::vector<float>(4));
    Program program = fragment_program("entry/two_targets.glsl");
    program.set_texture("table", table);
    program.set_uniform("scale", glm::vec3(1.0f));
    for (const glm::uvec2& size :
         {glm::uvec2(half, 2), glm::uvec2(half + 1, 2), glm::uvec2(most, 1),
          glm::uvec2(3, half + 1), glm::uvec2(1, most)}) {
        program.set_uniform("image_width", static_cast<int>(size.x));
        const Framebuffer framebuffer(size.x, size.y,
                                      {TexelFormat::rgba32f, TexelFormat::rgba32ui});
        draw_fullscreen(program, framebuffer);
        const std::vector<uint32_t> uints = read_uints(framebuffer.target(1));
        for (uint32_t pixel = 0; pixel < size.x * size.y; ++pixel) {
            ASSERT_EQ(uints[4 * pixel], pixel) << size.x << " x " << size.y;
        }
    }
}

TEST_F(GlObjects, every_kind_of_table_is_read_at_its_texel) {
    constexpr uint32_t kTexels = kWidth * kHeight;
    const std::vector<float> volume = ramp(2 * kTexels);
    const std::vector<float> halves = ramp(2 * kTexels, 0.25f);
    const std::vector<float> floats = ramp(kTexels, 1.0f / 3.0f);
    const std::vector<uint32_t> uints = large_numbers(kTexels);
    const Texture textures[] = {
        texture_3d("volume", TexelFormat::r16f, {kWidth, kHeight, 2}, volume),
        texture_2d("halves", TexelFormat::rg16f, kWidth, kHeight, halves),
        texture_buffer("floats", TexelFormat::r32f, floats),
        texture_buffer("uints", TexelFormat::r32ui, uints)};
    Program program = fragment_program("entry/fetch_all.glsl");
    for (const Texture& texture : textures) program.set_texture(texture.name(), texture);
    program.set_uniform("image_size", glm::ivec2(kWidth, kHeight));
    const Framebuffer framebuffer(kWidth, kHeight, {TexelFormat::rgba32f, TexelFormat::rgba32ui});
    draw_fullscreen(program, framebuffer);

    const std::vector<float> got_floats = read_floats(framebuffer.target(0));
    const std::vector<uint32_t> got_uints = read_uints(framebuffer.target(1));
    for (uint32_t i = 0; i < kTexels; ++i) {
        EXPECT_EQ(got_floats[4 * i], volume[kTexels + i]);
        EXPECT_EQ(got_floats[4 * i + 1], halves[2 * i]);
        EXPECT_EQ(got_floats[4 * i + 2], halves[2 * i + 1]);
        EXPECT_EQ(got_floats[4 * i + 3], floats[i]);
        EXPECT_EQ(got_uints[4 * i], uints[i]);
    }
}

TEST_F(GlCompute, buffer_textures_are_loaded_as_images) {
    const std::vector<float> floats = ramp(4 * kWidth);
    const std::vector<uint32_t> uints = {7, 0, 5, 100, 3};
    const Texture vectors = texture_buffer("vectors", TexelFormat::rgba32f, floats);
    const Texture words = texture_buffer("words", TexelFormat::r32ui, uints);
    const Buffer sums("sums", floats.size() * sizeof(float));
    Program program("images", {compose("compute", "entry/images.glsl")});
    program.set_texture("vectors", vectors);
    program.set_buffer("Sums", sums);
    EXPECT_EQ(error_of([&] { dispatch(program, {kWidth, 1, 1}); }).got, "nothing for image words");
    EXPECT_EQ(error_of([&] { program.set_texture("words", vectors); }).got, "1 x imageBuffer");
    program.set_texture("words", words);
    dispatch(program, {kWidth, 1, 1});
    const std::vector<float> got = sums.read<float>();
    for (size_t i = 0; i < got.size(); ++i) {
        EXPECT_EQ(got[i], floats[i] + static_cast<float>(uints[i / 4])) << i;
    }
}

TEST_F(GlObjects, interleaved_programs_each_keep_their_textures) {
    const Framebuffer framebuffer(1, 1, {TexelFormat::rgba32f, TexelFormat::rgba32ui});
    const auto make = [&](const Texture& table) {
        Program program = fragment_program("entry/two_targets.glsl");
        program.set_texture("table", table);
        program.set_uniform("scale", glm::vec3(1.0f));
        program.set_uniform("image_width", 1);
        return program;
    };
    const Texture first_table =
        texture_2d("a", TexelFormat::rgba32f, 1, 1, std::vector<float>(4, 1));
    const Texture second_table =
        texture_2d("b", TexelFormat::rgba32f, 1, 1, std::vector<float>(4, 2));
    const Program first = make(first_table);
    const Program second = make(second_table);
    for (int round = 0; round < 2; ++round) {
        draw_fullscreen(first, framebuffer);
        EXPECT_EQ(read_floats(framebuffer.target(0))[0], 1.0f);
        draw_fullscreen(second, framebuffer);
        EXPECT_EQ(read_floats(framebuffer.target(0))[0], 2.0f);
    }
}

TEST_F(GlObjects, too_many_render_targets_are_an_error) {
    const auto limit = static_cast<size_t>(context->limits().max_draw_buffers);
    const std::vector<TexelFormat> targets(limit + 1, TexelFormat::rgba32f);
    EXPECT_EQ(error_of([&] { Framebuffer(1, 1, targets); }).got,
              std::to_string(limit + 1) + " targets");
}

// Compute ----------------------------------------------------------------------------------------

struct Pair {
    glm::vec4 value;
    glm::uvec4 id;
};

TEST_F(GlCompute, a_dispatch_changes_a_storage_buffer) {
    constexpr uint32_t kPairs = 1000;
    std::vector<Pair> pairs(kPairs);
    for (uint32_t i = 0; i < kPairs; ++i)
        pairs[i] = {glm::vec4(0.5f * static_cast<float>(i)), glm::uvec4(i)};
    const Buffer buffer = Buffer::of("pairs", pairs);
    Program program("double_values",
                    {compose("compute", "entry/double_values.glsl", {{"id_offset", 7u}})});
    program.set_buffer("Pairs", buffer);
    program.set_uniform("pair_count", kPairs - 1);
    dispatch(program, {(kPairs + 63) / 64, 1, 1});

    const std::vector<Pair> result = buffer.read<Pair>();
    for (uint32_t i = 0; i < kPairs - 1; ++i) {
        EXPECT_EQ(result[i].value, glm::vec4(static_cast<float>(i)));
        EXPECT_EQ(result[i].id, glm::uvec4(i + 7));
    }
    EXPECT_EQ(result.back().id, glm::uvec4(kPairs - 1)) << "beyond pair_count nothing may change";
}

TEST_F(GlCompute, the_drivers_layout_of_a_storage_block_is_told) {
    const Program program("double_values",
                          {compose("compute", "entry/double_values.glsl", {{"id_offset", 7u}})});
    const auto members = program.block_members();
    ASSERT_TRUE(members.contains("pairs[0].id"));
    EXPECT_EQ(members.at("pairs[0].id").offset, static_cast<int>(offsetof(Pair, id)));
    EXPECT_EQ(members.at("pairs[0].id").top_level_array_stride, static_cast<int>(sizeof(Pair)));
}

TEST_F(GlCompute, generated_float_constants_arrive_with_the_same_bits) {
    const std::vector<float> values = {1.004f, 1.0f / 3.0f, kInfinity};
    const Buffer buffer("bits", 3 * sizeof(uint32_t));
    Program program("float_bits",
                    {compose("compute", "entry/float_bits.glsl",
                             {{"first", values[0]}, {"second", values[1]}, {"third", values[2]}})});
    program.set_buffer("Bits", buffer);
    dispatch(program, {1, 1, 1});
    EXPECT_EQ(buffer.read<float>(), values);
}

TEST_F(GlCompute, too_many_work_groups_are_an_error) {
    const Buffer buffer("bits", 3 * sizeof(uint32_t));
    Program program("float_bits", {compose("compute", "entry/float_bits.glsl",
                                           {{"first", 0.0f}, {"second", 0.0f}, {"third", 0.0f}})});
    program.set_buffer("Bits", buffer);
    const auto limit = static_cast<uint32_t>(context->limits().max_compute_work_groups_y);
    EXPECT_NE(error_of([&] {
                  dispatch(program, {1, limit + 1, 1});
              }).expected.find("GL_MAX_COMPUTE_WORK_GROUP_COUNT"),
              std::string::npos);
}

TEST_F(GlObjects, a_launch_is_timed_by_the_clock_and_by_the_device_only_where_it_can) {
    int launches = 0;
    const LaunchTime time = finish_and_time(*context, [&] { ++launches; });
    EXPECT_EQ(launches, 1);
    EXPECT_GE(time.wall_ms, 0.0);
    EXPECT_EQ(std::isnan(time.device_ms), context->description().software);
}

// What is said aloud -----------------------------------------------------------------------------

TEST_F(GlObjects, a_missing_uniform_or_sampler_is_an_error_unless_allowed) {
    Program program = fragment_program("entry/two_targets.glsl");
    const Error::Parts parts = error_of([&] { program.set_uniform("skale", 1.0f); });
    EXPECT_EQ(parts.got, "no active uniform 'skale'");
    EXPECT_EQ(parts.expected, "one of: image_width, scale, table");
    const Texture texture = texture_2d("t", TexelFormat::r32f, 1, 1);
    EXPECT_THROW(program.set_texture("tabel", texture), Error);
    EXPECT_NO_THROW(program.set_uniform("skale", 1.0f, Missing::allowed));
    EXPECT_NO_THROW(program.set_texture("tabel", texture, Missing::allowed));
}

TEST_F(GlCompute, a_missing_storage_block_is_an_error_unless_allowed) {
    Program program = fragment_program("entry/two_targets.glsl");
    const Buffer buffer("b", 16);
    EXPECT_THROW(program.set_buffer("Pears", buffer), Error);
    EXPECT_NO_THROW(program.set_buffer("Pears", buffer, Missing::allowed));
}

TEST_F(GlObjects, a_uniform_of_another_type_is_an_error) {
    Program program = fragment_program("entry/two_targets.glsl");
    EXPECT_EQ(error_of([&] { program.set_uniform("image_width", 1.0f); }).got, "1 x float");
    EXPECT_EQ(error_of([&] { program.set_uniform("scale", 1.0f); }).expected, "at most 1 x vec3");
    const Texture integers = texture_2d("t", TexelFormat::r32ui, 1, 1);
    EXPECT_EQ(error_of([&] { program.set_texture("table", integers); }).got, "1 x usampler2D");
}

TEST_F(GlObjects, a_region_is_replaced_and_nothing_else) {
    const Texture plane =
        texture_2d("plane", TexelFormat::rg16f, kWidth, kHeight, ramp(2 * kWidth * kHeight));
    update_region(plane, {1, 2, 0}, {3, 1, 1}, ramp(6, 8.0f));
    std::vector<float> expected = ramp(2 * kWidth * kHeight);
    std::ranges::copy(ramp(6, 8.0f), expected.begin() + 2 * (2 * kWidth + 1));
    EXPECT_EQ(read_floats(plane), expected);

    constexpr uint32_t kDepth = 4;
    const size_t texels = kWidth * kHeight * kDepth;
    const Texture box =
        texture_3d("box", TexelFormat::rgba32f, {kWidth, kHeight, kDepth}, ramp(4 * texels));
    update_region(box, {2, 1, 1}, {1, 2, 2}, ramp(16, -3.0f));
    expected = ramp(4 * texels);
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t texel = 2 + kWidth * (1 + i % 2 + kHeight * (1 + i / 2));
        for (uint32_t c = 0; c < 4; ++c) expected[4 * texel + c] = ramp(16, -3.0f)[4 * i + c];
    }
    EXPECT_EQ(read_floats(box), expected);
}

TEST_F(GlObjects, a_launch_with_nothing_for_a_sampler_is_an_error) {
    const Program program = fragment_program("entry/two_targets.glsl");
    const Framebuffer framebuffer(1, 1, {TexelFormat::rgba32f, TexelFormat::rgba32ui});
    EXPECT_EQ(error_of([&] { draw_fullscreen(program, framebuffer); }).got,
              "nothing for sampler table");
}

TEST_F(GlObjects, a_compile_error_names_file_and_line_inside_an_included_file) {
    const Error::Parts parts = error_of([&] { fragment_program("entry/includes_broken.glsl"); });
    EXPECT_EQ(parts.where, "lib/broken.glsl:5");
    EXPECT_NE(parts.got.find("lib/broken.glsl:5: error"), std::string::npos) << parts.got;
    EXPECT_NE(parts.got.find("no_such_name"), std::string::npos) << parts.got;
}

TEST_F(GlObjects, a_compile_error_after_an_include_still_has_its_own_line) {
    EXPECT_EQ(error_of([&] { fragment_program("entry/broken_after_include.glsl"); }).where,
              "entry/broken_after_include.glsl:6");
}

TEST_F(GlObjects, stages_that_do_not_fit_together_are_a_link_error) {
    const ShaderLibrary broken(std::map<std::string, std::string>{
        {"v.glsl", "void main() { gl_Position = vec4(0.0); }\n"},
        {"f.glsl", "float f();\nout vec4 c;\nvoid main() { c = vec4(f()); }\n"}});
    const auto make = [&] {
        Program("unlinked", {broken.compose({.stage = "vertex", .files = {"v.glsl"}}),
                             broken.compose({.stage = "fragment", .files = {"f.glsl"}})});
    };
    EXPECT_EQ(error_of(make).where, "linking program 'unlinked'");
}

TEST_F(GlObjects, a_gl_error_is_named_with_what_was_being_done) {
    glEnable(GL_TEXTURE_2D_ARRAY);  // not something that can be enabled
    const Error::Parts parts = error_of([] { check_gl("enabling nonsense"); });
    EXPECT_NE(parts.got.find("GL_INVALID_ENUM"), std::string::npos);
    EXPECT_NE(parts.where.find("while enabling nonsense"), std::string::npos);
    EXPECT_NO_THROW(check_gl("doing nothing"));
}

}  // namespace
}  // namespace onepass::gl
