#include "server/radar/beam/sea_part.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "terrain/base/asking.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

constexpr std::int64_t kBinWork = 4;  // in units of ask()
constexpr int kRowsAlike = 8;

}  // namespace

void power_of_materials(const SharpWedge& wedge, int azimuth, const std::vector<int>& kinds, float share,
                        std::vector<float>& power) {
  const auto add = [&](const float* row, float times) {
    for (std::size_t m = 0; row != nullptr && m < power.size(); ++m) power[m] += times * row[m];
    ask(static_cast<std::int64_t>(power.size()));
  };
  power.assign(wedge.stride, 0);
  // Material 0 has what the others leave of the power.
  const bool has_first = kinds.front() == 0;
  if (has_first) add(wedge.power_row(azimuth), share);
  for (const LabelShare& label : wedge.label_powers) {
    if (label.kind == 0 || label.kind >= LabelShare::kBuildings) continue;
    const bool is_of_kinds = std::ranges::binary_search(kinds, label.kind);
    if (is_of_kinds != has_first) add(wedge.label_row(azimuth, label.kind), is_of_kinds ? share : -share);
  }
  for (float& of_bin : power) of_bin = std::max(of_bin, 0.0F);
}

void SeaPart::place(const EchoPlan& plan, const SharpWedge& wedge, int azimuth) {
  const DopplerPlan& doppler = *plan.doppler;
  power_of_materials(wedge, azimuth, doppler.sea().materials, 1, power);
  const std::size_t n = wedge.stride;
  const float* const whole = wedge.power_row(azimuth);
  rest_power.resize(n);
  for (std::size_t m = 0; m < n; ++m) {
    power[m] = std::min(power[m], whole[m]);
    rest_power[m] = whole[m] - power[m];
  }
  const SinCos at = sincos_turns(plan.row_middle_rad(azimuth) / (2 * std::numbers::pi));
  places.level_hz = doppler.sea_doppler().level_hz(at);
  places.place(doppler, n, wedge.sine_row(azimuth), power.data(), doppler.sea_doppler().up_hz());
  ask(kBinWork * static_cast<std::int64_t>(n));
}

void SeaPart::split(const EchoPlan& plan, int azimuth, std::uint64_t key, const float* whole_iq,
                    const float* whole_power) {
  const std::size_t n = power.size();
  // Of ground that is turned to an antenna that leans, neighbouring rows share echoes: they turn alike.
  const int alike = plan.ground ? kRowsAlike : 1;
  const int row = (azimuth - plan.first_azimuth) / alike * alike + plan.first_azimuth;
  const std::uint64_t first = first_of_sharp_row(plan, row);
  const std::uint64_t seed = mix64(key ^ mix64(static_cast<std::uint64_t>(plan.sharp.speckle_seed)));
  iq.resize(2 * n);
  rest_iq.resize(2 * n);
  re.resize(n);
  im.resize(n);
  for (std::size_t m = 0; m < n; ++m) {
    const float share = whole_power[m] > 0 ? power[m] / whole_power[m] : 0;
    const float of_sea = std::sqrt(share), of_rest = std::sqrt(std::max(0.0F, 1 - share));
    rest_iq[2 * m] = of_rest * whole_iq[2 * m];
    rest_iq[2 * m + 1] = of_rest * whole_iq[2 * m + 1];
    re[m] = of_sea * whole_iq[2 * m];
    im[m] = of_sea * whole_iq[2 * m + 1];
    if (share > 0 && of_rest > 0) {
      const std::uint64_t quarters = mix64(seed ^ (first + m));
      if ((quarters & 1) != 0) re[m] = std::exchange(im[m], -re[m]);
      if ((quarters & 2) != 0) re[m] = -re[m], im[m] = -im[m];
    }
    iq[2 * m] = re[m];
    iq[2 * m + 1] = im[m];
  }
  ask(kBinWork * static_cast<std::int64_t>(n));
}

}  // namespace obliq
