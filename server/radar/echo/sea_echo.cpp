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

/// What the wind does to the power of a piece, limits of the sine kept.
double upwind_factor(const SeaTable& table, double sine, double against) {
  // The angle of a sine below that of 10 degrees is s + s^3 / 6, to 1e-5.
  const double exponent = static_cast<double>(table.upwind) * (1 - 2.8 * (sine + sine * sine * sine / 6));
  return ratio_of_db(exponent * against / kNepersOfDecibel);
}

/// The step in the table of a sine of grazing from 2^-kOctaves to 1.
std::int32_t step_of(float sine) {
  return (std::bit_cast<std::int32_t>(sine) >> SeaTable::kRestBits) - SeaTable::kFirstStep;
}

void fill_gammas(const RadarSettings& s, SeaTable& table) {
  const double state = sea_state(s);
  const auto gamma_at = [&](double sine) {
    const double grazing = bearing_of(sine, std::sqrt(1 - sine * sine));
    const double within =
        std::clamp(grazing, kLeastSeaGrazing_deg * kDegree_rad, kMostSeaGrazing_deg * kDegree_rad);
    const double sigma0 =
        ratio_of_db(sea_sigma0_db(state, within, s.frequency_ghz, s.atmosphere.polarisation));
    const double gamma = sigma0 / sincos_turns(within / (2 * std::numbers::pi)).sin;
    return table.upwind > 0 ? gamma / bessel_i0(upwind_exponent(grazing, s.frequency_ghz)) : gamma;
  };
  const auto sine_of = [](std::int32_t step) {
    return static_cast<double>(std::bit_cast<float>((step + SeaTable::kFirstStep) << SeaTable::kRestBits));
  };
  // The first line begins between two steps.
  double sine = static_cast<double>(SeaTable::kLeastSine);
  double gamma = gamma_at(sine);
  for (std::int32_t k = step_of(SeaTable::kLeastSine); k < SeaTable::kSteps; ++k) {
    const double next_sine = sine_of(k + 1);
    const double next = gamma_at(next_sine);
    const double rise = (next - gamma) / (next_sine - sine);
    table.offset[k] = static_cast<float>(gamma - rise * sine);
    table.rise[k] = static_cast<float>(rise);
    sine = next_sine;
    gamma = next;
  }
  table.offset[SeaTable::kSteps] = static_cast<float>(gamma);
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
    table->most_upwind_sine = static_cast<float>(sincos_turns(most / (2 * std::numbers::pi)).sin);
    const auto low = static_cast<double>(SeaTable::kLeastSine);
    const double half = (static_cast<double>(table->most_upwind_sine) - low) / 2;
    for (int k = 0; k < SeaTable::kUpwindTerms; ++k)  // the Chebyshev nodes
      table->upwind_sines[k] = low + half * (1 + sincos_turns((k + 0.5) / (2 * SeaTable::kUpwindTerms)).cos);
  }
  const SinCos from = wind_bearing(s, plan.pose().north_rad);
  table->wind_sin = from.sin;
  table->wind_cos = from.cos;
  fill_gammas(s, *table);
  return table;
}

std::array<float, SeaTable::kUpwindTerms> upwind_terms(const SeaTable& table, double against) {
  // By Newton's divided differences.
  constexpr int n = SeaTable::kUpwindTerms;
  const double(&sine)[n] = table.upwind_sines;
  double difference[n];
  for (int k = 0; k < n; ++k) difference[k] = upwind_factor(table, sine[k], against);
  for (int order = 1; order < n; ++order)
    for (int k = n - 1; k >= order; --k)
      difference[k] = (difference[k] - difference[k - 1]) / (sine[k] - sine[k - order]);
  // To powers, from the innermost bracket outwards.
  double power[n] = {};
  for (int k = n - 1; k >= 0; --k) {
    for (int j = n - 1; j > 0; --j) power[j] = power[j - 1] - sine[k] * power[j];
    power[0] = difference[k] - sine[k] * power[0];
  }
  std::array<float, n> terms;
  for (std::size_t k = 0; k < terms.size(); ++k) terms[k] = static_cast<float>(power[k]);
  return terms;
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
  const std::int32_t step = step_of(at);
  const double factor = over * (static_cast<double>(table.offset[step]) +
                                static_cast<double>(table.rise[step]) * static_cast<double>(at));
  const double distance_m = std::sqrt(dx_m * dx_m + dz_m * dz_m);
  if (!(table.upwind > 0) || !(distance_m > 0)) return factor;
  const double s = std::min(static_cast<double>(at), static_cast<double>(table.most_upwind_sine));
  return factor * upwind_factor(table, s, (dx_m * table.wind_sin + dz_m * table.wind_cos) / distance_m);
}

}  // namespace obliq
