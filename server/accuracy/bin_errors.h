#pragma once
// How far a frame's power is from the truth: the measures of PAPER.md, "Definitions".
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "server/truth/reference.h"
#include "terrain/buildings/buildings.h"

namespace obliq {

/// The range bins that two power planes share.
struct RangeBins {
  double r_min_m = 0;
  double spacing_m = 0;
  int n_range = 0;
  bool range_normalisation = false;  ///< the planes' powers carry r^4 already

  double centre_m(int bin) const { return r_min_m + (bin + 0.5) * spacing_m; }

  /// q = r^3 T, r the bin's centre: near and far bins of like ground weigh alike. For planes with range
  /// normalisation, T r^4 is what they hold, and q is that over r.
  double q(int bin, double power_w) const {
    const double r_m = centre_m(bin);
    return range_normalisation ? power_w / r_m : power_w * (r_m * r_m * r_m);
  }
};

/// P is the frame's power of a bin, T the truth's. Bins with T > 0 have M, the median of their q; lit: q >=
/// 1e-3 M; dark: T = 0; the rest is ignored. Measures over lit bins are 0 when there is none, and the
/// decibels when none has P > 0: nothing was compared then, which is not the same as no error.
struct BinErrors {
  std::uint64_t bins = 0;
  std::uint64_t lit = 0;
  std::uint64_t dark = 0;
  std::uint64_t dont_care = 0;  ///< 0 < q < 1e-3 M
  double median_q = 0;          ///< M

  double power_error = 0;         ///< E = sqrt(sum q^2 (P/T - 1)^2 / sum q^2) over lit bins
  double median_db = 0;           ///< of |10 log10 P/T| over lit bins with P > 0
  double percentile95_db = 0;     ///< the same, 95th percentile
  double mean_relative = 0;       ///< mean of min(|P/T - 1|, 1) over lit bins
  double energy_w = 0;            ///< sum of P over all bins
  double truth_energy_w = 0;      ///< sum of T over all bins
  std::uint64_t gaps = 0;         ///< lit, P = 0
  std::uint64_t false_light = 0;  ///< dark, P > 0
  double false_light_w = 0;       ///< sum of P over them

  /// Total energy against the truth's, -1 when all is missing; 0 when the truth has none.
  double energy_error() const { return truth_energy_w > 0 ? energy_w / truth_energy_w - 1 : 0; }
  /// Lit bins with P > 0: those that the decibels are of.
  std::uint64_t compared() const { return lit - gaps; }
  /// Of the lit bins, 0..1.
  double gap_fraction() const { return share(gaps, lit); }
  /// Of the dark bins, 0..1.
  double false_light_fraction() const { return share(false_light, dark); }
  /// Of the truth's total energy.
  double false_light_energy() const { return truth_energy_w > 0 ? false_light_w / truth_energy_w : 0; }

 private:
  static double share(std::uint64_t part, std::uint64_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};

/// Compares two planes [n_azimuth][n_range], in W. Throws std::logic_error when their sizes do not fit or a
/// power is negative or no number.
BinErrors bin_errors(std::span<const double> power_w, std::span<const double> truth_w,
                     const RangeBins& ranges);

/// Whether the truth sees a building: at least 1 % of its unoccluded solid angle, and at least 1 % of the
/// power of one bin. A source that then has no sample of it has missed it.
bool truth_sees_building(double visible_sr, double unoccluded_sr, double largest_share);

// Which buildings a frame missed (PAPER.md, definitions).

struct BuildingErrors {
  std::uint32_t visible = 0;  ///< the truth sees them (truth_sees_building)
  std::uint32_t missed = 0;   ///< of those, no sample carries their id
};

constexpr std::uint32_t kNoBuilding = 0xffffffffu;

/// truth[i] is of building i of the truth's world; seen(i) whether the frame has a sample of it.
BuildingErrors missed_buildings(const std::vector<BuildingTruth>& truth,
                                const std::function<bool(std::uint32_t)>& seen);

/// For each building of one world the index of the building with the same outline in another, kNoBuilding
/// where there is none. The two differ in cell size: roofs then differ, outlines do not.
std::vector<std::uint32_t> match_buildings(const Buildings& from, const Buildings& to);

}  // namespace obliq
