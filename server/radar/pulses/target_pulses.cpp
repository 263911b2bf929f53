#include "server/radar/pulses/target_pulses.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/radar/geometry/antenna_velocity.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Of the beam at its peak: pulses with less are left as they are.
constexpr double kLeastGain = 1e-4;
/// In units of ask(): a place in a pulse, a gate.
constexpr int kPlaceWork = 60;
constexpr int kTargetGateWork = 10;

class TargetPulses {
 public:
  TargetPulses(const FramePlan& plan, const TargetEchoes& targets, const PulseTimes& times,
               const Boresight& boresight, const PulseTrip& trip, PulseTrain& train)
      : plan_(plan),
        s_(plan.settings()),
        targets_(targets),
        times_(times),
        boresight_(boresight),
        shift_m_(trip.shift_m),
        train_(train),
        pattern_(s_),
        beam_(pattern_, 0, plan.sum()->row_rad()),
        response_(s_),
        wavelength_m_(wavelength_at(s_.frequency_ghz)),
        antenna_m_s_(antenna_velocity_m_s(plan.scene().world(), plan.pose())) {
    if (s_.pulse.kind != PulseKind::compressed) return;
    // Nearer by f tau c / 2B for f = 2 v / lambda.
    coupling_s_ = 2 / wavelength_m_ * s_.pulse.length_us * 1e-6 * response_.resolution_m();
  }

  void add(const TargetEcho& echo, int pulse) const {
    const double t_s = times_.at_s(pulse);
    const TargetPath& path = echo.path;
    const glm::dvec3 at_m = path.at_m + t_s * (path.velocity_m_s + t_s / 2 * path.acceleration_m_s2);
    // As seen from where the antenna is in the middle of the train.
    const TargetEcho seen = targets_.look_at(at_m - t_s * antenna_m_s_);
    ask(kPlaceWork);
    const double azimuth_rad = plan_.sum()->start_rad + seen.position * plan_.bins().azimuth_width_rad;
    const double beside_rad = std::remainder(azimuth_rad - boresight_.at_rad(t_s), kTurn_rad);
    const double gain = beam_.gain(beside_rad, seen.cos_elevation);
    if (std::abs(gain) <= kLeastGain) return;
    const glm::dvec3 way_m = path.at_m - plan_.sector().antenna_m;
    const glm::dvec3 moves_m_s = path.velocity_m_s + t_s * path.acceleration_m_s2;
    const double closing_m_s = -glm::dot(moves_m_s, way_m) / std::max(1.0, glm::length(way_m));
    const bool is_cut = shift_m_ > 0 && s_.pulse.eclipse && s_.pulse.kind != PulseKind::off;
    const double left = is_cut ? std::max(0.0, response_.left_by_eclipse(seen.range_m - shift_m_)) : 1;
    const double round_trips = 2 * seen.range_m / wavelength_m_;
    const SinCos phase = sincos_turns(-(round_trips - std::floor(round_trips)));
    const std::complex<double> voltage = targets_.drawn_in_pulse(echo, pulse) * std::sqrt(echo.power_w) *
                                         gain * left * std::complex<double>(phase.cos, phase.sin);
    add_to_gates(pulse, seen.range_m - closing_m_s * coupling_s_, voltage);
  }

 private:
  void add_to_gates(int pulse, double range_m, std::complex<double> voltage) const {
    const BinGrid& bins = plan_.bins();
    const bool sharp = s_.pulse.kind == PulseKind::off;
    const int reach = response_.reach_bins(bins.range_spacing_m, s_.pulse.extent_bins);
    const auto own = static_cast<int>(std::floor((range_m - bins.r_min_m) / bins.range_spacing_m));
    std::complex<float>* const gates =
        train_.iq.data() + static_cast<std::size_t>(pulse) * static_cast<std::size_t>(train_.n_range);
    ask(std::int64_t{kTargetGateWork} * (2 * reach + 1));
    for (int m = std::max(0, own - reach); m <= std::min(bins.n_range - 1, own + reach); ++m) {
      const double middle_m = bins.r_min_m + (m + 0.5) * bins.range_spacing_m;
      gates[m] += std::complex<float>(voltage * (sharp ? 1 : response_.at(middle_m - range_m)));
    }
  }

  const FramePlan& plan_;
  const RadarSettings& s_;
  const TargetEchoes& targets_;
  const PulseTimes& times_;
  const Boresight& boresight_;
  const double shift_m_;
  PulseTrain& train_;
  const AzimuthPattern pattern_;
  const BeamOnGround beam_;
  const PointResponse response_;
  const double wavelength_m_;
  const glm::dvec3 antenna_m_s_;
  double coupling_s_ = 0;  ///< metres nearer for 1 m/s
};

}  // namespace

void add_target_pulses(const FramePlan& plan, const TargetEchoes& targets, const PulseTimes& times,
                       const Boresight& boresight, const PulseTrip& trip, PulseTrain& train) {
  const TargetPulses pulses(plan, targets, times, boresight, trip, train);
  const std::vector<int> of_trip = times.pulses_like(trip.pulses);
  for (const TargetEcho& echo : targets.echoes())
    for (const int pulse : of_trip) pulses.add(echo, pulse);
}

}  // namespace obliq
