#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/radar/beam/antenna_axes.h"
#include "server/radar/beam/antenna_gain.h"
#include "server/radar/bins.h"
#include "server/radar/geometry/azimuth_buildings.h"
#include "server/radar/geometry/perspective_frustum.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/geometry/sector_extent.h"
#include "server/radar/settings.h"
#include "server/radar/simd/echoes/scatterer_owner.h"
#include "server/scene/scene.h"

namespace obliq {

class ScenePlan;

/// `plan` is null when `errors` is not empty.
struct ScenePlanResult {
  std::shared_ptr<const ScenePlan> plan;
  std::vector<FieldError> errors;
};
/// Plans what is looked at with settings whose speckle is resolved and that sampling_faults() lets pass.
/// widths: of the beam that its bins are the sharp ones of; null: of none. axes: of the antenna, about the
/// sector's centre. is_coherent_sum: ScenePlan's.
ScenePlanResult plan_scene(std::shared_ptr<const Scene> scene, const RadarSettings& settings,
                           const Pose& pose, bool is_coherent_sum = false, const BeamWidths* widths = nullptr,
                           const AntennaAxes& axes = {});

/// Bins of these settings' sector and swath.
BinGrid bin_grid(const RadarSettings& settings);

/// y of the ground under the antenna, or of the lowest in the sector.
double ground_y_m(const Pose& pose, const SectorExtent& extent);

/// Why this beam cannot look with that tilt.
void check_elevation(const BeamSettings& beam, double tilt_deg, std::vector<FieldError>& errors);

/// Whether frames may need scene.tracer(): for all rays, or for those that come near buildings.
bool needs_tracer(const Scene& scene, FrustumKind frustum);

/// Which buildings have been seen. Marked from several threads at once.
class SeenBuildings {
 public:
  explicit SeenBuildings(std::size_t n_buildings) : flags_(n_buildings) {}

  void mark(std::uint32_t building) {
    // Written once, so that threads do not fight over the cache line.
    if (!has(building)) flags_[building].store(1, std::memory_order_relaxed);
  }
  /// So that its line of memory is cached when it is marked. Inlined: a compiler leaves out calls of what
  /// only asks.
  [[gnu::always_inline]] void ask_for(std::uint32_t building) const { __builtin_prefetch(&flags_[building]); }
  void mark(const std::vector<std::uint32_t>& buildings) {
    for (const std::uint32_t b : buildings) mark(b);
  }

  bool has(std::uint32_t building) const { return flags_[building].load(std::memory_order_relaxed) != 0; }
  std::uint32_t count() const {
    std::uint32_t n = 0;
    for (const auto& flag : flags_) n += flag.load(std::memory_order_relaxed);
    return n;
  }
  /// Rising.
  std::vector<std::uint32_t> list() const {
    std::vector<std::uint32_t> seen;
    for (std::uint32_t b = 0; b < flags_.size(); ++b)
      if (has(b)) seen.push_back(b);
    return seen;
  }

 private:
  std::vector<std::atomic<std::uint8_t>> flags_;
};

/// What is looked at and from where: sector, surface, buildings, the frustum's samples. Its bins are sharp,
/// and it knows no others: what a display gets is made of them (FramePlan). Immutable but for the buildings
/// seen.
class ScenePlan {
 public:
  ScenePlan(std::shared_ptr<const Scene> scene, const RadarSettings& settings, const Pose& pose,
            bool is_coherent_sum, const BeamWidths* widths, const AntennaAxes& axes);

  /// The same for another frame, with another number and date of the same antenna, and no building seen yet.
  std::shared_ptr<ScenePlan> again(const PoseSettings& pose) const;

  const Scene& scene() const { return *scene_; }
  const RadarSettings& settings() const { return settings_; }
  const Pose& pose() const { return pose_; }
  const Sector& sector() const { return sector_; }
  const SectorExtent& extent() const { return extent_; }
  const SectorBox& box() const { return box_; }
  const BinGrid& bins() const { return bins_; }
  /// Symmetric and oblique frusta; meaningless for the sweep.
  const PerspectiveFrustum& camera() const { return camera_; }
  double wavelength_m() const { return wavelength_m_; }
  /// World angle of an azimuth position, in bins from the sector's left edge.
  double bearing_rad(double position) const { return sector_.bearing_rad + bins_.azimuth_edge_rad(position); }

  /// Of the wedge that begins with an azimuth bin.
  WedgeEdges wedge_edges(int first_azimuth) const;

  /// Indices, rising, of all buildings that overlap an azimuth bin within building_reach_m(), and of some
  /// that only come close.
  std::span<const std::uint32_t> buildings_in(int azimuth_bin) const { return buildings_->in(azimuth_bin); }
  /// Those of several azimuth bins, each once, rising.
  std::vector<std::uint32_t> buildings_in(AzimuthRange range) const { return buildings_->in(range); }

  /// The sweep divides a bin from up to a cell in front of a building: buildings just beyond the swath count,
  /// or nearer bins would depend on where the swath ends.
  double building_reach_m() const;

  /// Towards every direction.
  const AntennaGain& antenna_gain() const { return *antenna_gain_; }

  /// Its bins are added up as voltages, so each scatterer must be in one of them.
  bool is_coherent_sum() const { return is_coherent_sum_; }

  /// By this plan's wedges.
  SeenBuildings& seen() const { return *seen_; }

 private:
  friend ScenePlanResult plan_scene(std::shared_ptr<const Scene>, const RadarSettings&, const Pose&, bool,
                                    const BeamWidths*, const AntennaAxes&);
  ScenePlan(const ScenePlan&) = default;

  std::shared_ptr<const Scene> scene_;
  RadarSettings settings_;
  Pose pose_;
  Sector sector_;
  SectorExtent extent_;
  SectorBox box_;
  BinGrid bins_;
  PerspectiveFrustum camera_;
  double wavelength_m_;
  std::shared_ptr<const AzimuthBuildings> buildings_;
  std::shared_ptr<SeenBuildings> seen_;
  std::shared_ptr<const AntennaGain> antenna_gain_;
  bool is_coherent_sum_;
};

}  // namespace obliq
