#pragma once
// Cuts visible segments of surface into samples: one range bin each, exact in range and solid angle.
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/profile/line_of_sight.h"
#include "server/radar/samples.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// A vertical plane's share of the azimuth: what each segment in it stands for.
struct PlaneShare {
  std::int32_t azimuth_bin = 0;
  double azimuth_offset_rad = 0;  ///< of the plane, clockwise from the sector's centre
  double width_rad = 0;           ///< solid angle = width (sin of the upper elevation - sin of the lower)
  SinCos bearing{0, 1};           ///< world angle of the plane
};

/// Appends samples to a batch; those that do not fit wait for the next one.
class SegmentSampler {
 public:
  explicit SegmentSampler(const ScenePlan& plan)
      : bins_(plan.bins()),
        bins_per_m_(1 / plan.bins().range_spacing_m),
        grid_(plan.scene().world().grid),
        antenna_m_(plan.sector().antenna_m) {}

  /// Samples go here from now on, those that were left over first.
  void begin(SampleBatch& batch);
  /// No more than a few segments should be added.
  bool full() const { return batch_->n > kBatch - kSpare || !waiting_.empty(); }
  bool anything_waiting() const { return !waiting_.empty(); }

  void set(const PlaneShare& share) { share_ = share; }
  void set_turn(double turn_rad) { turn_rad_ = turn_rad; }
  void set_width(double width_rad) { share_.width_rad = width_rad; }

  /// Cuts the segment at the edges of the range bins, by solving |A + t D| = edge, and where its direction
  /// from the antenna has turned by more than turn_rad. A wall that stands aslant runs through range across
  /// the plane's width: it is divided where it passes from one range bin to the next.
  void visible(const VisibleSegment& segment);

  /// Incidence and range are taken as constant over at most this angle. A lobe of rms slope s is then off by
  /// (kMostTurn_rad / s)^2 / 24 at its flank, 0.1 % at s = 0.1; the radar equation's integrand by
  /// (kMostTurn_rad / tan(depression))^2 / 12 on slopes, and not at all on level ground.
  static constexpr double kMostTurn_rad = 1.0 / 64;

 private:
  static constexpr int kSpare = 32;
  static constexpr int kMostEdges = 64;  // that an aslant wall is divided at; more are left to even parts

  /// A point of the segment.
  struct At {
    double t;
    double r_m;
  };

  At at(const VisibleSegment& segment, double t) const {
    const double d = segment.ground_range_m(t);
    const double h = segment.height_m(t);
    return {t, std::sqrt(d * d + h * h)};
  }
  void straight(const VisibleSegment& segment);
  void aslant(const VisibleSegment& segment);
  /// Range rises or falls all the way.
  void cut_at_bins(const VisibleSegment& segment, At from, At to);
  /// In one range bin.
  void add_part(const VisibleSegment& segment, At from, At to, int depth);
  void put(const Sample& sample);

  double turn_rad_ = kMostTurn_rad;
  const BinGrid& bins_;
  double bins_per_m_;
  const HeightGrid& grid_;
  glm::dvec3 antenna_m_;
  PlaneShare share_;
  SampleBatch* batch_ = nullptr;
  std::vector<Sample> waiting_;
  std::vector<double> cuts_;
};

}  // namespace obliq
