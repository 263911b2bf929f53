#include "server/radar/beam/echo_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "terrain/base/asking.h"
#include "terrain/base/text.h"
#include "terrain/base/wavelength.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
/// In units of ask(): sines, exponentials, and what is made of them.
constexpr int kFunction = 40;
constexpr int kTaps = 1024;

/// The azimuth off the boresight at which the antenna's own angle u = cos(e) sin(azimuth) stands on the
/// horizon.
double on_horizon(double azimuth_rad, double cos_elevation) {
  const double u = std::asin(std::clamp(cos_elevation * std::sin(azimuth_rad), -1.0, 1.0));
  return std::cos(azimuth_rad) >= 0 ? u : std::copysign(kPi, azimuth_rad) - u;
}

/// The beam while the antenna turns by `turn_rad`: Simpson's rule over the bearings of the boresight.
double gain_of_turning(const AzimuthPattern& pattern, double azimuth_rad, double cos_elevation,
                       double turn_rad) {
  const auto gain = [&](double from) {
    return pattern.power_gain(on_horizon(azimuth_rad + from * turn_rad, cos_elevation));
  };
  return turn_rad > 0 ? (gain(-0.5) + 4 * gain(0) + gain(0.5)) / 6 : gain(0);
}

struct Planner {
  const RadarSettings& s;
  const EchoPlace& place;
  EchoPlan plan;
  AzimuthPattern pattern;
  PointResponse response;
  EchoLayout layout;
  double width_rad;      // of a sharp azimuth bin
  double sharp_range_m;  // of a sharp range bin

  Planner(const RadarSettings& settings, const EchoPlace& at)
      : s(settings),
        place(at),
        pattern(settings),
        response(settings),
        layout(lay_out_echo(settings, pattern, at)),
        width_rad(layout.azimuth_rad),
        sharp_range_m(layout.range_m) {
    plan.sharp = sharp_frame(s, layout);
    plan.n_azimuth = s.azimuth_bins;
    plan.n_range = s.range_bins;
    plan.azimuth_parts = layout.azimuth_parts;
    plan.range_parts = layout.range_parts;
    plan.first_azimuth = layout.first_azimuth;
    plan.wraps = layout.wraps;
    // The middle of the sector is that of the circle, or half a sharp bin beside it.
    const int beside = layout.sharp_azimuths - s.azimuth_bins * layout.azimuth_parts;
    plan.turn_bins = layout.wraps && beside % 2 != 0 ? 0.5 : 0;
    plan.first_range = layout.near;
    plan.first_tap = -layout.reach;
    plan.n_taps = layout.n_taps();
    plan.first_gate_tap = -layout.gate_reach;
    plan.speckle = resolved_speckle(s);
    plan.range_normalisation = s.range_normalisation && !has_receiver(s);
    plan.wavelength_m = wavelength_at(s.frequency_ghz);
    const double gain = std::pow(10, s.gain_db / 10);
    plan.power_scale = s.power_w * gain * gain;
  }

  void weigh_ranges() {
    const int reach = layout.gate_reach;
    // An output bin's middle lies (range_parts - 1) / 2 sharp bins beyond that of its first.
    std::vector<double> h;
    const double middle = (plan.range_parts - 1) / 2.0;
    for (int j = -reach; j <= reach + plan.range_parts - 1; ++j)
      h.push_back(s.pulse.kind == PulseKind::off ? (j == 0 ? 1 : 0)
                                                 : response.at((j - middle) * sharp_range_m));
    if (s.pulse.kind == PulseKind::rectangular) {
      double sum = 0;
      for (const double x : h) sum += x * x;
      for (double& x : h) x *= std::sqrt(response.equivalent_length_m() / sharp_range_m / sum);
    }
    for (const double x : h) {
      plan.gate_voltage.push_back(static_cast<float>(x));
      plan.gate_power.push_back(static_cast<float>(x * x));
    }
    const bool eclipses = s.pulse.kind != PulseKind::off && s.pulse.eclipse;
    if (!eclipses && s.beam.pattern == BeamPattern::off) return;
    for (int m = 0; m < plan.sharp.range_bins; ++m) {
      if (m % EchoPlan::kTile == 0) ask(kFunction * EchoPlan::kTile);
      const double range_m = plan.sharp.r_min_m + (m + 0.5) * sharp_range_m;
      const double eclipsed = eclipses ? std::min(1.0, range_m / response.half_pulse_m()) : 1;
      plan.amplitude.push_back(static_cast<float>(eclipsed * within_tile(m)));
    }
  }

