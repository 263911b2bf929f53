#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace obliq {

/// Room for `n` values, in pages of 2 MiB where the kernel has them to give (madvise(2), MADV_HUGEPAGE): a
/// march crosses the rows of a large array, and each row would have a page of its own. For an empty vector,
/// before it is filled.
template <class T>
void reserve_in_huge_pages(std::vector<T>& values, std::size_t n) {
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
  values.reserve(n);
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + kPage - 1) & ~(kPage - 1);
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + n) & ~(kPage - 1);
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace obliq
