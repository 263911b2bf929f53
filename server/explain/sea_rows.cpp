// What the sea returns.
#include <algorithm>
#include <array>
#include <cmath>

#include "server/explain/explanation.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/echo/sea_clutter.h"
#include "server/radar/echo/sea_echo.h"
#include "server/radar/echo/sea_texture.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kUsualState = 3;
constexpr double kRayleigh = 20;  ///< of K distributions of this shape and more

std::string list_text(const std::array<double, 3>& values, const char* format) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number_text(value, format);
  return text;
}

}  // namespace

std::vector<ReportRow> sea_rows(const FramePlan& plan, const AirView& air) {
  const RadarSettings& s = plan.settings();
  const std::vector<Material>& materials = plan.scene().materials();
  const auto water = std::ranges::find_if(
      materials, [](const Material& m) { return m.used && m.model == ScatteringModel::sea && m.gamma > 0; });
  if (water == materials.end()) return {};
  const bool on = has_sea(s, materials);
  const double state = on ? sea_state(s) : kUsualState;
  const double radius_m = kMeanEarthRadius_m * plan.scene().world().frame.radius_factor();
  const auto sigma0_db = [&](double grazing) {
    return sea_sigma0_db(state, grazing, s.frequency_ghz, s.atmosphere.polarisation);
  };
  std::array<double, 3> degrees{}, sea_db{}, plain_db{};
  const double ranges_m[] = {s.r_min_m, (s.r_min_m + s.r_max_m) / 2, s.r_max_m};
  for (std::size_t k = 0; k < 3; ++k) {
    const double grazing = grazing_rad(air.antenna_m, std::max(1.0, ranges_m[k]), radius_m);
    degrees[k] = grazing / kDegree_rad;
    sea_db[k] = grazing > 0 ? sigma0_db(grazing) : NAN;
    plain_db[k] = grazing > 0 ? db_of_ratio(water->gamma * std::sin(grazing)) : NAN;
  }
  std::array<double, 3> shapes{};
  const double width_rad = azimuth_resolution_rad(s);
  const double bin_m = s.pulse.kind == PulseKind::off ? s.range_bin_m() : PointResponse(s).resolution_m();
  for (std::size_t k = 0; on && s.sea.shape > 0 && k < 3; ++k)
    shapes[k] = shape_of_cell(s.sea.shape, bin_m / std::max(0.1, std::cos(degrees[k] * kDegree_rad)),
                              std::max(1.0, ranges_m[k]) * width_rad);
  const double z = upwind_exponent(1 * kDegree_rad, s.frequency_ghz);
  return {
      {"sea",
       text_of(values("at_1_deg"_is = sigma0_db(1 * kDegree_rad),
                      "polarisation"_is = s.atmosphere.polarisation == Polarisation::vertical ? "V" : "H",
                      "ghz"_is = std::clamp(s.frequency_ghz, kLeastSea_ghz, kMostSea_ghz), "state"_is = state,
                      "degrees"_is = list_text(degrees, ".2f"), "sea"_is = list_text(sea_db, ".1f"),
                      "plain"_is = list_text(plain_db, ".1f"), "material"_is = water->name,
                      "wind_db"_is = db_of_ratio(std::exp(2 * z)), "shape"_is = s.sea.shape,
                      "shapes"_is = list_text(shapes, ".2f"), "from_deg"_is = s.atmosphere.wind_from_deg),
               {{"sea", !on,
                 "off: water returns what its material says. With sea.state = {state:2} it would have "},
                {"sea", true,
                 "sigma0 at 1 deg {at_1_deg:.2f} dB (NRL, {polarisation}, {ghz:3} GHz) at state {state:2}. "
                 "Grazing angles of the sea, near, middle, far: {degrees} deg; sigma0 there {sea} dB; of "
                 "\"{material}\" without a state {plain} dB. "},
                {"sea", on && s.atmosphere.wind_m_s > 0,
                 "The wind comes from {from_deg:3} deg: against it the sea returns {wind_db:.1f} dB more "
                 "than with it, at 1 deg (GIT). "},
                {"sea", on && s.sea.shape > 0,
                 "Texture: shape {shape:3} at a point, {shapes} of this radar's cells, near, middle, far; "
                 "from about 20 on the sea is Rayleigh"},
                {"sea", on && s.sea.shape > 0,
                 *std::ranges::min_element(shapes) >= kRayleigh ? ", as all of it is here. " : ". "},
                {"sea", on && s.sea.shape > 0 && s.atmosphere.wind_m_s > 0,
                 "It drifts with the sim time, so that echoes of a radar that stands still are not kept from "
                 "frame to frame. "},
                {"sea", true, "Published models differ from each other by 3 to 15 dB."}})}};
}

}  // namespace obliq
