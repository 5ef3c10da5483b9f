// A vector for large arrays that somebody fills in full: its elements begin with no value.
//
// std::vector writes zeros first, on one thread, and the system hands memory out page by page as
// they are written; for the arrays of a grid that took longer than filling them. Here pages are
// first touched by whichever threads fill them, and large arrays ask for large pages. Code that
// resizes such a vector must write every element before it reads it.
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace onepass {

/// Leaves elements without a value where std::allocator would write zeros; otherwise the same.
template <class T>
struct RawAllocator {
    using value_type = T;

    /// The size of a large page on the usual 64-bit machines. Arrays of several ask for them; a
    /// system that has none, or pages of another size, serves them as ever.
    static constexpr size_t kLargePage = size_t{1} << 21;
    static constexpr size_t kLargeArray = 2 * kLargePage;

    RawAllocator() = default;
    template <class U>
    RawAllocator(const RawAllocator<U>&) {}

    T* allocate(size_t count) {
        if (count > size_t(-1) / sizeof(T)) throw std::bad_array_new_length();
        const size_t bytes = count * sizeof(T);
        if (bytes < kLargeArray) return static_cast<T*>(::operator new(bytes));
        void* const memory = ::operator new(bytes, std::align_val_t(kLargePage));
#ifdef __linux__
        madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: it may be refused
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, size_t count) {
        const size_t bytes = count * sizeof(T);
        if (bytes < kLargeArray) return ::operator delete(memory);
        ::operator delete(memory, std::align_val_t(kLargePage));
    }

    template <class U>
    void construct(U* at) {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Args>
    void construct(U* at, Args&&... args) {
        ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }

    bool operator==(const RawAllocator&) const { return true; }
};

/// For trivial types: resize() and RawVector(n) leave new elements unwritten.
template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

/// Gives a vector's memory back. (`vector = {}` keeps it: it assigns a list of no elements.)
template <class T, class Allocator>
void give_back(std::vector<T, Allocator>& vector) {
    std::vector<T, Allocator>().swap(vector);
}

}  // namespace onepass
