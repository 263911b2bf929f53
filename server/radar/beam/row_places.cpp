#include "server/radar/beam/row_places.h"

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr std::int64_t kPlaceWork = 4;  // in units of ask(), a bin

}  // namespace

void RowPlaces::place(const DopplerPlan& doppler, std::size_t stride, const float* sine, const float* power,
                      double up_hz) {
  const DopplerRow of{static_cast<int>(stride), sine, doppler.turns_a_hz().data(), level_hz, up_hz};
  first.resize(stride);
  ask(kPlaceWork * static_cast<std::int64_t>(stride));
  if (!doppler.is_canceller()) {
    spans.resize(stride / CellSpan::kBins);
    active_kernels().doppler_cells(
        {of, doppler.ground().up_hz(), doppler.level_sine().data(), power, first.data(), spans.data()});
    return;
  }
  second.resize(stride);
  active_kernels().doppler_phasors({of, first.data(), second.data()});
}

}  // namespace obliq
