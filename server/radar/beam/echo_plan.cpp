#include "server/radar/beam/echo_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "terrain/base/text.h"
#include "terrain/base/wavelength.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFarthest_m = 500e3;  // radar.r_max_m's limit
/// On the ground a beam is at most so many times as wide as on the horizon: what lies steeper than 60 degrees
/// below is seen by most of its azimuths anyway.
constexpr double kLeastCosine = 0.5;

int up_to_wedges(int bins) { return (bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins * kWedgeAzimuthBins; }

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
  double width_rad;      // of a sharp azimuth bin
  double range_bin_m;    // of an output range bin
  double sharp_range_m;  // of a sharp one

  Planner(const RadarSettings& settings, const EchoPlace& at)
      : s(settings), place(at), pattern(settings), response(settings) {
    plan.n_azimuth = s.azimuth_bins;
    plan.n_range = s.range_bins;
    plan.azimuth_parts = std::min(azimuth_sub_bins(s), kMostSubBins);
    plan.range_parts = std::min(range_sub_bins(s), kMostSubBins);
    plan.speckle = resolved_speckle(s);
    plan.range_normalisation = s.range_normalisation && !has_receiver(s);
    plan.wavelength_m = wavelength_at(s.frequency_ghz);
    const double gain = std::pow(10, s.gain_db / 10);
    plan.power_scale = s.power_w * gain * gain;
    width_rad = s.sector_deg * kPi / 180 / s.azimuth_bins / plan.azimuth_parts;
    range_bin_m = (s.r_max_m - s.r_min_m) / s.range_bins;
    sharp_range_m = range_bin_m / plan.range_parts;
    plan.sharp = s;
    plan.sharp.beam.pattern = BeamPattern::off;
    plan.sharp.pulse.kind = PulseKind::off;
    plan.sharp.speckle = plan.draws() ? SpeckleKind::ground : plan.speckle;
    plan.sharp.power_w = 1;
    plan.sharp.gain_db = 0;
    plan.sharp.range_normalisation = false;
    plan.sharp.receiver = {};
  }

  double cos_elevation(double range_m) const {
    const double sine = std::min(1.0, std::max(0.0, place.height_m) / range_m);
    return std::max(kLeastCosine, std::sqrt(1 - sine * sine));
  }

  void widen_swath() {
    const int extent = s.pulse.kind == PulseKind::off ? 0 : s.pulse.extent_bins;
    const double room_m = s.r_min_m - std::max(0.0, place.least_r_min_m);
    const int near = std::clamp(static_cast<int>(room_m / range_bin_m), 0, extent) * plan.range_parts;
    const int far =
        std::clamp(static_cast<int>((kFarthest_m - s.r_max_m) / range_bin_m), 0, extent) * plan.range_parts;
    plan.first_range = near;
    plan.sharp.range_bins = s.range_bins * plan.range_parts + near + far;
    plan.sharp.r_min_m = std::max(0.0, s.r_min_m - near * sharp_range_m);
    plan.sharp.r_max_m = s.r_max_m + far * sharp_range_m;
    // An output bin's middle lies (range_parts - 1) / 2 sharp bins beyond that of its first.
    const int reach = extent * plan.range_parts;
    plan.first_gate_tap = -reach;
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
    return std::sqrt(cos_elevation(tile_middle_m(m / EchoPlan::kTile)) / cos_elevation(range_m));
  }

  bool widen_sector(std::vector<FieldError>& errors) {
    const int own = s.azimuth_bins * plan.azimuth_parts;
    int reach = 0;  // sharp bins on either side that a beam may weigh
    if (s.beam.pattern != BeamPattern::off) {
      const double narrowest = cos_elevation(plan.sharp.r_min_m);
      const double extent_rad = std::min(kPi, pattern.extent_rad() / narrowest + turn_rad() / 2);
      reach = static_cast<int>(std::ceil(extent_rad / width_rad));
    }
    const double circle = 2 * kPi / width_rad;
    const int halo = up_to_wedges(reach);
    plan.wraps = reach > 0 && (s.sector_deg == 360 || own + 2 * halo >= circle * (1 - 1e-9));
    if (!plan.wraps) {
      plan.first_azimuth = halo;
      plan.sharp.azimuth_bins = own + 2 * halo;
      plan.sharp.sector_deg = halo == 0 ? s.sector_deg : s.sector_deg / own * plan.sharp.azimuth_bins;
    } else {
      const double whole = std::round(circle);
      if (std::abs(circle - whole) > 1e-6) {
        errors.push_back(
            {"bins.azimuth",
             std::to_string(s.azimuth_bins) + " in a sector that the beam widens to the full circle",
             "a number that divides the circle, so that the bins meet; or a narrower beam or sector"});
        return false;
      }
      const int all = static_cast<int>(whole);
      reach = std::min(reach, (all - plan.azimuth_parts) / 2);
      plan.sharp.azimuth_bins = all;
      plan.sharp.sector_deg = 360;
      plan.first_azimuth = (all - own) / 2;
      // The middle of the sector is that of the circle, or half a sharp bin beside it.
      plan.turn_bins = (all - own) % 2 == 0 ? 0 : 0.5;
    }
    plan.first_tap = -reach;
    plan.n_taps = 2 * reach + plan.azimuth_parts;
    for (int tile = 0; tile * EchoPlan::kTile < plan.sharp.range_bins; ++tile)
      plan.tiles.push_back(weights(tile_middle_m(tile)));
    return true;
  }

  /// How far the antenna turns while it looks along one output bin.
  double turn_rad() const { return s.scan_mode == ScanMode::frame ? 0 : width_rad * plan.azimuth_parts; }

  AzimuthWeights weights(double range_m) const {
    AzimuthWeights w;
    const double middle = (plan.azimuth_parts - 1) / 2.0;
    for (int j = 0; j < plan.n_taps; ++j) {
      const double offset_rad = (plan.first_tap + j - middle) * width_rad;
      const double gain = s.beam.pattern == BeamPattern::off
                              ? (plan.first_tap + j == 0 ? 1 : 0)
                              : gain_of_turning(pattern, offset_rad, cos_elevation(range_m), turn_rad());
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

  /// As many planes or pixels a bin as the settings ask for.
  void widen_pixels() {
    const double own = static_cast<double>(s.azimuth_bins) * plan.azimuth_parts;
    if (s.frustum == FrustumKind::sweep) {
      const int planes = (s.pixel_columns + s.azimuth_bins - 1) / s.azimuth_bins;
      const int a_part = (planes + plan.azimuth_parts - 1) / plan.azimuth_parts;
      plan.sharp.pixel_columns = a_part * plan.sharp.azimuth_bins;
      return;
    }
    const auto widened = [](int pixels, double ratio) {
      return static_cast<int>(std::ceil(pixels * ratio * (1 - 1e-12)));
    };
    plan.sharp.pixel_columns = widened(s.pixel_columns, plan.sharp.azimuth_bins / own);
    plan.sharp.pixel_rows =
        widened(s.pixel_rows, plan.sharp.range_bins / (static_cast<double>(s.range_bins) * plan.range_parts));
  }
};

}  // namespace

std::optional<EchoPlan> plan_echo(const RadarSettings& settings, const EchoPlace& place,
                                  std::vector<FieldError>& errors) {
  Planner planner(settings, place);
  planner.widen_swath();
  if (!planner.widen_sector(errors)) return std::nullopt;
  planner.widen_pixels();
  return std::move(planner.plan);
}

double needed_range_m(const EchoPlan& plan, int sharp_wedge, AzimuthRange outputs) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  if (plan.wraps) return kEverywhere;
  const int first = sharp_wedge * kWedgeAzimuthBins;
  const int from = plan.first_row(outputs.first);
  const int to = plan.first_row(outputs.first + outputs.count - 1);
  std::size_t needed = plan.tiles.size();
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
