#pragma once
#include <cstdint>

#include "server/radar/simd/echoes/cross_section.h"
#include "server/radar/simd/echoes/range_axis.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// The range bins that segments of ground are cut into, and what their powers have in common.
struct GroundCut {
  RangeAxis axis;
  EchoTable echo;
  const std::uint8_t* material;  ///< [nz - 1][nx - 1] of the cells; null: all are 0
  const float* raster_gamma;     ///< [nz - 1][nx - 1] of the cells; null: there is none
  int nx;
  /// Of the first eight runs and of the others: [n_range][8] share of a profile's light that buildings
  /// leave to the ground of a bin; null: all of it.
  const float* kept[2];
  /// [16] rise of the antenna's horizon along each run: ElevationTable's lean along its bearing.
  float lean[16];
  /// [16] SeaTable's lean and half its curve along each run, and what its wind does to each (upwind_terms).
  float sea_lean[16];
  float half_sea_curve[16];
  float upwind[SeaTable::kUpwindTerms][16];
};

/// The ground that a profile sees of a range bin: its power, and where it begins. Sixteen runs of segments go
/// side by side: two planes of eight azimuth bins. Each has one pending bin; the
/// others are in the list in the order in which they ended. Float precision suffices: distances are kept from
/// where a segment begins, ranges to 4 mm at 37 km.
struct GroundEchoes {
  static constexpr int kRuns = 16;
  static constexpr int kLog2Runs = 4;
  static constexpr int kMost = 512;
  static constexpr int kSpare = 16;  ///< elements that may be written behind the last one
  /// Pending: range bin, whole numbers; -1: none.
  float pending_bin[kRuns];
  float pending_distance_m[kRuns];
  float pending_power[kRuns];
  float pending_material[kRuns];
  float pending_sine[kRuns];
  int n;
  std::uint32_t at[kMost + kSpare];  ///< range bin x 16 + run
  float distance_m[kMost + kSpare];  ///< ground distance of its middle, as if all of the bin were seen
  float light[kMost + kSpare];       ///< power over EchoTable::factor, W
  std::uint32_t material[kMost + kSpare];
  float sine[kMost + kSpare];  ///< sine of elevation times light, where the table wants sines
};

/// What labels need of that ground: a stretch of it of one material in one range bin, without a gap. As
/// GroundEchoes, beside which it lies.
struct GroundStretches {
  /// A row of segments adds as many as it adds echoes, and two a run. It begins where those fit: a list that
  /// is full never divides a segment, so that echoes keep their bits.
  static constexpr int kMost = 2 * GroundEchoes::kMost + 3 * GroundEchoes::kRuns + GroundEchoes::kSpare;
  static constexpr int kMaterialBit = 24;
  static constexpr std::uint32_t kPlaces = (std::uint32_t{1} << kMaterialBit) - 1;
  static constexpr float kGap_m = 1.0F / 16;  ///< ends of segments are floats: a shorter gap is none
  float pending_bin[GroundEchoes::kRuns];
  float pending_material[GroundEchoes::kRuns];
  float pending_from_m[GroundEchoes::kRuns];  ///< ground distances of its ends,
  float pending_end_m[GroundEchoes::kRuns];
  float pending_from_h_m[GroundEchoes::kRuns];  ///< and heights above the antenna
  float pending_end_h_m[GroundEchoes::kRuns];
  float pending_power[GroundEchoes::kRuns];
  float pending_height[GroundEchoes::kRuns];
  bool wants_ends;  ///< from_h_m and end_h_m are filled in
  int n;
  std::uint32_t at[kMost];  ///< as in GroundEchoes, and the material from bit kMaterialBit on
  float from_m[kMost], end_m[kMost];
  float from_h_m[kMost], end_h_m[kMost];
  float light[kMost];
  float height[kMost];  ///< above the antenna, times light

  /// Begins a run.
  void start(std::size_t of) {
    pending_bin[of] = -1;
    pending_material[of] = pending_from_m[of] = pending_end_m[of] = pending_from_h_m[of] =
        pending_end_h_m[of] = 0;
    pending_power[of] = pending_height[of] = 0;
  }
  std::uint32_t run(int k) const { return at[k] % GroundEchoes::kRuns; }
  std::uint32_t bin(int k) const { return (at[k] & kPlaces) / GroundEchoes::kRuns; }
  std::uint8_t material(int k) const { return static_cast<std::uint8_t>(at[k] >> kMaterialBit); }
};

/// Rows [first, end) of segments.
struct SegmentRows {
  VisibleSegments* segments;
  int first;
  int end;
};

/// Adds rows of segments, of both runs side by side; what is done is taken off their fronts. False: the list
/// of echoes is full, and what is left of a row stays in its segments, or that of stretches. Stretches: null:
/// not wanted.
OBLIQ_KERNEL(bool, ground_echoes, const GroundCut&, SegmentRows&, SegmentRows&, GroundEchoes&,
             GroundStretches*);

/// Where the ground cells of echoes lie: by range bin, and by profile.
struct PlaceOfEchoes {
  double antenna_x_m, antenna_z_m;
  double sin_bearing[GroundEchoes::kRuns];
  double cos_bearing[GroundEchoes::kRuns];
  const double* cells_per_m;  ///< [n_range] powers of 2
};

/// The ground cell of each echo, as ScattererKey's place and kind. Written up to a multiple of 8.
OBLIQ_KERNEL(void, ground_places, const PlaceOfEchoes&, const GroundEchoes&, std::uint64_t* place,
             std::uint64_t* kind);

}  // namespace obliq
