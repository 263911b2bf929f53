#include "server/control/parameters.h"

#include <algorithm>
#include <cmath>

#include "server/control/beam_limits.h"
#include "server/radar/render.h"

namespace obliq {

namespace {

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
  if (s.azimuth_bins >= 1 && s.sector_deg > 0 && s.sector_deg / s.azimuth_bins < kNarrowestBin_deg) {
    errors.push_back({"bins.azimuth",
                      std::to_string(s.azimuth_bins) + " in radar.sector_deg = " + toml_number(s.sector_deg),
                      "azimuth bins of at least " + toml_number(kNarrowestBin_deg) + " deg"});
  }
  if (s.frustum == FrustumKind::symmetric && s.sector_deg >= 180) {
    errors.push_back({"radar.sector_deg", toml_number(s.sector_deg) + " with frustum.kind = \"symmetric\"",
                      "below 180 deg, or frustum.kind = \"oblique\" or \"sweep\""});
  }
}

void check_scan(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.scan_dwell_bins % kWedgeAzimuthBins != 0) {
    errors.push_back({"scan.dwell_bins", std::to_string(s.scan_dwell_bins),
                      "a multiple of " + std::to_string(kWedgeAzimuthBins)});
  }
  if (s.scan_mode == ScanMode::frame) return;
  if (s.scan_mode == ScanMode::circular && s.sector_deg != 360) {
    errors.push_back({"radar.sector_deg", toml_number(s.sector_deg) + " with scan.mode = \"circular\"",
                      "360, or scan.mode = \"sector\""});
  }
  if (s.sector_deg / s.scan_rate_deg_s > kLongestPass_s) {
    errors.push_back(
        {"scan.rate_deg_s",
         toml_number(s.scan_rate_deg_s) + " with radar.sector_deg = " + toml_number(s.sector_deg),
         "a pass over the sector in at most " + toml_number(kLongestPass_s) + " s"});
  }
  if (s.sector_deg / s.scan_rate_deg_s < kShortestPass_s) {
    errors.push_back(
        {"scan.rate_deg_s",
         toml_number(s.scan_rate_deg_s) + " with radar.sector_deg = " + toml_number(s.sector_deg),
         "a pass over the sector in at least " + toml_number(kShortestPass_s) + " s: at most " +
             toml_number(s.sector_deg / kShortestPass_s) + " deg/s, or a sector of at least " +
             toml_number(s.scan_rate_deg_s * kShortestPass_s) + " deg"});
  }
}

void check_receiver(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.receiver.stc_range_m > s.r_max_m) {
    errors.push_back({"receiver.stc_range_m",
                      toml_number(s.receiver.stc_range_m) + " with radar.r_max_m = " + toml_number(s.r_max_m),
                      "at most r_max_m; 0: none"});
  }
  if (s.receiver.adc_bits == 1) errors.push_back({"receiver.adc_bits", "1", "0 (no converter) or 2 to 16"});
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
