#include "server/control/parameters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/control/doppler_faults.h"
#include "server/control/key.h"
#include "server/control/planes_per_bin.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/render.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

std::string with_bins(const char* key, int bins) {
  return std::string(" with ") + key + " = " + std::to_string(bins);
}

void check_file(const RadarSettings& s, std::vector<FieldError>& errors) {
  const PatternCuts* cuts = s.beam.file.get();
  if (s.beam.pattern == BeamPattern::file && (cuts == nullptr || cuts->azimuth.angle_rad.empty()))
    errors.push_back({"beam.pattern", "\"file\" without a cut azimuth",
                      "a beam.file in the scene file that has one, or another pattern"});
  if (s.beam.elevation == ElevationPattern::file && (cuts == nullptr || cuts->elevation.angle_rad.empty()))
    errors.push_back({"beam.elevation", "\"file\" without a cut elevation",
                      "a beam.file in the scene file that has one, or another pattern"});
}

void check_width(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.beam.pattern != BeamPattern::file && s.beam.width_deg > s.sector_deg / 2)
    errors.push_back({"beam.width_deg",
                      toml_number(s.beam.width_deg) + " with radar.sector_deg = " + toml_number(s.sector_deg),
                      "at most half the sector"});
  const bool of_file = s.beam.pattern == BeamPattern::file;
  if (const int parts = azimuth_sub_bins(s); parts > kMostSubBins)
    errors.push_back(
        {of_file ? "beam.file" : "beam.width_deg",
         (of_file ? "a beam of " + toml_number(std::round(1e5 * narrowest_beam_rad(s) / kDegree_rad) / 1e5) +
                        " degrees"
                  : toml_number(s.beam.width_deg)) +
             with_bins("bins.azimuth", s.azimuth_bins),
         "a beam of at least " + toml_number(2.0 / kMostSubBins) + " azimuth bins; bins.azimuth = " +
             std::to_string(
                 static_cast<int>(std::ceil(s.azimuth_bins * static_cast<double>(parts) / kMostSubBins))) +
             " would do"});
}

/// nbar >= 2 A^2 + 1/2 with cosh(pi A) the sidelobes' voltage ratio: with fewer the lobes stay above the
/// level that is asked for (Taylor 1955).
void check_taylor(const std::string& section, double sidelobe_db, int nbar, std::vector<FieldError>& errors) {
  const double a = std::acosh(std::pow(10, sidelobe_db / 20)) / std::numbers::pi;
  const int least = static_cast<int>(std::ceil(2 * a * a + 0.5 - 0.02));
  if (nbar >= least) return;
  errors.push_back({section + ".nbar",
                    std::to_string(nbar) + " with " + section + ".sidelobe_db = " + toml_number(sidelobe_db),
                    "at least " + std::to_string(least) + " for sidelobes that low"});
}

