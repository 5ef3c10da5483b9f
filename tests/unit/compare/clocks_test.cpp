// Clocks: what the driver's library says, and nothing where it says nothing.
#include "compare/clocks.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

namespace onepass {
namespace {

TEST(ClockReader, reads_what_the_library_tells_and_leaves_out_what_it_does_not) {
    const ClockReader reader(ONEPASS_FAKE_NVML);
    EXPECT_EQ(reader.source(), "Fake GPU");
    const auto clocks = reader.read();
    ASSERT_TRUE(clocks);
    EXPECT_EQ(clocks->sm_mhz, 1980.0);
    EXPECT_EQ(clocks->memory_mhz, 2619.0);
    EXPECT_TRUE(std::isnan(clocks->temperature_c)) << "this one has no thermometer";
}

TEST(ClockReader, says_why_there_is_nothing_to_read) {
    const ClockReader reader("libthere-is-no-such-library.so");
    EXPECT_FALSE(reader.read());
    EXPECT_NE(reader.source().find("libthere-is-no-such-library.so"), std::string::npos)
        << reader.source();
}

TEST(ClockReader, does_not_guess_which_of_several_devices_is_meant) {
    setenv("FAKE_NVML_DEVICES", "2", 1);
    const ClockReader reader(ONEPASS_FAKE_NVML);
    unsetenv("FAKE_NVML_DEVICES");
    EXPECT_FALSE(reader.read());
    EXPECT_NE(reader.source().find("2 devices"), std::string::npos) << reader.source();
}

}  // namespace
}  // namespace onepass
