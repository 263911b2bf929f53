#include "server/accuracy/sampling_ladder.h"

#include <array>

namespace obliq {
namespace {

constexpr std::array kSides{256, 512, 1024, 2048, 4096, 8192, kMostSide};
constexpr std::array kPerBin{1, 2, 4, 8, 16};

}  // namespace

std::vector<SamplingCase> sampling_ladder(const RadarSettings& s, double cell_m) {
  std::vector<SamplingCase> ladder;
  const bool sweep = s.frustum == FrustumKind::sweep;
  if (!sweep && s.frustum != FrustumKind::polar) {
    for (const int side : kSides) ladder.push_back({s.frustum, s.plates, side, side, cell_m});
    return ladder;
  }
  for (const int per_bin : kPerBin) {
    const int columns = per_bin * s.azimuth_bins;
    const int rows = sweep ? 0 : per_bin * s.range_bins;
    if (columns <= kMostSide && rows <= kMostSide)
      ladder.push_back({s.frustum, s.plates, columns, rows, cell_m});
  }
  return ladder;
}

std::vector<TriedSampling> climb(const std::vector<SamplingCase>& ladder, const AccuracyLimit& limit,
                                 const std::function<BinErrors(const SamplingCase&)>& measure) {
  std::vector<TriedSampling> tried;
  for (const SamplingCase& sampling : ladder) {
    tried.push_back({sampling, measure(sampling)});
    if (limit.met_by(tried.back().errors)) break;
  }
  return tried;
}

}  // namespace obliq
