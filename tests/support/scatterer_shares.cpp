#include "tests/support/scatterer_shares.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "server/radar/sample_source.h"
#include "terrain/errors.h"

namespace obliq::test {
namespace {

constexpr long double kPi = std::numbers::pi_v<long double>;
constexpr double kSpeedOfLight_m_s = 299792458.0;

}  // namespace

Cell cell_of(const BinGrid& bins, double slant_range_m, double x_m, double z_m, std::uint32_t face,
             std::uint8_t material) {
  Cell cell;
  cell.face = face;
  cell.material = material;
  if (face != kNoFace) return cell;
  const double r0_m = std::exp2(std::floor(std::log2(slant_range_m)));
  const double most_m = std::min(bins.range_spacing_m, r0_m * bins.azimuth_width_rad) / 2;
  cell.side_m = std::exp2(std::floor(std::log2(most_m)));
  cell.x_cell = static_cast<std::int64_t>(std::floor(x_m / cell.side_m));
  cell.z_cell = static_cast<std::int64_t>(std::floor(z_m / cell.side_m));
  return cell;
}

glm::dvec3 reference_point_m(const World& world, const Cell& cell) {
  if (cell.face != kNoFace) return world.buildings.faces[cell.face].centre_m;
  const double x = (static_cast<double>(cell.x_cell) + 0.5) * cell.side_m;
  const double z = (static_cast<double>(cell.z_cell) + 0.5) * cell.side_m;
  return {x, world.grid.height_at_m(x, z), z};
}

std::vector<Material> constant_gamma_materials() {
  std::vector<Material> materials(2);
  materials[0].name = "terrain";
  materials[1].name = "building";
  materials[1].gamma = 3;
  return materials;
}

void for_each_sample(const FramePlan& plan, const std::function<void(const SampleBatch&, std::size_t)>& use) {
  const auto batch = std::make_unique<SampleBatch>();
  FrameStats stats;
  const int n = plan.bins().n_azimuth;
  for (int first = 0; first < n; first += kWedgeAzimuthBins) {
    const AzimuthRange range{first, std::min(kWedgeAzimuthBins, n - first)};
    const auto source = make_sample_source(plan, range, nullptr);
    while (source->next(*batch, stats))
      for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k) use(*batch, k);
  }
}

double sample_power_w(const FramePlan& plan, const SampleBatch& batch, std::size_t k) {
  const RadarSettings& settings = plan.settings();
  const Material& material = plan.scene().materials()[batch.material[k]];
  if (material.model != ScatteringModel::constant_gamma || settings.gain_db != 0)
    throw std::logic_error("sample_power_w: constant gamma and a gain of 1 only");
  // Monostatic radar equation with sigma = gamma dOmega r^2: P = P_t lambda^2 gamma dOmega / ((4 pi)^3 r^2).
  const double lambda_m = kSpeedOfLight_m_s / (settings.frequency_ghz * 1e9);
  const double constant = settings.power_w * lambda_m * lambda_m / static_cast<double>(64 * kPi * kPi * kPi);
  const double r2 = batch.slant_range_m[k] * batch.slant_range_m[k];
  return constant * material.gamma * batch.solid_angle_sr[k] * (settings.range_normalisation ? r2 : 1 / r2);
}

std::vector<BinShares> shares_of_bins(const FramePlan& plan) {
  const BinGrid& bins = plan.bins();
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  std::vector<BinShares> shares(static_cast<std::size_t>(bins.n_azimuth) * n_range);
  for_each_sample(plan, [&](const SampleBatch& batch, std::size_t k) {
    const double r = batch.slant_range_m[k];
    if (!(r >= bins.r_min_m && r < bins.r_max_m)) return;
    const double at = std::floor((r - bins.r_min_m) / bins.range_spacing_m);
    const auto range_bin = static_cast<std::size_t>(std::min(at, bins.n_range - 1.0));
    const Cell cell = cell_of(bins, r, batch.x_m[k], batch.z_m[k], batch.face[k], batch.material[k]);
    shares[static_cast<std::size_t>(batch.azimuth_bin[k]) * n_range + range_bin][cell] +=
        sample_power_w(plan, batch, k);
  });
  return shares;
}

std::shared_ptr<const FramePlan> plan_or_throw(std::shared_ptr<const Scene> scene,
                                               const RadarSettings& settings, const Pose& pose) {
  const PlanResult planned = plan_frame(
      std::move(scene), std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), pose);
  if (!planned.plan) throw InputError(all_text(planned.errors));
  return planned.plan;
}

long double round_trip_phase_rad(const glm::dvec3& antenna_m, const glm::dvec3& point_m,
                                 double frequency_ghz) {
  const long double x = static_cast<long double>(point_m.x) - static_cast<long double>(antenna_m.x);
  const long double y = static_cast<long double>(point_m.y) - static_cast<long double>(antenna_m.y);
  const long double z = static_cast<long double>(point_m.z) - static_cast<long double>(antenna_m.z);
  const long double lambda_m = static_cast<long double>(kSpeedOfLight_m_s) / (frequency_ghz * 1e9L);
  return 4 * kPi * std::sqrt(x * x + y * y + z * z) / lambda_m;
}

}  // namespace obliq::test
