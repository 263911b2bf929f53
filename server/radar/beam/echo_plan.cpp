#include "server/radar/beam/echo_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "server/radar/beam/doppler_fault.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/doppler/canceller.h"
#include "terrain/base/asking.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// In units of ask(): sines, exponentials, and what is made of them.
constexpr int kFunction = 40;
constexpr int kTaps = 1024;
/// Ground so nearly below the antenna is in one step of its table of elevations.
constexpr double kLeastCosine = 0.005;

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
    plan.n_rows = layout.sharp_azimuths;
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
    plan.output_rad = s.azimuth_bin_rad();
    plan.start_rad = -s.azimuth_bins * plan.output_rad / 2;
    if (layout.ground.azimuths > 0) plan_ground();
    if (uses_doppler(s)) plan_doppler();
  }

  void plan_doppler() {
    const SharpRanges ranges{plan.sharp.r_min_m, sharp_range_m, layout.n_tiles() * EchoPlan::kTile};
    const bool turns = s.scan_mode != ScanMode::frame;
    const double turn_rad = turns ? s.scan_rate_deg_s * kDegree_rad / s.pulse.prf_hz : 0;
    plan.doppler = std::make_shared<const DopplerPlan>(
        s, place.velocity, ranges, turn_rad, place.above_ground_m, place.windy, place.sea, place.all_windy);
  }

  void plan_ground() {
    GroundAzimuths& ground = plan.ground.emplace();
    ground.axes = place.axes;
    ground.frame = ground_frame(s, layout);
    ground.azimuth_rad = width_rad;
    ground.above_ground_m = place.above_ground_m;
    const int n = layout.ground.azimuths;
    ground.start_rad = -n * width_rad / 2;
    const double left = -s.azimuth_bins * plan.azimuth_parts / 2.0 - plan.first_azimuth;
    ground.scan_start_rad = left * width_rad;
    ground.rows = {layout.sharp_azimuths,
                   n,
                   1,
                   static_cast<int>(std::floor(left + n / 2.0)),
                   -layout.ground.reach,
                   2 * layout.ground.reach + 1,
                   layout.ground.wraps};
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
    if (s.pulse.kind == PulseKind::off || !s.pulse.eclipse) return;
    for (int m = 0; m < plan.sharp.range_bins; ++m) {
      if (m % EchoPlan::kTile == 0) ask(kFunction * EchoPlan::kTile);
      const double range_m = plan.sharp.r_min_m + (m + 0.5) * sharp_range_m;
      plan.amplitude.push_back(static_cast<float>(response.left_by_eclipse(range_m)));
    }
  }

  void weigh_azimuths() {
    AzimuthKernels& kernels = plan.kernels;
    kernels.length = layout.kernel_length();
    kernels.pad = layout.kernel_pad();
    const auto all = static_cast<std::size_t>(layout.n_kernels) * static_cast<std::size_t>(kernels.length);
    fill(kernels.voltage, all, 0.0F);
    fill(kernels.power, all, 0.0F);
    if (plan.doppler && plan.doppler->turn_rad() != 0 && !plan.doppler->is_of_beam())
      fill(kernels.cancelled, 4 * all, 0.0F);
    for (int tile = 0; tile < layout.n_tiles(); ++tile) {
      const double from_m = plan.sharp.r_min_m + tile * EchoPlan::kTile * sharp_range_m;
      plan.steepest.push_back(
          static_cast<std::uint8_t>(std::min(layout.n_kernels - 1, steepest_step(place, from_m))));
    }
    if (!has_beam(s)) {
      // The output bin's own sharp one; of a synthetic aperture all that its response reaches.
      kernels.unused.push_back(0);
      const int n = s.mode == RadarMode::sar ? plan.n_taps : 1;
      std::fill_n(kernels.voltage.begin() + kernels.pad, n, 1.0F);
      std::fill_n(kernels.power.begin() + kernels.pad, n, 1.0F);
      return;
    }
    const BeamOnGround beam(pattern, layout.turn_rad, layout.azimuth_rad);
    plan.widths = std::make_shared<const BeamWidths>(
        beam, std::max(kLeastCosine, least_cosine(place, plan.sharp.r_min_m)));
    for (int k = 0; k < layout.n_kernels; ++k) add_kernel(beam, k);
  }

  /// A tap behind the canceller of an antenna that turns; gain: of it so many pulses before.
  template <typename Gain>
  std::array<double, 4> cancelled_tap(const Gain& gain) const {
    const int delays = plan.doppler->delays();
    ask(kFunction * (delays + 1));
    std::vector<double> gains;
    for (int k = 0; k <= delays; ++k) gains.push_back(gain(k));
    const auto [even, odd] = canceller_terms(gains);
    std::array<double, 4> terms{even[0], even[1], odd[0], odd[1]};
    for (double& term : terms) term *= plan.doppler->over_noise_root();
    return terms;
  }

  void add_kernel(const BeamOnGround& beam, int step) {
    const double cosine = cosine_steps::cosine(step);
    const double middle = plan.first_tap + (plan.n_taps - 1) / 2.0;
    const double farthest = beam.extent_rad(cosine) / width_rad;
    const int unused =
        std::clamp(static_cast<int>((plan.n_taps - 1) / 2.0 - farthest), 0, (plan.n_taps - 1) / 2);
    std::vector<double> gains;
    double squares = 0;
    for (int j = unused; j < plan.n_taps - unused; ++j) {
      if ((j - unused) % kTaps == 0) ask(kFunction * std::min(kTaps, plan.n_taps - j));
      gains.push_back(beam.gain((plan.first_tap + j - middle) * width_rad, cosine));
      squares += gains.back() * gains.back();
    }
    plan.kernels.unused.push_back(unused);
    if (!(squares > 0)) return;
    const double scale = 1 / std::sqrt(squares * width_rad);
    const bool turns = plan.doppler && plan.doppler->turn_rad() != 0;
    auto at = static_cast<std::size_t>(step) * static_cast<std::size_t>(plan.kernels.length) +
              static_cast<std::size_t>(plan.kernels.pad + unused);
    for (int j = unused; j < plan.n_taps - unused; ++j, ++at) {
      double weight = gains[static_cast<std::size_t>(j - unused)];
      if (turns) {
        const auto terms = cancelled_tap([&](int pulses_before) {
          const double turned_rad = pulses_before * plan.doppler->turn_rad();
          return beam.gain((plan.first_tap + j - middle) * width_rad + turned_rad, cosine);
        });
        if (plan.doppler->is_of_beam()) weight = terms.front();
        for (std::size_t p = 0; !plan.kernels.cancelled.empty() && p < terms.size(); ++p)
          plan.kernels.cancelled[4 * at + p] = static_cast<float>(terms[p] * scale);
      }
      plan.kernels.voltage[at] = static_cast<float>(weight * scale);
      plan.kernels.power[at] = static_cast<float>(weight * scale * (weight * scale));
    }
  }
};

}  // namespace

