#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

namespace obliq {

/// Which buildings have been seen. Marked from several threads at once.
class SeenBuildings {
 public:
  explicit SeenBuildings(std::size_t n_buildings) : flags_(n_buildings) {}

  void mark(std::uint32_t building) {
    // Written once, so that threads do not take the line from each other for nothing.
    if (!has(building)) flags_[building].store(1, std::memory_order_relaxed);
  }
  void mark(const std::vector<std::uint32_t>& buildings) {
    for (const std::uint32_t b : buildings) mark(b);
  }

  bool has(std::uint32_t building) const { return flags_[building].load(std::memory_order_relaxed) != 0; }
  std::uint32_t count() const {
    std::uint32_t n = 0;
    for (const auto& flag : flags_) n += flag.load(std::memory_order_relaxed);
    return n;
  }
  /// Rising.
  std::vector<std::uint32_t> list() const {
    std::vector<std::uint32_t> seen;
    for (std::uint32_t b = 0; b < flags_.size(); ++b)
      if (has(b)) seen.push_back(b);
    return seen;
  }

 private:
  std::vector<std::atomic<std::uint8_t>> flags_;
};

}  // namespace obliq
