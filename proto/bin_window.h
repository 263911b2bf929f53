#pragma once
#include <compare>
#include <cstdint>
#include <optional>

namespace obliq::wire {

class BinWindow;

/// Bins along one axis of a frame: first, first + step, ... below first + count.
struct BinRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;  ///< bins spanned, before leaving any out; 0: all that follow
  std::uint32_t step = 1;   ///< at least 1

  auto operator<=>(const BinRun&) const = default;
  std::uint32_t kept() const { return count / step + (count % step != 0 ? 1 : 0); }
  std::uint64_t end() const { return std::uint64_t{first} + count; }
  /// The first kept bin at or after `bin`, counted among the kept; kept() when there is none.
  std::uint32_t index_from(std::uint64_t bin) const;
};

/// A rectangle of a frame's bins, possibly thinned out. The default is the whole frame.
struct Window {
  BinRun azimuth;
  BinRun range;

  auto operator<=>(const Window&) const = default;
  bool is_whole() const { return *this == Window{}; }
};

/// As the message says; 0 steps are 1.
Window read_window(const BinWindow& message);
void write_window(const Window& window, BinWindow& message);

/// The run within a frame of n bins: open counts filled in, what lies beyond cut off. Nothing when no bin
/// is left.
std::optional<BinRun> cut_run(const BinRun& run, std::int64_t n);
std::optional<Window> cut_window(const Window& window, std::int64_t n_azimuth, std::int64_t n_range);

}  // namespace obliq::wire