std::optional<EchoPlan> plan_echo(const RadarSettings& settings, const EchoPlace& place,
                                  std::vector<FieldError>& errors) {
  Planner planner(settings, place);
  if (const auto fault = layout_fault(settings, planner.layout, place)) {
    errors.push_back(*fault);
    return std::nullopt;
  }
  if (const auto few = too_few_rows(settings, planner.layout, place))
    planner.plan.doppler_warning = few->text();
  planner.weigh_ranges();
  planner.weigh_azimuths();
  return std::move(planner.plan);
}

double needed_range_m(const EchoPlan& plan, int sharp_wedge, AzimuthRange outputs) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  if (plan.ground) return kEverywhere;
  const int first = sharp_wedge * kWedgeAzimuthBins;
  const int from = plan.first_row(outputs.first);
  const int to = plan.first_row(outputs.first + outputs.count - 1) + plan.n_taps;
  const auto weighs = [&](int unused) {
    for (int turn = plan.wraps ? -1 : 0; turn <= (plan.wraps ? 1 : 0); ++turn) {
      const int row = first + turn * plan.sharp.azimuth_bins;
      if (row < to - unused && row + kWedgeAzimuthBins > from + unused) return true;
    }
    return false;
  };
  std::size_t needed = plan.steepest.size();
  ask(static_cast<std::int64_t>(needed));
  while (needed > 0 && !weighs(plan.kernels.unused[plan.steepest[needed - 1]])) --needed;
  if (needed == plan.steepest.size()) return kEverywhere;
  const double sharp_m = plan.sharp.range_bin_m();
  return plan.sharp.r_min_m + static_cast<double>(needed + 1) * EchoPlan::kTile * sharp_m;
}

}  // namespace obliq
