// What `obliq explain` says of corners of walls and ground.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/explain/explanation.h"
#include "server/radar/echo/corners.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

// A house's wall, and a street before it.
constexpr double kLength_m = 20, kHeight_m = 8, kLit_m = 30;
constexpr double kGrazing_rad = 10 * kDegree_rad;

/// Cross section of the wall, turned by phi from the line of sight (CornerTable).
double cross_section_m2(const CornerTable& table, std::uint8_t wall, std::uint8_t ground, double phi_rad) {
  const double down = std::tan(kGrazing_rad);
  const CornerSight sight =
      CornerSight::over_ground(std::cos(phi_rad), std::sin(phi_rad), std::cos(kGrazing_rad), 0, down);
  const double area_m2 = kLength_m * std::cos(phi_rad) * std::min(kHeight_m / down, kLit_m);
  return table.reflectivity(wall, ground, sight.across) * table.lobe(ground, sight, {}) * area_m2;
}

}  // namespace

std::vector<ReportRow> corner_rows(const FramePlan& plan) {
  const World& world = plan.scene().world();
  if (!world.buildings.corners || world.buildings.list.empty()) return {};
  const std::vector<Material>& materials = plan.scene().materials();
  const RadarSettings& s = plan.settings();
  const CornerTable table(materials, s.atmosphere.polarisation);
  const std::uint8_t wall = world.buildings.list.front().material;
  constexpr std::uint8_t kGround = 0;  // that nothing else claims
  const double peak_m2 = cross_section_m2(table, wall, kGround, 0);
  double low = 0, high = kGrazing_rad;
  for (int k = 0; k < 50; ++k) {
    const double middle = (low + high) / 2;
    (cross_section_m2(table, wall, kGround, middle) > peak_m2 / 2 ? low : high) = middle;
  }
  const double slope = std::max(materials[kGround].rms_slope, CornerTable::kLeastSlope);
  // 4 k sigma_h sin(grazing) > 2.
  const double rough_m = wavelength_at(s.frequency_ghz) / (4 * std::numbers::pi * std::sin(kGrazing_rad));
  return rows_of(
      values("length"_is = kLength_m, "height"_is = kHeight_m, "lit"_is = kLit_m,
             "polarisation"_is = s.atmosphere.polarisation == Polarisation::vertical ? "V" : "H",
             "ghz"_is = s.frequency_ghz, "dbsm"_is = 10 * std::log10(peak_m2),
             "grazing"_is = kGrazing_rad / kDegree_rad, "half"_is = low / kDegree_rad, "slope"_is = slope,
             "wall"_is = materials[wall].name, "ground"_is = materials[kGround].name,
             "rough_mm"_is = 1000 * rough_m),
      {{"corners", true,
        "{length} x {height} m wall, {lit} m of lit ground, {polarisation}, {ghz:4} GHz: {dbsm:.1f} dBsm at "
        "{grazing} deg, half power +-{half:.1f} deg (slope {slope:3})."},
       {"corners", true,
        " Of {wall} and level {ground}, at the range of the wall's foot; permittivities are taken as they "
        "stand at every frequency. For ground that is rough: above {rough_mm:.0f} mm rms there."}});
}

}  // namespace obliq