  double tile_middle_m(int tile) const {
    return plan.sharp.r_min_m + (tile + 0.5) * EchoPlan::kTile * sharp_range_m;
  }

  /// A tile has one kernel, but the beam on the ground becomes narrower within it, as 1 / cos(e): so that
  /// level ground has no steps between tiles.
  double within_tile(int m) const {
    if (s.beam.pattern == BeamPattern::off) return 1;
    const double range_m = plan.sharp.r_min_m + (m + 0.5) * sharp_range_m;
    return std::sqrt(cos_elevation(place, tile_middle_m(m / EchoPlan::kTile)) /
                     cos_elevation(place, range_m));
  }

  void weigh_azimuths() {
    for (int tile = 0; tile * EchoPlan::kTile < plan.sharp.range_bins; ++tile)
      plan.tiles.push_back(weights(tile_middle_m(tile)));
  }

  AzimuthWeights weights(double range_m) const {
    AzimuthWeights w;
    const double middle = (plan.azimuth_parts - 1) / 2.0;
    for (int j = 0; j < plan.n_taps; ++j) {
      if (j % kTaps == 0) ask(kFunction * std::min(kTaps, plan.n_taps - j));
      const double offset_rad = (plan.first_tap + j - middle) * width_rad;
      const double gain =
          s.beam.pattern == BeamPattern::off
              ? (plan.first_tap + j == 0 ? 1 : 0)
              : gain_of_turning(pattern, offset_rad, cos_elevation(place, range_m), layout.turn_rad);
      if (gain == 0 && w.voltage.empty()) {
        ++w.first;
        continue;
      }
      w.voltage.push_back(static_cast<float>(gain));
      w.power.push_back(static_cast<float>(gain * gain));
    }
    while (w.voltage.size() > 1 && w.voltage.back() == 0) {
      w.voltage.pop_back();
      w.power.pop_back();
    }
    return w;
  }
};

}  // namespace

std::optional<EchoPlan> plan_echo(const RadarSettings& settings, const EchoPlace& place,
                                  std::vector<FieldError>& errors) {
  Planner planner(settings, place);
  if (const auto fault = layout_fault(settings, planner.layout)) {
    errors.push_back(*fault);
    return std::nullopt;
  }
  planner.weigh_ranges();
  planner.weigh_azimuths();
  return std::move(planner.plan);
}

double needed_range_m(const EchoPlan& plan, int sharp_wedge, AzimuthRange outputs) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  if (plan.wraps) return kEverywhere;
  const int first = sharp_wedge * kWedgeAzimuthBins;
  const int from = plan.first_row(outputs.first);
  const int to = plan.first_row(outputs.first + outputs.count - 1);
  std::size_t needed = plan.tiles.size();
  ask(static_cast<std::int64_t>(needed));
  for (; needed > 0; --needed) {
    const AzimuthWeights& tile = plan.tiles[needed - 1];
    if (first < to + tile.first + static_cast<int>(tile.voltage.size()) &&
        first + kWedgeAzimuthBins > from + tile.first)
      break;
  }
  if (needed == plan.tiles.size()) return kEverywhere;
  const double sharp_m = (plan.sharp.r_max_m - plan.sharp.r_min_m) / plan.sharp.range_bins;
  return plan.sharp.r_min_m + static_cast<double>(needed + 1) * EchoPlan::kTile * sharp_m;
}

}  // namespace obliq
