#pragma once
#include <cstdint>
#include <vector>

namespace obliq::test {

/// FNV-1a, 64 bits (Fowler, Noll & Vo).
class Fnv1a {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t k = 0; k < values.size() * sizeof(T); ++k) sum_ = (sum_ ^ bytes[k]) * 0x100000001b3ull;
  }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325ull;
};

}  // namespace obliq::test