void check_pulse(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.pulse.extent_bins > s.range_bins)
    errors.push_back({"pulse.extent_bins",
                      std::to_string(s.pulse.extent_bins) + with_bins("bins.range", s.range_bins),
                      "at most as many as bins.range"});
  const double bin_m = s.range_bin_m();
  const bool rectangular = s.pulse.kind == PulseKind::rectangular;
  const PointResponse response(s);
  if (!rectangular && s.pulse.bandwidth_mhz > 0 && s.pulse.bandwidth_mhz * s.pulse.length_us < 1)
    errors.push_back(
        {"pulse.bandwidth_mhz",
         toml_number(s.pulse.bandwidth_mhz) + " with pulse.length_us = " + toml_number(s.pulse.length_us),
         "at least 1 / pulse.length_us: a compressed pulse is no shorter than it was sent"});
  if (rectangular && response.resolution_m() > s.r_max_m - s.r_min_m) {
    errors.push_back({"pulse.length_us", toml_number(s.pulse.length_us),
                      "at most " +
                          toml_number(std::floor(100 * s.pulse.length_us * (s.r_max_m - s.r_min_m) /
                                                 response.resolution_m()) /
                                      100) +
                          ", as long as the swath"});
    return;
  }
  if (range_sub_bins(s) > kMostSubBins)
    errors.push_back(
        {rectangular ? "pulse.length_us" : "pulse.bandwidth_mhz",
         toml_number(rectangular ? s.pulse.length_us : s.pulse.bandwidth_mhz) +
             with_bins("bins.range", s.range_bins),
         "a resolution of at least 1/" + std::to_string(kMostSubBins) + " of a range bin; bins.range = " +
             std::to_string(static_cast<int>(
                 std::ceil((s.r_max_m - s.r_min_m) / PointResponse(s).resolution_m() / kMostSubBins))) +
             " would do"});
  if (rectangular && PointResponse(s).resolution_m() > bin_m * s.pulse.extent_bins)
    errors.push_back(
        {"pulse.extent_bins",
         std::to_string(s.pulse.extent_bins) + " with pulse.length_us = " + toml_number(s.pulse.length_us),
         "at least " + std::to_string(static_cast<int>(std::ceil(PointResponse(s).resolution_m() / bin_m))) +
             ", so that the pulse fits, or a shorter pulse"});
}

/// A range bin shorter than this is a mistake in units: the shortest wavelength allowed is 1 mm.
constexpr double kShortestBin_m = 0.001;

/// An azimuth bin narrower than this, 0.7 mm at 40 km, is a mistake as well.
constexpr double kNarrowestBin_deg = 1e-6;

/// A pass keeps the scene that it began in, and a client waits this long for its first: one turn a minute.
constexpr double kLongestPass_s = 60;

/// Nothing but the machine's speed would pace shorter passes: rate_hz has no say in a scan.
constexpr double kShortestPass_s = 0.01;

void check_limits(RadarConfig config, WireMessage message, std::vector<FieldError>& errors) {
  for (const Parameter& parameter : parameters()) {
    if (parameter.message != message) continue;
    if (auto error = check(parameter.key, parameter.slot(config))) errors.push_back(std::move(*error));
  }
}

/// How the fields fit each other. Fields outside their limits are reported already: a comparison
/// with NaN is false and adds nothing.
void check_together(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.r_min_m >= s.r_max_m) {
    errors.push_back({"radar.r_min_m",
                      toml_number(s.r_min_m) + " with radar.r_max_m = " + toml_number(s.r_max_m),
                      "r_min_m less than r_max_m"});
  } else if (s.range_bins >= 1 && s.range_bin_m() < kShortestBin_m) {
    errors.push_back({"bins.range",
                      std::to_string(s.range_bins) + " between radar.r_min_m = " + toml_number(s.r_min_m) +
                          " and radar.r_max_m = " + toml_number(s.r_max_m),
                      "range bins of at least " + toml_number(kShortestBin_m) + " m"});
  }
  if (s.azimuth_bins >= 1 && s.sector_deg > 0 && s.sector_deg / s.azimuth_bins < kNarrowestBin_deg)
    errors.push_back({"bins.azimuth",
                      std::to_string(s.azimuth_bins) + " in radar.sector_deg = " + toml_number(s.sector_deg),
                      "azimuth bins of at least " + toml_number(kNarrowestBin_deg) + " deg"});
  if (auto fault = planes_fault(s)) errors.push_back(std::move(*fault));
  if (s.frustum == FrustumKind::symmetric && s.sector_deg >= 180)
    errors.push_back({"radar.sector_deg", toml_number(s.sector_deg) + " with frustum.kind = \"symmetric\"",
                      "below 180 deg, or frustum.kind = \"oblique\" or \"sweep\""});
}

