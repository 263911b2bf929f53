#include "server/control/beam_limits.h"

#include <cmath>
#include <numbers>

#include "server/control/key.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
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

}  // namespace

void check_beam(const RadarSettings& s, std::vector<FieldError>& errors) {
  // What is outside its own limits has been reported already.
  if (!errors.empty()) return;
  check_file(s, errors);
  if (s.beam.pattern != BeamPattern::off && errors.empty()) check_width(s, errors);
  if (s.beam.pattern == BeamPattern::taylor) check_taylor("beam", s.beam.sidelobe_db, s.beam.nbar, errors);
  if (s.pulse.kind == PulseKind::compressed && s.pulse.window == PulseWindow::taylor)
    check_taylor("pulse", s.pulse.sidelobe_db, s.pulse.nbar, errors);
  if (s.pulse.kind != PulseKind::off) check_pulse(s, errors);
}

}  // namespace obliq
