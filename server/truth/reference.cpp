#include "server/truth/reference.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <utility>

#include "server/truth/plane_walk.h"
#include "server/truth/strip_integral.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

void require(bool ok, const char* field, double found, const char* allowed) {
  if (!ok) throw InputError(FieldError{field, std::to_string(found), allowed}.text());
}

void check_numbers(const ReferenceView& view, const ReferenceSampling& sampling, int first_azimuth,
                   int n_azimuth) {
  const glm::dvec3& at = view.antenna_m;
  require(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z), "antenna_m", at.y,
          "finite coordinates");
  require(std::isfinite(view.bearing_rad), "bearing_rad", view.bearing_rad, "a finite angle");
  require(view.sector_rad > 0 && view.sector_rad <= 2 * std::numbers::pi * (1 + 1e-12), "sector_rad",
          view.sector_rad, "more than 0, at most one turn");
  require(view.azimuth_bins >= 1, "azimuth_bins", view.azimuth_bins, "1 or more");
  require(view.range_bins >= 1, "range_bins", view.range_bins, "1 or more");
  require(view.r_min_m >= 0, "r_min_m", view.r_min_m, "0 or more");
  require(view.r_max_m > view.r_min_m && std::isfinite(view.r_max_m), "r_max_m", view.r_max_m,
          "more than r_min_m");
  require(view.wavelength_m > 0 && std::isfinite(view.wavelength_m), "wavelength_m", view.wavelength_m,
          "a positive number of metres");
  require(view.power_w >= 0 && std::isfinite(view.power_w), "power_w", view.power_w, "0 or more");
  require(view.gain >= 0 && std::isfinite(view.gain), "gain", view.gain, "0 or more");
  require(sampling.planes_per_bin >= 1, "planes_per_bin", sampling.planes_per_bin, "1 or more");
  require(sampling.step_m > 0, "step_m", sampling.step_m, "a positive number of metres");
  require(first_azimuth >= 0, "first_azimuth", first_azimuth, "0 or more");
  require(n_azimuth >= 0 && n_azimuth <= view.azimuth_bins - first_azimuth, "n_azimuth", n_azimuth,
          "bins of the sector");
}

void check_material(const std::vector<Material>& materials, std::uint8_t id) {
  if (id >= materials.size())
    throw InputError("material " + std::to_string(id) + " of the world: found " +
                     std::to_string(materials.size()) + " materials; allowed: one for every id");
  if (materials[id].model == ScatteringModel::flat_plate)
    throw InputError("material \"" + materials[id].name +
                     "\": found the flat_plate model; allowed for the reference: constant_gamma or "
                     "geometric_optics (a flat plate's power depends on how finely a surface is cut)");
}

/// Refuses materials that the world uses and the truth cannot.
void check_materials(const World& world, const std::vector<Material>& materials) {
  std::vector<bool> used(256, false);
  if (world.surface_material.empty()) used[0] = true;
  for (const std::uint8_t id : world.surface_material) used[id] = true;
  for (const Building& building : world.buildings.list) used[building.material] = true;
  for (std::size_t id = 0; id < used.size(); ++id)
    if (used[id]) check_material(materials, static_cast<std::uint8_t>(id));
}

void check_antenna(const World& world, const SightedBuildings& sighted,
                   const std::vector<std::uint32_t>& near, const glm::dvec3& antenna_m) {
  const double ground_y_m = world.grid.height_at_m(antenna_m.x, antenna_m.z);
  if (antenna_m.y <= ground_y_m)
    throw InputError("antenna_m: found " + std::to_string(ground_y_m - antenna_m.y) +
                     " m below the ground; allowed: above it");
  std::vector<OutlineCrossing> unused;
  for (const std::uint32_t b : near)
    if (sighted.cross(b, {0, 1}, 0, unused) && antenna_m.y <= world.buildings.list[b].roof_y_m)
      throw InputError("antenna_m: found inside building " + std::to_string(b) +
                       "; allowed: outside every building");
}

/// The buildings of one azimuth bin.
struct BinBuildings {
  std::vector<std::pair<std::uint32_t, BuildingTruth>> seen;  ///< by index, rising
};

/// A vertical plane in an azimuth bin and the azimuth it stands for.
struct PlaneSpot {
  double from_start_rad;  ///< clockwise from the sector's start
  double width_rad;
};

/// The middles of equal parts of every stretch between corners of buildings, no part wider than the bin's
/// share of a plane. Corners closer together than a millionth of the bin count as one.
std::vector<PlaneSpot> place_planes(const SightedBuildings& sighted, int azimuth, double bin_width_rad,
                                    int planes_per_bin) {
  std::vector<PlaneSpot> spots;
  std::vector<double> ends = sighted.corner_bearings_rad(azimuth);
  ends.push_back((azimuth + 1) * bin_width_rad);
  double from = azimuth * bin_width_rad;
  for (const double end : ends) {
    const double stretch = end - from;
    if (stretch < 1e-6 * bin_width_rad && end != ends.back()) continue;
    const int n = std::max(1, static_cast<int>(std::ceil(stretch / bin_width_rad * planes_per_bin - 1e-9)));
    for (int k = 0; k < n; ++k) spots.push_back({from + (k + 0.5) / n * stretch, stretch / n});
    from = end;
  }
  return spots;
}

/// All that one thread needs to integrate azimuth bins of its own.
class BinIntegrator {
 public:
  BinIntegrator(const World& world, const SightedBuildings& sighted, const ReferenceView& view,
                const ReferenceSampling& sampling, const StripIntegral& integral,
                const CornerIntegral& corners)
      : sighted_(sighted),
        view_(view),
        planes_per_bin_(sampling.planes_per_bin),
        integral_(integral),
        corners_(corners),
        walk_(world, sighted, view) {}

