#pragma once
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/radar/simd/echoes/range_axis.h"

namespace obliq {

/// What a bin without samples means; decided by the terrain profile, never by the number of rays.
enum class BinState : std::uint8_t {
  not_sampled = 0,  ///< visible surface lies in the bin, but no ray hit it
  sampled = 1,
  shadow = 2,      ///< known surface there, all of it hidden
  no_surface = 3,  ///< void, or outside the elevation model
  nearer_than_ground =
      4,  ///< altitude hole: nearer than all surface of its azimuth, the antenna over known ground
};

/// What a bin of several is, of BinStates: the first of these that one of them is.
inline std::uint8_t joined(std::uint8_t a, std::uint8_t b) {
  for (const BinState state :
       {BinState::sampled, BinState::not_sampled, BinState::shadow, BinState::no_surface})
    if (const auto s = static_cast<std::uint8_t>(state); a == s || b == s) return s;
  return static_cast<std::uint8_t>(BinState::nearer_than_ground);
}

/// Azimuth bins [first, first + count).
struct AzimuthRange {
  int first = 0;
  int count = 0;
};

/// Range bins from `first` to `last`.
struct RangeWindow {
  int first = 0;
  int last = 0;
  bool empty() const { return last < first; }
  bool holds(const RangeWindow& other) const { return first <= other.first && other.last <= last; }
};

/// Azimuth bins are rendered in wedges of this many: a task owns its wedge's bins, so the bits do not depend
/// on the thread count. Fixed, because the order of sums inside a wedge follows from it.
constexpr int kWedgeAzimuthBins = 8;
int wedge_count(int azimuth_bins);

/// Edges of the bins. Azimuth offsets are clockwise from the sector's centre.
struct BinGrid : RangeAxis {
  int n_azimuth = 0;
  double azimuth_start_rad = 0;  ///< -S/2
  double azimuth_width_rad = 0;

  double azimuth_edge_rad(double k) const { return azimuth_start_rad + k * azimuth_width_rad; }
};

/// Which returns are binned. All surfaces hide what lies behind them, whatever is binned.
enum class Surfaces { all, ground, buildings };

/// What the ground is that a bin's mean power comes from, before noise and rain. [bins] each; empty: not
/// wanted.
struct Labels {
  std::vector<std::uint8_t> material;  ///< of the greatest sum of power
  std::vector<float> building;         ///< share of the power that buildings give, 0 without power
  std::vector<float> height_m;         ///< above the datum, weighed by power; NaN without power
  /// Separate stretches of visible surface in the bin, the most of its vertical planes: above 1 is layover.
  std::vector<std::uint8_t> returns;

  static constexpr std::uint8_t kNoMaterial = 255;
};

/// What labels are made of, [bins]: the share of a bin's power that a material or buildings give, or the mean
/// height by power. Material 0 has what the others leave; a share that is not there is 0.
struct LabelShare {
  static constexpr int kBuildings = 256;
  static constexpr int kHeights = 257;
  /// Of a scene with so many materials at most: all but one, buildings and heights.
  static constexpr std::int64_t bytes_a_bin(int materials) { return (materials + 1) * 4; }
  int kind = 0;  ///< a material, or one of these
  std::vector<float> share;
};

/// How much of what labels are made of is worked out, each with what is before it: a canceller needs the
/// powers of materials, of what moves; buildings, heights and returns are for labels alone.
enum class LabelParts { none, materials, all };

/// A run of azimuth bins [first_azimuth, first_azimuth + n_azimuth) of the full range swath.
/// Planes are [n_azimuth][n_range], azimuth clockwise, range outwards.
struct BinBlock {
  int first_azimuth = 0;
  int n_azimuth = 0;
  int n_range = 0;
  std::vector<std::complex<float>> iq;  ///< sqrt(W), normalised sqrt(W) m^2; phase -4 pi r / lambda
  std::vector<double> power_w;          ///< sum of sample powers; normalised in W m^4
  /// Samples in the bin. With nearest plates one a hit; a spread plate has one in every bin and on every
  /// surface that it covers, so that the frame's samples outnumber its hits.
  std::vector<std::uint32_t> count;
  std::vector<std::uint8_t> state;  ///< BinState
  /// Mean sine of elevation of what is in the bin, weighed by power; of a beam's sharp bins, else empty.
  std::vector<float> sin_elevation;
  /// Video in 256 and in 65,536 levels: empty where it is not wanted, or not made yet.
  std::vector<std::uint8_t> video8;
  std::vector<std::uint16_t> video16;
  /// One look of the speckle that video of several looks is made from, a circular complex Gaussian number of
  /// mean square power_w a bin. Empty: neighbouring bins are independent, or no such video is wanted.
  std::vector<std::complex<float>> look;
  Labels labels;
  /// The target whose mean power is the greatest in the bin, the last 32 bits of its id; 0: none. Empty: not
  /// wanted.
  std::vector<std::uint32_t> target;
  std::vector<LabelShare> label_shares;  ///< rising by kind, until labels are made of them (decide_labels)

  /// With all of them but labels.
  static constexpr std::int64_t kBytesABin = 8 + 8 + 4 + 1 + 4 + 1 + 2 + 8;
  static constexpr std::int64_t kLabelBytesABin = 1 + 4 + 4 + 1;

  BinBlock() = default;
  BinBlock(int first, int azimuths, int ranges) : first_azimuth(first), n_azimuth(azimuths), n_range(ranges) {
    const std::size_t n = static_cast<std::size_t>(azimuths) * static_cast<std::size_t>(ranges);
    iq.resize(n);
    power_w.resize(n);
    count.resize(n);
    state.resize(n);
  }
};

/// Copies the azimuth bins that both blocks have. Blocks of different range counts share none.
void copy_azimuths(const BinBlock& from, BinBlock& to);

/// The share of a kind, made of zeros where it is not there yet.
std::vector<float>& label_share(BinBlock& bins, int kind);
/// Makes labels of the shares, all but `returns`, and drops these.
void decide_labels(BinBlock& bins);

/// Counts of one wedge or, added up, of one frame.
struct FrameStats {
  std::uint64_t rays = 0;      ///< generated; of the sweep, vertical planes marched
  std::uint64_t hits = 0;      ///< on any surface, at any range; of the sweep, samples
  std::uint64_t samples = 0;   ///< binned (inside sector and range swath)
  std::uint64_t repaired = 0;  ///< rays that leaked through the mesh, found again in double; among the hits
  std::uint64_t rejected = 0;  ///< leaked rays whose hit was not found: not binned
  double sector_area_m2 = 0;   ///< ground area of the sector between r_min and r_max
  double covered_area_m2 = 0;  ///< of that, over known ground
  std::uint64_t lit_bins =
      0;  ///< that hold visible surface, sampled or not; 0 where no states were asked for
  std::uint64_t unsampled_bins = 0;  ///< of those

  void add(const FrameStats& other) {
    rays += other.rays;
    hits += other.hits;
    samples += other.samples;
    repaired += other.repaired;
    rejected += other.rejected;
    sector_area_m2 += other.sector_area_m2;
    covered_area_m2 += other.covered_area_m2;
    lit_bins += other.lit_bins;
    unsampled_bins += other.unsampled_bins;
  }
  /// Fraction of the sector that known ground covers, 0..1.
  double coverage() const { return sector_area_m2 > 0 ? covered_area_m2 / sector_area_m2 : 0; }
  /// Fraction of the lit bins that no sample fell into, 0..1.
  double unsampled_share() const {
    return lit_bins > 0 ? static_cast<double>(unsampled_bins) / static_cast<double>(lit_bins) : 0;
  }
};

}  // namespace obliq
