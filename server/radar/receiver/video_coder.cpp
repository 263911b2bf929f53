#include "server/radar/receiver/video_coder.h"

#include <algorithm>
#include <complex>

#include "server/radar/simd/kernels.h"

namespace obliq {
namespace {

constexpr std::size_t kSpare = 8;  // lanes of a kernel

}  // namespace

VideoCoder::VideoCoder(const VideoScale& scale, std::size_t n_range)
    : scale_(scale), n_range_(n_range), power_(n_range + kSpare), level_(n_range + kSpare) {}

template <typename Level>
void VideoCoder::code(int bits, std::size_t first, std::vector<Level>& plane) {
  const double top = video_levels(bits) - 2;  // levels above the floor
  widest_kernels().video_levels({static_cast<int>(n_range_), power_.data(), scale_.floor_db,
                                 top / scale_.span_db, static_cast<double>(video_levels(bits) - 1),
                                 level_.data()});
  std::transform(level_.begin(), level_.begin() + static_cast<std::ptrdiff_t>(n_range_),
                 plane.begin() + static_cast<std::ptrdiff_t>(first),
                 [](std::int32_t level) { return static_cast<Level>(level); });
}
template void VideoCoder::code(int, std::size_t, std::vector<std::uint8_t>&);
template void VideoCoder::code(int, std::size_t, std::vector<std::uint16_t>&);

void add_video_of_iq(const VideoScale& scale, bool video8, bool video16, BinBlock& bins) {
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  VideoCoder coder(scale, n_range);
  if (video8) bins.video8.resize(bins.iq.size());
  if (video16) bins.video16.resize(bins.iq.size());
  for (std::size_t first = 0; first < bins.iq.size(); first += n_range) {
    for (std::size_t r = 0; r < n_range; ++r)
      coder.power()[r] = std::norm(std::complex<double>(bins.iq[first + r]));
    if (video8) coder.code(first, bins.video8);
    if (video16) coder.code(first, bins.video16);
  }
}

}  // namespace obliq
