#include "server/control/doppler_faults.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "server/control/parameters.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/doppler/doppler_response.h"
#include "server/radar/doppler/ground_doppler.h"
#include "server/radar/doppler/sea_motion.h"
#include "server/radar/sea_state.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kWidestImage_deg = 10;
/// Sharp azimuths of an image, with what its response reaches on either side.
constexpr double kMostRows = 16384;

/// What a key may be at most, and at least.
const Limits& limits_of(std::string_view key) { return find_parameter(key)->key.limits; }

std::string mode_name(const RadarSettings& s) {
  switch (s.mode) {
    case RadarMode::mti:
      return "\"mti\"";
    case RadarMode::dbs:
      return "\"dbs\"";
    case RadarMode::pulses:
      return "\"pulses\"";
    default:
      return "\"sar\"";
  }
}

void check_image(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.scan_mode != ScanMode::frame)
    errors.push_back({"scan.mode", "a scan with radar.mode = \"sar\"",
                      "\"frame\": an image of synthetic aperture is made of all of its sector at once"});
  if (s.sector_deg > kWidestImage_deg)
    errors.push_back({"radar.sector_deg", toml_number(s.sector_deg) + " with radar.mode = \"sar\"",
                      "at most " + toml_number(kWidestImage_deg) + " deg"});
  if (!(s.r_min_m > 0))
    errors.push_back({"radar.r_min_m", "0 with radar.mode = \"sar\"", "the near edge of a patch, above 0"});
  if (!errors.empty()) return;
  const std::string bins = std::to_string(s.azimuth_bins);
  const int parts = azimuth_sub_bins(s);
  const double row_rad = s.azimuth_bin_rad() / parts;
  const double sea_rad = sea_state(s) > 0 ? kMostSeaSmear.reach_rad() : 0;
  const double cells_rad = DopplerResponse::kSarCells * s.doppler.resolution_m / s.r_min_m;
  const double halo = std::ceil((cells_rad + sea_rad) / row_rad);
  if (const double rows = static_cast<double>(s.azimuth_bins) * parts + 2 * halo; rows > kMostRows) {
    const double room = (kMostRows - static_cast<double>(s.azimuth_bins) * parts) / 2;
    const double most_m = (room * row_rad - sea_rad) * s.r_min_m / DopplerResponse::kSarCells;
    errors.push_back({"doppler.resolution_m",
                      toml_number(s.doppler.resolution_m) +
                          " in radar.sector_deg = " + toml_number(s.sector_deg) +
                          " with bins.azimuth = " + bins + ": more rows than " + toml_number(kMostRows),
                      most_m >= limits_of("doppler.resolution_m").low
                          ? "at most " + toml_number(std::floor(1000 * most_m) / 1000) +
                                " m, or fewer bins.azimuth, or a wider sector"
                          : std::string("fewer bins.azimuth, or a wider sector")});
    return;
  }
  if (parts <= kMostSubBins) return;
  const double share = static_cast<double>(parts) / kMostSubBins;
  const double least_m = std::ceil(1000 * s.doppler.resolution_m * share) / 1000;
  const double most_bins = std::ceil(s.azimuth_bins * share);
  std::string allowed;
  if (least_m <= limits_of("doppler.resolution_m").high)
    allowed = "at least " + toml_number(least_m) + " m, or ";
  errors.push_back({"doppler.resolution_m",
                    toml_number(s.doppler.resolution_m) + " with bins.azimuth = " + bins +
                        " and radar.r_max_m = " + toml_number(s.r_max_m),
                    allowed + (most_bins <= limits_of("bins.azimuth").high
                                   ? "bins.azimuth = " + std::to_string(static_cast<int>(most_bins))
                                   : std::string("a narrower sector"))});
}

void check_train(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (s.speckle == SpeckleKind::none)
    errors.push_back({"radar.speckle", "\"none\" with radar.mode = \"pulses\"",
                      "\"ground\", \"independent\" or \"auto\": pulses are sums of scatterers that turn"});
  const double unambiguous_m = unambiguous_range_m(s, s.pulse.prf_hz);
  if (s.r_max_m <= unambiguous_m) return;
  const auto& ratios = s.pulse.stagger;
  std::string allowed = "radar.r_max_m = " + toml_number(std::floor(unambiguous_m));
  const double most_hz = std::floor(1000 * unambiguous_range_m(s, 1) / s.r_max_m) / 1000;
  if (most_hz >= limits_of("pulse.prf_hz").low)
    allowed = "at most " + toml_number(most_hz) + " Hz, or " + allowed;
  errors.push_back(
      {"pulse.prf_hz",
       toml_number(s.pulse.prf_hz) + " with radar.r_max_m = " + toml_number(s.r_max_m) +
           (ratios.empty() ? ""
                           : " and a pulse.stagger of " + toml_number(*std::ranges::min_element(ratios))) +
           ": the next pulse is sent before the last gate",
       allowed});
}

}  // namespace

void check_doppler(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (!errors.empty() || !uses_doppler(s)) return;
  if (s.mode == RadarMode::sar) return check_image(s, errors);
  if (s.mode == RadarMode::pulses) check_train(s, errors);
  // Without a beam a canceller still works, bin by bin, while the antenna stands.
  const bool works_by_bin = s.mode == RadarMode::mti && s.scan_mode == ScanMode::frame;
  if (s.beam.pattern == BeamPattern::off && !works_by_bin)
    errors.push_back({"radar.mode", mode_name(s) + " with beam.pattern = \"off\"",
                      "\"map\", or a beam: what Doppler tells apart lies in it"});
}

}  // namespace obliq
