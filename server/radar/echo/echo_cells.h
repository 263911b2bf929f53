#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "server/radar/echo/bin_sums.h"
#include "server/radar/echo/datum_surface.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/echoes/face_voltages.h"
#include "server/radar/simd/ground/ground_echoes.h"
#include "server/radar/simd/ground/sea_texture.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

/// An echo of a building's face in one range bin.
struct FaceEcho {
  int range_bin;
  std::uint32_t building;
  std::uint32_t face;
  std::uint8_t material;
  double solid_angle_sr;
  double range_m;
  double sec2_incidence;  ///< 1 / cos^2
  glm::dvec3 at_m;        ///< where on the face, for its cell
  bool corner = false;    ///< FacePower's
};

/// Parts of such an echo, as far as they are known: the sum of their powers over EchoTable::factor, and of
/// ranges and places by power.
struct FacePower {
  int range_bin;
  std::uint32_t building;
  std::uint32_t face;
  std::uint8_t material;
  double power;
  double range_m;
  glm::dvec3 at_m;
  bool corner = false;  ///< of the face with the ground at its foot: another scatterer

  void add(const FacePower& other) {
    power += other.power;
    range_m += other.range_m;
    at_m += other.at_m;
  }
};

/// One wedge's sums of echoes that come bin by bin, each a scatterer: the sweep's. Ground echoes of one plane
/// have one ground cell a range bin; where the next plane of the azimuth bin has the same one, both are one
/// scatterer of the sum of their powers. Sums run in the order of arrival.
class EchoCells {
 public:
  /// voltages: false: I&Q is not computed.
  EchoCells(const ScenePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
            Surfaces surfaces, bool voltages, LabelParts labels = LabelParts::none);

  /// Begins with the wedge of this first azimuth bin.
  void restart(int first_azimuth);

  /// The cross sections and the radar equation of all echoes.
  const EchoTable& table() const { return table_; }

  /// Of the planes whose echoes come next: of eight azimuth bins, twice.
  void set_bearing(std::size_t profile, SinCos bearing);
  /// Takes a list and empties it.
  void add(GroundEchoes& echoes);

  LabelParts labels() const { return bins_.labels().parts(); }
  /// Takes what labels need of the ground.
  void add(const GroundStretches& stretches);
  /// Of azimuth bin `profile` of the wedge.
  void add(int profile, const FaceEcho& echo);
  void add(int profile, const FacePower& echo);
  /// The power of a part over EchoTable::factor, by its cross section and place.
  double power_of(double cross_section_m2, double range_m, const glm::dvec3& at_m) const;

  /// Ground that is seen over terrain and hidden by buildings.
  void mark_building_shadow(int profile, int range_bin, bool hidden) {
    shadow_[BinSums::index(profile, range_bin)] |= static_cast<std::uint8_t>(hidden);
  }

  /// Echoes so far.
  std::uint64_t count() const { return echoes_; }

  /// Writes I&Q, power and count of all bins and the states that follow. Add nothing after it before a
  /// restart.
  void write(BinBlock& block);

  static std::int64_t bytes(int n_range) {
    return BinSums::bytes(n_range) +
           std::int64_t{n_range} * kWedgeAzimuthBins * static_cast<std::int64_t>(sizeof(LastCell) + 1);
  }

 private:
  /// The ground cell that a bin's last echo came from: the low bits of its numbers, and its material. No bin
  /// holds two cells that agree in them.
  struct LastCell {
    std::uint32_t key;
    float amplitude;  ///< square root of its power in the bin so far
  };
  /// Echoes of the list; sine: times light.
  void add_with_voltages(int n, const float* sine);
  void put_face(int profile, const FaceEcho& echo, double light);
  void put_on_face(int k, const SpeckleField::OnFace& of);
  void put_on_same_face(int k);
  double elevation_gain2(const glm::dvec3& at_m, double range_m) const;
  void take_faces();
  PiecesOfBins pieces_of_bins() const;
  void texture_of(const GroundStretches& stretches, float* tau) const;

  const ScenePlan& plan_;
  const SpeckleField& speckle_;
  Surfaces surfaces_;
  BinSums bins_;
  EchoTable table_;
  const SeaTexture* texture_;          // null: none
  std::unique_ptr<SeaPieces> pieces_;  // where there is one
  std::vector<double> cells_per_m_;    // [n_range]
  PlaceOfEchoes where_;
  std::vector<LastCell> last_;        // [n_range][8]
  std::vector<std::uint8_t> shadow_;  // [n_range][8]
  std::uint64_t echoes_ = 0;

  // Of a list.
  static constexpr std::size_t kList = GroundEchoes::kMost + GroundEchoes::kSpare;
  std::uint32_t list_at_[kList]{};
  std::uint64_t list_place_[kList];
  std::uint64_t list_kind_[kList];
  double list_power_w_[kList]{};
  FaceEchoes faces_{};
  FaceBins face_bins_{};
  std::uint32_t face_[FaceEchoes::kMost];
  double face_sine_[FaceEchoes::kMost]{};
  double face_height_m_[FaceEchoes::kMost];

  // Of labels.
  DatumSurface datum_;
};

}  // namespace obliq