void check_scan(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.scan_dwell_bins % kWedgeAzimuthBins != 0)
    errors.push_back({"scan.dwell_bins", std::to_string(s.scan_dwell_bins),
                      "a multiple of " + std::to_string(kWedgeAzimuthBins)});
  if (s.scan_mode == ScanMode::frame) return;
  if (s.scan_mode == ScanMode::circular && s.sector_deg != 360)
    errors.push_back({"radar.sector_deg", toml_number(s.sector_deg) + " with scan.mode = \"circular\"",
                      "360, or scan.mode = \"sector\""});
  if (s.sector_deg / s.scan_rate_deg_s > kLongestPass_s)
    errors.push_back(
        {"scan.rate_deg_s",
         toml_number(s.scan_rate_deg_s) + " with radar.sector_deg = " + toml_number(s.sector_deg),
         "a pass over the sector in at most " + toml_number(kLongestPass_s) + " s"});
  if (s.sector_deg / s.scan_rate_deg_s < kShortestPass_s)
    errors.push_back(
        {"scan.rate_deg_s",
         toml_number(s.scan_rate_deg_s) + " with radar.sector_deg = " + toml_number(s.sector_deg),
         "a pass over the sector in at least " + toml_number(kShortestPass_s) + " s: at most " +
             toml_number(s.sector_deg / kShortestPass_s) + " deg/s, or a sector of at least " +
             toml_number(s.scan_rate_deg_s * kShortestPass_s) + " deg"});
}

void check_receiver(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.receiver.adc_bits == 1) errors.push_back({"receiver.adc_bits", "1", "0 (no converter) or 2 to 16"});
}

/// How the beam and the pulse fit each other, the sector and the bins.
void check_beam(const RadarSettings& s, std::vector<FieldError>& errors) {
  // What is outside its own limits has been reported already.
  if (!errors.empty()) return;
  check_file(s, errors);
  if (s.beam.pattern != BeamPattern::off && s.mode != RadarMode::sar && errors.empty())
    check_width(s, errors);
  if (!s.beam.stabilised && s.beam.pattern == BeamPattern::off)
    errors.push_back(
        {"beam.stabilised", "false with beam.pattern = \"off\"",
         "true, or a beam: bins as sharp as their edges belong to a map, which no platform tilts"});
  if (s.beam.pattern == BeamPattern::taylor) check_taylor("beam", s.beam.sidelobe_db, s.beam.nbar, errors);
  if (s.pulse.kind == PulseKind::compressed && s.pulse.window == PulseWindow::taylor)
    check_taylor("pulse", s.pulse.sidelobe_db, s.pulse.nbar, errors);
  if (s.pulse.kind != PulseKind::off) check_pulse(s, errors);
}

}  // namespace

const Parameter* find_parameter(std::string_view name) {
  const auto found =
      std::ranges::find_if(parameters(), [&](const Parameter& p) { return p.key.name == name; });
  return found == parameters().end() ? nullptr : &*found;
}

std::string Parameter::message_field() const {
  return (message == WireMessage::pose ? "Pose." : "RadarSettings.") + std::string(wire_field);
}

Value value_of(const Parameter& parameter, RadarConfig config) {
  return load(parameter.key, parameter.slot(config));
}

std::vector<FieldError> validate(const RadarSettings& settings) {
  std::vector<FieldError> errors;
  check_limits({"", settings, {}}, WireMessage::radar_settings, errors);
  check_together(settings, errors);
  for (FieldError& error : sampling_faults(settings)) errors.push_back(std::move(error));
  check_scan(settings, errors);
  check_beam(settings, errors);
  check_receiver(settings, errors);
  check_doppler(settings, errors);
  return errors;
}

std::vector<FieldError> validate(const PoseSettings& pose) {
  std::vector<FieldError> errors;
  check_limits({"", {}, pose}, WireMessage::pose, errors);
  return errors;
}

std::vector<FieldError> validate(const RadarConfig& config) {
  std::vector<FieldError> errors = validate(config.settings);
  for (FieldError& error : validate(config.pose)) errors.push_back(std::move(error));
  return errors;
}

}  // namespace obliq