  /// ground_w, building_w: [n_range] of this azimuth bin, zero at first. facets may be null.
  BinBuildings run(int azimuth, double* ground_w, double* building_w, std::vector<FacetEcho>* facets) {
    std::map<std::uint32_t, BuildingTruth> seen;
    std::map<std::pair<std::uint32_t, int>, double> power_by_bin_w;
    const double width_rad = view_.sector_rad / view_.azimuth_bins;
    for (const PlaneSpot& spot : place_planes(sighted_, azimuth, width_rad, planes_per_bin_)) {
      const double bearing_rad = view_.bearing_rad - view_.sector_rad / 2 + spot.from_start_rad;
      walk_.walk(bearing_rad, azimuth, strips_);
      const auto take_shares = [&](std::int32_t of) {
        for (const BinShare& share : shares_) {
          if (facets != nullptr && share.power_w > 0)
            facets->push_back({share.range_bin, of != kGroundStrip, share.power_w,
                               share.sine_w / share.power_w, share.height_w / share.power_w});
          if (of == kGroundStrip) {
            ground_w[share.range_bin] += share.power_w;
            continue;
          }
          const auto building = static_cast<std::uint32_t>(of);
          building_w[share.range_bin] += share.power_w;
          power_by_bin_w[{building, share.range_bin}] += share.power_w;
          seen[building].visible_sr += share.solid_angle_sr;
        }
        shares_.clear();
      };
      shares_.clear();
      for (const Strip& strip : strips_.lit) {
        integral_.add(strip, bearing_rad, spot.width_rad, shares_);
        take_shares(strip.building);
      }
      for (const LitFoot& foot : strips_.feet) {
        corners_.add(foot, bearing_rad, spot.width_rad, shares_);
        take_shares(foot.building);
      }
      for (const Strip& strip : strips_.alone) {
        shares_.clear();
        integral_.add(strip, bearing_rad, spot.width_rad, shares_);
        for (const BinShare& share : shares_)
          seen[static_cast<std::uint32_t>(strip.building)].unoccluded_sr += share.solid_angle_sr;
      }
    }
    for (const auto& [key, power_w] : power_by_bin_w) {
      const double total_w = ground_w[key.second] + building_w[key.second];
      double& largest = seen[key.first].largest_share;
      if (total_w > 0) largest = std::max(largest, power_w / total_w);
    }
    return {{seen.begin(), seen.end()}};
  }

 private:
  const SightedBuildings& sighted_;
  const ReferenceView& view_;
  int planes_per_bin_;
  const StripIntegral& integral_;
  const CornerIntegral& corners_;
  PlaneWalk walk_;
  PlaneStrips strips_;
  std::vector<BinShare> shares_;
};

/// Calls work(item) for every item in [0, n) with one `make()` a thread. The first exception is passed on.
template <class Make>
void share_out(int n, int threads, const Progress& progress, const Make& make) {
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  int done = 0;
  const auto run = [&] {
    try {
      auto work = make();
      for (int item = next++; item < n; item = next++) {
        work(item);
        const std::scoped_lock lock(mutex);
        if (progress) progress("truth", static_cast<double>(++done) / n);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
      next = n;
    }
  };
  if (threads <= 0) threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  {
    std::vector<std::jthread> others;
    for (int k = 1; k < std::min(threads, n); ++k) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

ReferenceBins integrate_reference(const World& world, const std::vector<Material>& materials,
                                  const ReferenceView& view, const ReferenceSampling& sampling,
                                  int first_azimuth, int n_azimuth, const Progress& progress) {
  check_numbers(view, sampling, first_azimuth, n_azimuth);
  check_materials(world, materials);
  ReferenceBins bins;
  bins.first_azimuth = first_azimuth;
  bins.n_azimuth = n_azimuth;
  bins.n_range = view.range_bins;
  const auto n_range = static_cast<std::size_t>(view.range_bins);
  bins.ground_w.assign(static_cast<std::size_t>(n_azimuth) * n_range, 0.0);
  bins.building_w = bins.ground_w;
  if (view.keeps_facets) bins.facets.resize(static_cast<std::size_t>(n_azimuth));
  bins.buildings.resize(world.buildings.list.size());
  if (n_azimuth == 0) return bins;

  const SightedBuildings sighted(world.buildings, view, first_azimuth, n_azimuth);
  check_antenna(world, sighted, sighted.in_bin(first_azimuth), view.antenna_m);
  const StripIntegral integral(world, materials, view, sampling.step_m);
  const CornerIntegral corners(world, materials, view, sampling.step_m / 4);
  std::vector<BinBuildings> by_bin(static_cast<std::size_t>(n_azimuth));
  share_out(n_azimuth, sampling.threads, progress, [&] {
    return [&, integrator = BinIntegrator(world, sighted, view, sampling, integral, corners)](int a) mutable {
      const std::size_t row = static_cast<std::size_t>(a) * n_range;
      by_bin[static_cast<std::size_t>(a)] =
          integrator.run(first_azimuth + a, bins.ground_w.data() + row, bins.building_w.data() + row,
                         view.keeps_facets ? &bins.facets[static_cast<std::size_t>(a)] : nullptr);
    };
  });

  for (const BinBuildings& bin : by_bin)
    for (const auto& [building, truth] : bin.seen) bins.buildings[building].add(truth);
  return bins;
}

}  // namespace obliq
