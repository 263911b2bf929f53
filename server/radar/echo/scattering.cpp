#include "server/radar/echo/scattering.h"

#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {
namespace {

/// Below this cosine a specular face is edge-on and only its floor is left; tan^2 would be above 1e12.
constexpr double kEdgeOn = 1e-6;

}  // namespace

ScatteringTable::ScatteringTable(const std::vector<Material>& materials, double wavelength_m,
                                 std::optional<CornerTable> corners, SeaOfFrame sea)
    : corners_(std::move(corners)), sea_(std::move(sea)) {
  rows_.reserve(materials.size());
  for (const Material& material : materials) {
    const double slope2 = material.rms_slope * material.rms_slope;
    rows_.push_back({material.model, material.gamma, material.reflectivity / (2 * slope2), 1 / (2 * slope2),
                     4 * std::numbers::pi * material.plate_tau / (wavelength_m * wavelength_m),
                     material.plate_exponent});
  }
}

double ScatteringTable::cross_section_m2(std::uint8_t material, double projected_area_m2,
                                         double cos_incidence) const {
  const Row& row = rows_[material];
  switch (row.model) {
    case ScatteringModel::constant_gamma:
    case ScatteringModel::sea:
      return row.gamma * projected_area_m2;
    case ScatteringModel::geometric_optics: {
      if (cos_incidence < kEdgeOn) return row.gamma * projected_area_m2;
      const double sec2 = 1 / (cos_incidence * cos_incidence);
      const double tan2 = sec2 - 1;
      const double lobe =
          row.peak * exp_of_negative(-tan2 * row.over_two_slope2) * sec2 * sec2 * std::sqrt(sec2);
      return (lobe + row.gamma) * projected_area_m2;
    }
    case ScatteringModel::flat_plate: {
      const double tau = row.plate_exponent == 0 ? 1.0
                         : cos_incidence < kEdgeOn
                             ? 0.0
                             : exp_of_negative(row.plate_exponent * log_of_positive(cos_incidence));
      return row.plate * tau * projected_area_m2 * projected_area_m2;
    }
  }
  return 0;
}

double ScatteringTable::constant_gamma(std::size_t material) const {
  const Row& row = rows_[material];
  const bool constant = row.model == ScatteringModel::constant_gamma || row.model == ScatteringModel::sea;
  return constant ? row.gamma : std::numeric_limits<double>::quiet_NaN();
}

EchoTable ScatteringTable::echo_table() const {
  EchoTable table{};
  table.sea = sea_.mean.get();
  for (std::size_t m = 0; m < rows_.size() && m < std::size(table.gamma); ++m) {
    const Row& row = rows_[m];
    if (row.model == ScatteringModel::flat_plate) continue;
    table.gamma[m] = row.gamma;
    table.gamma_f[m] = static_cast<float>(row.gamma);
    if (row.model != ScatteringModel::geometric_optics) continue;
    table.peak[m] = row.peak;
    table.over_two_slope2[m] = row.over_two_slope2;
    table.any_lobes = table.any_lobes || row.peak > 0;
  }
  return table;
}

}  // namespace obliq
