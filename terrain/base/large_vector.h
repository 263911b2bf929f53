#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace obliq {

/// Memory of large lists that are looked at in any order: in pages of 2 MB where the kernel gives them
/// (Linux: transparent_hugepage always or madvise), so that the processor finds them without walking its page
/// tables.
template <typename T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t kPage = std::size_t{1} << 21;
  static constexpr std::size_t kLeast = 2 * kPage;  ///< below it pages do not matter

  LargePages() = default;
  template <typename U>
  explicit(false) LargePages(const LargePages<U>& /*other*/) {}

  T* allocate(std::size_t n) {
    if (n > (~std::size_t{0} - kPage) / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = n * sizeof(T);
    const std::size_t page = bytes < kLeast ? kLine : kPage;
    const std::size_t whole = (bytes + page - 1) / page * page;
    void* const memory = std::aligned_alloc(page, whole);
    if (memory == nullptr) throw std::bad_alloc();
    if (page == kPage) madvise(memory, whole, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*n*/) { std::free(memory); }

  bool operator==(const LargePages&) const = default;

 private:
  static constexpr std::size_t kLine = 64;
};

template <typename T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace obliq
