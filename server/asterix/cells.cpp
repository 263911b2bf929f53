#include "server/asterix/cells.h"

#include <cmath>
#include <limits>

#include "terrain/base/units.h"

namespace obliq::asterix {
namespace {

constexpr double kTurnUnits = 65536;  // I240/041: least significant bit 360 / 2^16 degrees
// There and back: a cell of d metres lasts 2 d / c.
constexpr double kFemtosecondsPerMetre = 2e15 / kSpeedOfLight_m_s;

}  // namespace

double longest_cell_m() { return std::numeric_limits<std::uint32_t>::max() / kFemtosecondsPerMetre; }

CellGeometry cell_geometry(double range_start_m, double range_spacing_m) {
  CellGeometry geometry;
  geometry.cell_dur_fs = static_cast<std::uint32_t>(std::llround(kFemtosecondsPerMetre * range_spacing_m));
  geometry.start_rg = static_cast<std::uint32_t>(std::llround(range_start_m / range_spacing_m));
  geometry.range_offset_m = geometry.start_rg * range_spacing_m - range_start_m;
  return geometry;
}

std::uint16_t azimuth_units(double bearing_deg) {
  const double turns = bearing_deg / 360;
  const auto units = std::llround(kTurnUnits * (turns - std::floor(turns)));
  return static_cast<std::uint16_t>(units % static_cast<long long>(kTurnUnits));
}

AzimuthEdges azimuth_edges(double azimuth_start_deg, double azimuth_width_deg, std::uint32_t bin) {
  const auto edge = [&](double bins) { return azimuth_units(azimuth_start_deg + bins * azimuth_width_deg); };
  return {edge(bin), edge(bin + 1.0)};
}

}  // namespace obliq::asterix
