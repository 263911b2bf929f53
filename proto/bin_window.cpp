#include "proto/bin_window.h"

#include <algorithm>

#include "proto/obliq.pb.h"

namespace obliq::wire {

std::uint32_t BinRun::index_from(std::uint64_t bin) const {
  if (bin <= first) return 0;
  if (bin >= end()) return kept();
  const std::uint64_t index = (bin - first + step - 1) / step;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(index, kept()));
}

Window read_window(const BinWindow& message) {
  Window window;
  window.azimuth = {message.first_azimuth(), message.n_azimuth(), std::max(1u, message.azimuth_step())};
  window.range = {message.first_range(), message.n_range(), std::max(1u, message.range_step())};
  return window;
}

void write_window(const Window& window, BinWindow& message) {
  message.set_first_azimuth(window.azimuth.first);
  message.set_n_azimuth(window.azimuth.count);
  message.set_azimuth_step(window.azimuth.step);
  message.set_first_range(window.range.first);
  message.set_n_range(window.range.count);
  message.set_range_step(window.range.step);
}

std::optional<BinRun> cut_run(const BinRun& run, std::int64_t n) {
  if (run.first >= n || run.step == 0) return std::nullopt;
  const auto left = static_cast<std::uint32_t>(n - run.first);
  return BinRun{run.first, run.count == 0 ? left : std::min(run.count, left), run.step};
}

std::optional<Window> cut_window(const Window& window, std::int64_t n_azimuth, std::int64_t n_range) {
  const auto azimuth = cut_run(window.azimuth, n_azimuth);
  const auto range = cut_run(window.range, n_range);
  if (!azimuth || !range) return std::nullopt;
  return Window{*azimuth, *range};
}

}  // namespace obliq::wire
