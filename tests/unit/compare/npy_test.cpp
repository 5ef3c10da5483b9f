// `.npy` files: what NumPy writes is read, what is broken is refused.
#include "compare/npy.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "compare/aovs.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

/// A file as numpy.save writes it: version 1.0, header padded to 64 bytes.
std::string npy_bytes(const std::string& header, const std::string& data) {
    std::string padded = header;
    while ((10 + padded.size() + 1) % 64 != 0) padded += ' ';
    padded += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(padded.size() & 0xFF);
    bytes += static_cast<char>(padded.size() >> 8);
    return bytes + padded + data;
}

std::string floats(const std::vector<float>& values) {
    return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

constexpr char kTwoRays[] = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), }";

std::string two_rays() {
    return floats({1, 2, 3, 0.5f, 4, 5, 6, 7, -1, -2, -3, 0, -4, -5, -6, kInfinity});
}

TEST(Npy, reads_rays_as_numpy_writes_them) {
    const TemporaryFolder folder;
    const auto rays = read_rays_npy(folder.write("rays.npy", npy_bytes(kTwoRays, two_rays())));
    ASSERT_EQ(rays.size(), 2u);
    EXPECT_EQ(rays[0].org, vec3(1, 2, 3));
    EXPECT_EQ(rays[0].tmin, 0.5f);
    EXPECT_EQ(rays[0].dir, vec3(4, 5, 6));
    EXPECT_EQ(rays[0].tmax, 7.0f);
    EXPECT_EQ(rays[1].tmax, kInfinity);
}

TEST(Npy, reads_back_the_rays_it_wrote_bit_by_bit) {
    const TemporaryFolder folder;
    std::vector<Ray> rays(3);
    rays[1].org.x = std::numeric_limits<float>::quiet_NaN();
    rays[2].dir.y = -0.0f;
    const auto path = folder.path() / "rays.npy";
    write_rays_npy(path, rays);
    const auto again = read_rays_npy(path);
    ASSERT_EQ(again.size(), rays.size());
    EXPECT_EQ(std::memcmp(again.data(), rays.data(), 3 * sizeof(Ray)), 0);
    EXPECT_EQ((read_bytes(path).size() - 3 * sizeof(Ray)) % 64, 0u) << "data is aligned";
}

TEST(Npy, reads_an_empty_list_and_version_two) {
    const TemporaryFolder folder;
    const std::string empty = "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 8), }";
    EXPECT_TRUE(read_rays_npy(folder.write("empty.npy", npy_bytes(empty, ""))).empty());

    std::string second = npy_bytes(kTwoRays, two_rays());
    second[6] = 2;
    second.insert(10, std::string(2, '\0'));
    EXPECT_EQ(read_rays_npy(folder.write("second.npy", second)).size(), 2u);
}

TEST(Npy, round_trips_hits) {
    const TemporaryFolder folder;
    const std::vector<Hit> hits = {{1.5f, 0.25f, 0.5f, 7, 3}, Hit{}};
    const auto path = folder.path() / "hits.npy";
    write_hits_npy(path, hits);
    EXPECT_EQ(read_hits_npy(path), hits);
    EXPECT_NE(read_bytes(path).find("('prim_id', '<u4')"), std::string::npos);
}

TEST(Npy, writes_aov_planes_as_one_structured_array) {
    const TemporaryFolder folder;
    const std::vector<Channel> channels = {
        {"t", std::vector<float>{1, 2, 3, 4, 5, 6}},
        {"prim_id", std::vector<uint32_t>{9, 8, 7, 6, 5, kNoId}}};
    const auto path = folder.path() / "aovs.npy";
    write_channels_npy(path, 3, 2, channels);
    const std::string bytes = read_bytes(path);
    EXPECT_NE(bytes.find("[('t', '<f4'), ('prim_id', '<u4')]"), std::string::npos);
    EXPECT_NE(bytes.find("(2, 3)"), std::string::npos) << "height first";
    uint32_t last = 0;
    std::memcpy(&last, bytes.data() + bytes.size() - 4, 4);
    EXPECT_EQ(last, kNoId);
}

/// One broken file, and a word its error must say.
struct Broken {
    std::string what;
    std::string bytes;
    std::string expected_word;
};

class BrokenNpy : public testing::TestWithParam<Broken> {};

TEST_P(BrokenNpy, is_refused_with_the_reason) {
    const TemporaryFolder folder;
    const auto path = folder.write("broken.npy", GetParam().bytes);
    try {
        read_rays_npy(path);
        FAIL() << "was read";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(GetParam().expected_word), std::string::npos)
            << error.what();
        EXPECT_NE(std::string(error.what()).find("broken.npy"), std::string::npos);
    }
}

std::string with_header(const std::string& header) { return npy_bytes(header, two_rays()); }

INSTANTIATE_TEST_SUITE_P(
    Npy, BrokenNpy,
    testing::Values(
        Broken{"empty", "", "magic"}, Broken{"text", "hello, world", "magic"},
        Broken{"magic_only", "\x93NUMPY", "version"},
        Broken{"unknown_version", std::string("\x93NUMPY\x09\x00\x10\x00", 10), "version 9"},
        Broken{"cut_in_header", npy_bytes(kTwoRays, "").substr(0, 40), "inside its header"},
        Broken{"header_no_dictionary", with_header("hello"), "header"},
        Broken{"header_without_shape", with_header("{'descr': '<f4', 'fortran_order': False}"),
               "header"},
        Broken{"doubles", with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 8)}"),
               "float32"},
        Broken{"big_endian",
               with_header("{'descr': '>f4', 'fortran_order': False, 'shape': (2, 8)}"), "float32"},
        Broken{"fortran", with_header("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 8)}"),
               "Fortran"},
        Broken{"flat", with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (16,)}"),
               "(16,)"},
        Broken{"six_columns",
               with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6)}"), "(2, 6)"},
        Broken{"negative",
               with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (-2, 8)}"), "shape"},
        Broken{"truncated",
               with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8)}"),
               "cut short"},
        Broken{"half_a_row", npy_bytes(kTwoRays, two_rays().substr(0, 50)), "cut short"},
        Broken{"too_long", with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8)}"),
               "differ"},
        Broken{"overflow",
               with_header("{'descr': '<f4', 'fortran_order': False, 'shape': "
                           "(576460752303423490, 8)}"),
               "cut short"}),
    [](const auto& test) { return test.param.what; });

TEST(Npy, refuses_a_missing_file_and_a_folder) {
    const TemporaryFolder folder;
    EXPECT_THROW(read_rays_npy(folder.path() / "missing.npy"), Error);
    EXPECT_THROW(read_rays_npy(folder.path()), Error);
}

TEST(Npy, refuses_rays_as_hits) {
    const TemporaryFolder folder;
    EXPECT_THROW(read_hits_npy(folder.write("rays.npy", npy_bytes(kTwoRays, two_rays()))), Error);
}

}  // namespace
}  // namespace onepass
