#include "tests/support/scatterer_shares.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "server/radar/render.h"
#include "terrain/base/errors.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq::test {
namespace {

constexpr long double kPi = std::numbers::pi_v<long double>;
constexpr double kSpeedOfLight_m_s = 299792458.0;

/// The greatest distance of a face's triangles from its centre, along any axis. A wall goes down into the
/// ground: its height counts upwards from its centre.
double half_extent_m(const World& world, std::uint32_t face) {
  const Buildings& all = world.buildings;
  const glm::dvec3& centre = all.face(face).centre_m;
  double most = 0;
  for_each_triangle(all, all.list[all.building_of_face[face]],
                    [&](std::uint32_t of, const Triangle& triangle) {
                      if (of != face) return;
                      for (const glm::vec3& corner : triangle) {
                        const glm::dvec3 off = glm::dvec3(corner) - centre;
                        most = std::max({most, std::abs(off.x), std::abs(off.z), off.y});
                      }
                    });
  return most;
}

/// The scatterers of a frame's samples: cells whose side is the largest power of two that is at most half of
/// min(range spacing, r0 x azimuth width), r0 the power of two at or below the slant range.
class Cells {
 public:
  explicit Cells(const ScenePlan& plan) : plan_(plan) {}

  Cell of(const SampleBatch& batch, std::size_t k) {
    const BinGrid& bins = plan_.bins();
    Cell cell;
    cell.face = batch.face[k];
    cell.material = batch.material[k];
    const double r0_m = std::exp2(std::floor(std::log2(batch.slant_range_m[k])));
    const double most_m = std::min(bins.range_spacing_m, r0_m * bins.azimuth_width_rad) / 2;
    const double side_m = std::exp2(std::floor(std::log2(most_m)));
    if (cell.face == kNoFace) {
      cell.side_m = side_m;
      cell.x_cell = static_cast<std::int64_t>(std::floor(batch.x_m[k] / side_m));
      cell.z_cell = static_cast<std::int64_t>(std::floor(batch.z_m[k] / side_m));
      return cell;
    }
    const World& world = plan_.scene().world();
    const auto [extent, fresh] = half_extents_m_.try_emplace(cell.face);
    if (fresh) extent->second = half_extent_m(world, cell.face);
    if (extent->second <= side_m / 2) return cell;
    const BuildingFace& face = world.buildings.face(cell.face);
    const double y_m = plan_.sector().antenna_m.y + batch.slant_range_m[k] * batch.sin_elevation[k];
    const auto sides = [&](double off_m) {
      return static_cast<std::int64_t>(std::floor(off_m / side_m + 0.5));
    };
    cell.side_m = side_m;
    cell.x_cell = sides(batch.x_m[k] - face.centre_m.x);
    cell.z_cell = sides(batch.z_m[k] - face.centre_m.z);
    if (face.wall) cell.y_cell = sides(y_m - face.centre_m.y);
    return cell;
  }

 private:
  const ScenePlan& plan_;
  std::map<std::uint32_t, double> half_extents_m_;
};

}  // namespace

glm::dvec3 reference_point_m(const World& world, const Cell& cell) {
  if (cell.face != kNoFace)
    return world.buildings.face(cell.face).centre_m +
           cell.side_m * glm::dvec3(static_cast<double>(cell.x_cell), static_cast<double>(cell.y_cell),
                                    static_cast<double>(cell.z_cell));
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

void for_each_sample(const ScenePlan& plan, const std::function<void(const SampleBatch&, std::size_t)>& use) {
  const auto batch = std::make_unique<SampleBatch>();
  FrameStats stats;
  const int n = plan.bins().n_azimuth;
  for (int first = 0; first < n; first += kWedgeAzimuthBins) {
    const AzimuthRange range{first, std::min(kWedgeAzimuthBins, n - first)};
    const auto source = make_sample_source(plan, range, nullptr);
    while (source->fill(*batch, stats))
      for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k) use(*batch, k);
  }
}

double sample_power_w(const ScenePlan& plan, const SampleBatch& batch, std::size_t k) {
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

std::vector<BinShares> shares_of_bins(const ScenePlan& plan) {
  const BinGrid& bins = plan.bins();
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  std::vector<BinShares> shares(static_cast<std::size_t>(bins.n_azimuth) * n_range);
  Cells cells(plan);
  for_each_sample(plan, [&](const SampleBatch& batch, std::size_t k) {
    const double r = batch.slant_range_m[k];
    if (!(r >= bins.r_min_m && r < bins.r_max_m)) return;
    const double at = std::floor((r - bins.r_min_m) / bins.range_spacing_m);
    const auto range_bin = static_cast<std::size_t>(std::min(at, bins.n_range - 1.0));
    shares[static_cast<std::size_t>(batch.azimuth_bin[k]) * n_range + range_bin][cells.of(batch, k)] +=
        sample_power_w(plan, batch, k);
  });
  return shares;
}

std::shared_ptr<const ScenePlan> plan_or_throw(std::shared_ptr<const Scene> scene, RadarSettings settings,
                                               const Pose& pose) {
  settings.speckle = resolved_speckle(settings);
  ScenePlanResult planned = plan_scene(std::move(scene), settings, pose);
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
