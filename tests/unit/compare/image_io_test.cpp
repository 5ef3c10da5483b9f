// Image files, and the AOV channels that go into them.
#include "compare/image_io.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

Frame small_frame() {
    Frame frame;
    frame.width = 2;
    frame.height = 1;
    frame.color = {vec3(0.25f, 0.5f, 0.75f), vec3(0.0f)};
    frame.hits = {Hit{1.5f, 0.25f, 0.5f, 16777217, 3}, Hit{}};
    frame.normals = {vec3(0, 0, 1), vec3(0)};
    frame.flags = {0, kFlagExhausted};
    return frame;
}

TEST(AovChannels, names_and_types_the_planes) {
    const auto channels = aov_channels(small_frame(), {"color", "prim_id", "normal", "flags"});
    std::vector<std::string> names;
    for (const Channel& channel : channels) names.push_back(channel.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"R", "G", "B", "prim_id", "N.x", "N.y", "N.z", "flags"}));
    EXPECT_EQ(std::get<std::vector<float>>(channels[1].values)[0], 0.5f);
    EXPECT_EQ(std::get<std::vector<uint32_t>>(channels[3].values),
              (std::vector<uint32_t>{16777217, kNoId}))
        << "an id that float cannot hold";
}

TEST(AovChannels, refuses_unknown_names_and_planes_that_are_not_there) {
    EXPECT_THROW(aov_channels(small_frame(), {"depth"}), Error);
    EXPECT_THROW(aov_channels(small_frame(), {"cells"}), Error) << "the frame has no counters";
}

TEST(ImageFiles, are_written_whole_or_refused) {
    const TemporaryFolder folder;
    const Frame frame = small_frame();
    const auto png = folder.path() / "a.png";
    const auto exr = folder.path() / "a.exr";
    const auto channels = aov_channels(frame, {"color", "t", "prim_id"});
    if (!image_files_supported()) {
        EXPECT_THROW(write_png(png, tone_mapped(frame)), Error);
        EXPECT_THROW(write_exr(exr, 2, 1, channels), Error);
        EXPECT_TRUE(folder.names().empty());
        return;
    }
    write_png(png, tone_mapped(frame));
    write_exr(exr, 2, 1, channels);
    EXPECT_EQ(read_bytes(png).substr(1, 3), "PNG");
    EXPECT_EQ(read_bytes(exr).substr(0, 4), "\x76\x2f\x31\x01") << "OpenEXR's magic number";
    EXPECT_NE(read_bytes(exr).find("prim_id"), std::string::npos);
    EXPECT_EQ(folder.names().size(), 2u);
    EXPECT_THROW(write_png(folder.path() / "no" / "a.png", tone_mapped(frame)), Error);
    EXPECT_THROW(write_png(folder.path() / "a.unknown", tone_mapped(frame)), Error);
    EXPECT_EQ(folder.names().size(), 2u) << "no partial file";
}

}  // namespace
}  // namespace onepass
