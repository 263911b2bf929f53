#pragma once
// The echoes of targets. One of mean cross section s at range r, bearing th and elevation e, of which the
// share f is seen, adds to bin (k, m)
//   voltage  sqrt(K s chi f L) / r^2 G_el(e) g((th - th_k) cos e) p(r_m - r) exp(j (phi - 4 pi r / lambda))
//   power    K s f L / r^4 G_el(e)^2 g^2 p^2
// and behind a Doppler filter both with its response at the target's Doppler (DopplerPlan::weight),
// with all that the echoes of the ground have too: K of the radar equation (antenna_gain.h), the loss L of
// the path, the elevation pattern G_el, the one-way power g of the beam and the point response p; chi and phi
// are of the look (fluctuation.h). A radar without a beam or a pulse has all of it in the bin that holds the
// target.
#include <complex>
#include <cstdint>
#include <vector>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/targets/fluctuation.h"
#include "server/radar/targets/seen_share.h"
#include "server/radar/targets/target.h"
#include "server/radar/targets/target_place.h"

namespace obliq {

/// p + v t + a t^2 / 2 from now on, in the world.
struct TargetPath {
  glm::dvec3 at_m{0.0};
  glm::dvec3 velocity_m_s{0.0};
  glm::dvec3 acceleration_m_s2{0.0};
};

/// How a scatterer fluctuates.
struct TargetScintillation {
  int swerling = 0;
  std::uint64_t id = 0;  ///< whose draws it has
};

/// Of one scatterer of a target that is seen, before beam and point response.
struct TargetEcho {
  std::uint64_t id = 0;
  double range_m = 0;
  double cos_elevation = 1;  ///< about the axis that the antenna turns on
  // In azimuth bins from the sector's left edge: where it is, and how far off it is still seen.
  double position = 0;
  double extent_bins = 0;
  std::vector<float> responses;  ///< in range bins from first_range on
  int first_range = 0;
  double doppler_hz = 0;              ///< of the radar's own motion and the target's
  double power_w = 0;                 ///< mean
  std::complex<double> voltage{0.0};  ///< sqrt(W), with the draw and the phase of the way
  TargetPath path;                    ///< where it was asked for (TargetLook::moves)
  std::complex<double> drawn{0.0};    ///< what the mean's voltage is multiplied by
  TargetScintillation scintillation;
};

/// Where a target is in a frame, seen or not.
struct TargetTruth {
  std::uint64_t id = 0;
  glm::dvec3 foot_m{0.0};  ///< in the world
  double height_m = 0;     ///< above the datum
  double azimuth_rad = 0;  ///< clockwise from the sector's left edge
  double range_m = 0;      ///< slant
  double elevation_rad = 0;
  double closing_m_s = 0;  ///< of target and antenna together
  double power_w = 0;      ///< as drawn, in the middle of beam and pulse, before the receiver; 0: hidden
  double rcs_m2 = 0;       ///< as drawn, all of it
  double share = 0;        ///< of it that is seen
  HiddenBy hidden_by = HiddenBy::nothing;
  int azimuth_bin = -1;  ///< -1: none of the frame's
  int range_bin = -1;
};

/// What the targets of a frame add to its bins. Each target in the order of the list, each wedge by itself,
/// so that the bits do not depend on threads. Immutable.
class TargetEchoes {
 public:
  /// At the time of the plan's pose; of targets that no bin of `azimuths` sees, no echoes.
  TargetEchoes(const FramePlan& plan, const AirView& air, const TargetSet& targets, AzimuthRange azimuths,
               const TargetLook& look);

  /// To the echoes of the ground, before the receiver: power, I&Q where they are wanted, and the look of
  /// video. Counts, states and labels are the ground's.
  void add(BinBlock& bins, bool iq) const;
  /// Which of them is the strongest in each bin, into BinBlock::target.
  void name(BinBlock& bins) const;

  const std::vector<TargetEcho>& echoes() const { return echoes_; }
  /// Where a point is seen, without what it returns.
  TargetEcho look_at(const glm::dvec3& at_m) const;
  /// TargetEcho::drawn of one pulse of a train, from 0 on.
  std::complex<double> drawn_in_pulse(const TargetEcho& echo, int pulse) const;
  /// Where it was asked for, of those that are in the world: of all for a frame's whole sector, else of those
  /// in `azimuths`.
  const std::vector<TargetTruth>& truth() const { return truth_; }

 private:
  void see(const Target& target);
  void note_truth(const Target& target, double age_s, const TargetPlace& place, const TargetEcho& at);
  double closing_m_s(const Target& target, double age_s, const TargetPlace& place) const;
  TargetPath path_of(const Target& target, double age_s, const TargetPlace& place) const;
  /// What of it echoes by itself.
  struct Scatterer {
    glm::dvec3 at_m{0.0};
    double part = 1;                  ///< of the mean cross section
    std::complex<double> drawn{0.0};  ///< what the voltage of the mean is multiplied by
    TargetScintillation scintillation;
  };
  std::vector<Scatterer> scatterers(const Target& target, const TargetPlace& place) const;
  void add_scatterer(std::uint64_t id, const Scatterer& scatterer, double rcs_m2, double closing_m_s,
                     const TargetPath& path);
  /// About the antenna's own vertical, as the ground's is.
  double elevation_rad(const glm::dvec3& at_m, double range_m) const;
  /// Of its aspect, mean, m^2.
  double cross_section(const Target& target, const TargetPlace& place) const;
  /// In the middle of beam and pulse.
  double power_w(const glm::dvec3& at_m, double range_m, double rcs_m2) const;
  /// Calls with each azimuth of the bins that a target reaches, the gain there and the row's first bin.
  template <typename Call>
  void each_row(const TargetEcho& echo, const BinBlock& bins, const Call& call) const;
  static void add_to_row(const TargetEcho& echo, std::complex<double> gain, std::size_t row, BinBlock& bins,
                         bool iq);
  /// How far a place in azimuth is from the target, in bins, the short way round.
  double bins_away(const TargetEcho& echo, double position) const;
  /// Whether any of these azimuth bins may see it; aside_bins: of its parts from its middle.
  bool reaches(const TargetEcho& echo, AzimuthRange azimuths, double aside_bins = 0) const;
  /// Two-way voltage pattern so many pulses before; without a beam 1 in the bin that holds the target.
  double azimuth_gain(const TargetEcho& echo, int azimuth, int pulses_before = 0) const;
  /// That, behind the filter of a mode that looks at Doppler.
  std::complex<double> azimuth_weight(const TargetEcho& echo, int azimuth) const;
  void respond(TargetEcho& echo) const;

  const FramePlan& plan_;
  const DopplerPlan* const doppler_;  ///< null: a map
  const AzimuthRange azimuths_;
  const TargetMoment at_;
  const TargetDraw draw_;
  const RadarSettings& settings_;
  const AzimuthPattern azimuth_;
  const ElevationGain elevation_;
  const PointResponse response_;
  const BeamOnGround beam_;
  const double wavelength_m_;
  const double constant_;  ///< of the radar equation
  const double gain_;
  const double circle_bins_;  ///< azimuth bins all the way round
  double loss_db_km_ = 0;
  std::vector<double> range2_m2_;  ///< [n_range] of range normalisation; else empty
  const bool wants_truth_;
  const bool wants_paths_;
  std::vector<TargetEcho> echoes_;
  std::vector<TargetTruth> truth_;
};

/// Adds targets to the echoes of the ground, and names them where ids are wanted. Null: there are none.
void add_targets(const TargetEchoes* targets, BinBlock& bins, bool iq, bool ids);

}  // namespace obliq
