#include "server/control/doppler_faults.h"

#include <cmath>
#include <string>

#include "server/control/key.h"
#include "server/radar/beam/sub_bins.h"

namespace obliq {
namespace {

constexpr double kWidestImage_deg = 10;

std::string mode_name(const RadarSettings& s) {
  switch (s.mode) {
    case RadarMode::mti:
      return "\"mti\"";
    case RadarMode::dbs:
      return "\"dbs\"";
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
  const int parts = azimuth_sub_bins(s);
  if (parts <= kMostSubBins) return;
  const double share = static_cast<double>(parts) / kMostSubBins;
  errors.push_back(
      {"doppler.resolution_m",
       toml_number(s.doppler.resolution_m) + " with bins.azimuth = " + std::to_string(s.azimuth_bins) +
           " and radar.r_max_m = " + toml_number(s.r_max_m),
       "at least " + toml_number(std::ceil(1000 * s.doppler.resolution_m * share) / 1000) +
           " m, or bins.azimuth = " + std::to_string(static_cast<int>(std::ceil(s.azimuth_bins * share)))});
}

}  // namespace

void check_doppler(const RadarSettings& s, std::vector<FieldError>& errors) {
  if (!errors.empty() || !uses_doppler(s)) return;
  if (s.mode == RadarMode::sar) return check_image(s, errors);
  // Without a beam a canceller still works, bin by bin, while the antenna stands.
  const bool works_by_bin = s.mode == RadarMode::mti && s.scan_mode == ScanMode::frame;
  if (s.beam.pattern == BeamPattern::off && !works_by_bin)
    errors.push_back({"radar.mode", mode_name(s) + " with beam.pattern = \"off\"",
                      "\"map\", or a beam: what Doppler tells apart lies in it"});
}

}  // namespace obliq
