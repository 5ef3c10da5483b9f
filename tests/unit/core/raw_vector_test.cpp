// Arrays whose memory is given back.
#include "core/raw_vector.h"

#include <gtest/gtest.h>

namespace onepass::test {
namespace {

TEST(RawVector, keeps_no_memory_when_it_is_given_back) {
    for (const size_t count : {size_t{10}, 3 * RawAllocator<int>::kLargeArray / sizeof(int)}) {
        RawVector<int> vector(count);
        give_back(vector);
        EXPECT_EQ(vector.size(), 0u);
        EXPECT_EQ(vector.capacity(), 0u);
    }
}

}  // namespace
}  // namespace onepass::test
