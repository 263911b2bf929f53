#include "server/radar/echo/sea_echo.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>

#include "server/radar/echo/sea_clutter.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Half the distance over which the datum's curvature is taken: at 100 km it has changed by 3e-4 of itself.
constexpr double kCurveStep_m = 20e3;

void fill_gammas(const RadarSettings& s, SeaTable& table) {
  for (int k = 0; k <= SeaTable::kSteps + 1; ++k) {
    const auto bits = static_cast<std::uint32_t>(SeaTable::kLeastBits + (k << SeaTable::kRestBits));
    const double sine = std::min(1.0, static_cast<double>(std::bit_cast<float>(bits)));
    const double grazing = bearing_of(sine, std::sqrt(1 - sine * sine));
    const double within =
        std::clamp(grazing, kLeastSeaGrazing_deg * kDegree_rad, kMostSeaGrazing_deg * kDegree_rad);
    const double sigma0 =
        ratio_of_db(sea_sigma0_db(sea_state(s), within, s.frequency_ghz, s.atmosphere.polarisation));
    double gamma = sigma0 / sincos_turns(within / (2 * std::numbers::pi)).sin;
    if (table.upwind > 0) gamma /= bessel_i0(upwind_exponent(grazing, s.frequency_ghz));
    table.gamma[k] = static_cast<float>(gamma);
  }
}

}  // namespace

bool has_sea(const RadarSettings& settings, const std::vector<Material>& materials) {
  return sea_state(settings) > 0 && std::ranges::any_of(materials, [](const Material& m) {
           return m.used && m.model == ScatteringModel::sea && m.gamma > 0;
         });
}

std::shared_ptr<const SeaTable> sea_table(const ScenePlan& plan) {
  const RadarSettings& s = plan.settings();
  const std::vector<Material>& materials = plan.scene().materials();
  if (!has_sea(s, materials)) return nullptr;
  auto table = std::make_shared<SeaTable>();
  for (std::size_t id = 0; id < materials.size() && id < std::size(table->over_gamma); ++id)
    if (materials[id].model == ScatteringModel::sea && materials[id].gamma > 0)
      table->over_gamma[id] = static_cast<float>(1 / materials[id].gamma);
  const glm::dvec3& at = plan.sector().antenna_m;
  const WorldFrame& frame = plan.scene().world().frame;
  const auto curve = [&](double dx, double dz) {
    return (frame.datum_y_m(dx, dz) + frame.datum_y_m(-dx, -dz) - 2 * frame.datum_y_m(0, 0)) /
           (kCurveStep_m * kCurveStep_m);
  };
  table->curve_x = curve(kCurveStep_m, 0);
  table->curve_z = curve(0, kCurveStep_m);
  table->antenna_x_m = at.x;
  table->antenna_z_m = at.z;
  if (s.atmosphere.wind_m_s > 0) {
    // It falls in proportion to 1 - 2.8 grazing.
    const double least = kLeastSeaGrazing_deg * kDegree_rad, most = kMostUpwindGrazing_deg * kDegree_rad;
    table->upwind = static_cast<float>(upwind_exponent(least, s.frequency_ghz) / (1 - 2.8 * least));
    table->least_upwind_sine = static_cast<float>(sincos_turns(least / (2 * std::numbers::pi)).sin);
    table->most_upwind_sine = static_cast<float>(sincos_turns(most / (2 * std::numbers::pi)).sin);
  }
  const SinCos from = wind_bearing(s, plan.pose().north_rad);
  table->wind_sin = from.sin;
  table->wind_cos = from.cos;
  fill_gammas(s, *table);
  return table;
}

double sea_over_gamma(const SeaTable& table, std::uint8_t material, double dx_m, double dz_m, double range_m,
                      double sin_elevation) {
  const auto over = static_cast<double>(table.over_gamma[material]);
  if (!(over > 0)) return 1;
  const double sine = (-sin_elevation * range_m + table.curve_x * (table.antenna_x_m + dx_m) * dx_m +
                       table.curve_z * (table.antenna_z_m + dz_m) * dz_m) /
                      range_m;
  const auto least = static_cast<double>(SeaTable::kLeastSine);
  const auto at = static_cast<float>(sine > least ? std::min(sine, 1.0) : least);
  const std::int32_t bits = std::bit_cast<std::int32_t>(at);
  const std::int32_t k = (bits - SeaTable::kLeastBits) >> SeaTable::kRestBits;
  const double rest = (bits & ((1 << SeaTable::kRestBits) - 1)) * (1.0 / (1 << SeaTable::kRestBits));
  const auto low = static_cast<double>(table.gamma[k]);
  const double factor = over * (low + rest * (static_cast<double>(table.gamma[k + 1]) - low));
  const double distance_m = std::sqrt(dx_m * dx_m + dz_m * dz_m);
  if (!(table.upwind > 0) || !(distance_m > 0)) return factor;
  const double s = std::clamp(static_cast<double>(at), static_cast<double>(table.least_upwind_sine),
                              static_cast<double>(table.most_upwind_sine));
  const double exponent = static_cast<double>(table.upwind) * (1 - 2.8 * (s + s * s * s / 6));
  const double against = (dx_m * table.wind_sin + dz_m * table.wind_cos) / distance_m;
  return factor * ratio_of_db(exponent * against / kNepersOfDecibel);
}

}  // namespace obliq
