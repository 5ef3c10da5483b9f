// The peak of memory, measured on work that takes a known amount; and what building a grid takes.
#include "compare/peak_memory.h"

#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/grid/uniform_grid.h"
#include "scenes/shapes.h"

namespace onepass {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

constexpr uint64_t kMiB = uint64_t{1} << 20;

/// What the allocator may take beside what is asked of it, and by how much the kernel's counts,
/// kept a processor each, may be late.
constexpr uint64_t kUnasked = 3 * kMiB;

bool can_measure() { return !kSanitized && reset_peak_memory().has_value(); }

TEST(PeakMemory, counts_what_was_written_although_it_was_freed) {
    if (!can_measure()) GTEST_SKIP() << "no peak of resident memory to be had";
    const uint64_t peak = *peak_memory_of([] { std::vector<char>(64 * kMiB, 'x'); });
    EXPECT_GE(peak + kUnasked, 64 * kMiB);
    EXPECT_LE(peak, 64 * kMiB + kUnasked);
    // From the beginning again.
    EXPECT_LE(*peak_memory_of([] { std::vector<char>(8 * kMiB, 'x'); }), 8 * kMiB + kUnasked);
}

TEST(PeakMemory, of_a_grid_is_what_it_holds_and_its_references_once_more) {
    if (!can_measure()) GTEST_SKIP() << "no peak of resident memory to be had";
    // The chunks that are at work at the same time, one a thread, hold more for a while.
    const tbb::global_control few(tbb::global_control::max_allowed_parallelism, 4);
    const Object object = make_sphere(600, 501);
    build_triangle_grid(make_sphere(10, 10), {});  // threads are there before

    UniformGrid grid;
    const auto build = [&] { grid = build_triangle_grid(object, {.density = 8.0}); };
    const uint64_t peak = *peak_memory_of(build);
    constexpr uint64_t kBytesACell = 4;
    constexpr uint64_t kBytesAReference = 4 + 4;
    constexpr uint64_t kBytesATriangle = 4;  // of the tables, and of memory in pieces
    EXPECT_LE(peak, kBytesACell * grid.cell_count() + kBytesAReference * grid.references.size() +
                        kBytesATriangle * object.triangles.size() + kUnasked);
}

}  // namespace
}  // namespace onepass
