#include "server/radar/beam/doppler_fault.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "server/radar/beam/sub_bins.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Below it an image of synthetic aperture would take for ever.
constexpr double kLeastAcross_m_s = 0.1;

int whole(double number) { return static_cast<int>(std::min(number, 1e9)); }

}  // namespace

std::optional<FieldError> image_fault(const RadarSettings& s, const EchoPlace& place) {
  if (s.mode == RadarMode::sar && place.velocity.across_m_s(0) < kLeastAcross_m_s)
    return FieldError{
        "radar.mode",
        fmt::format("\"sar\" of an antenna that flies across its line of sight at {:.2f} m/s",
                    place.velocity.across_m_s(0)),
        "poses with a velocity across the sector's middle (antenna.velocity_north_m_s, _east_), or "
        "another mode"};
  return std::nullopt;
}

std::optional<FieldError> image_fault(const RadarSettings& s, const PoseSettings& pose) {
  const double bearing_rad = pose.bearing_deg * kDegree_rad;
  const double north = pose.velocity_north_m_s.value_or(0);
  const double east = pose.velocity_east_m_s.value_or(0);
  EchoPlace place;
  place.velocity = {north * std::cos(bearing_rad) + east * std::sin(bearing_rad),
                    east * std::cos(bearing_rad) - north * std::sin(bearing_rad),
                    pose.velocity_up_m_s.value_or(0)};
  return image_fault(s, place);
}

std::optional<FieldError> too_few_rows(const RadarSettings& s, const EchoLayout& layout,
                                       const EchoPlace& place) {
  const std::string speed = fmt::format("{:.4g} m/s", place.velocity.level_m_s());
  if (!uses_doppler(s) || s.mode == RadarMode::sar || layout.wanted_parts <= kMostSubBins)
    return std::nullopt;
  // B + 3 rows a beamwidth, of which there may be so many; B goes with the time.
  const double across_m_s = place.velocity.most_across_m_s(s.sector_deg * kDegree_rad);
  const double beam_rad = narrowest_beam_rad(s);
  const bool has_train = s.mode == RadarMode::dbs || s.mode == RadarMode::pulses;
  const double wanted = rows_a_beamwidth(s, beam_rad, across_m_s);
  const double most = kMostSubBins * beam_rad / s.azimuth_bin_rad();
  const double cells = cells_in_beam(s, beam_rad, across_m_s);
  const double most_cells = cells - (wanted - most);
  std::vector<std::string> allowed;  // of what the keys' own limits take
  constexpr int kMostBins = 8192;
  constexpr double kMostPrf_hz = 1e6;
  if (const int bins = whole(std::ceil(s.azimuth_bins * wanted / most)); bins <= kMostBins)
    allowed.push_back("bins.azimuth = " + std::to_string(bins));
  if (most_cells > 0) {
    const int pulses = whole(s.doppler.pulses * most_cells / cells);
    if (has_train && pulses >= 2) allowed.push_back("at most " + std::to_string(pulses) + " pulses");
    const double prf_hz = std::ceil(s.pulse.prf_hz * cells / most_cells);
    // The next pulse of a train waits for the last gate (check_doppler).
    const bool waits = s.mode != RadarMode::pulses || s.r_max_m <= unambiguous_range_m(s, prf_hz);
    if (prf_hz <= kMostPrf_hz && waits) allowed.push_back(fmt::format("pulse.prf_hz = {:.6g}", prf_hz));
  }
  if (allowed.empty()) allowed.emplace_back("more azimuth bins and a higher pulse.prf_hz");
  const std::string what =
      has_train ? std::to_string(s.doppler.pulses) + " pulses" : std::string("a canceller");
  return FieldError{has_train ? "doppler.pulses" : "pulse.prf_hz",
                    what + fmt::format(" at {:.6g} Hz and ", s.pulse.prf_hz) + speed +
                        " with bins.azimuth = " + std::to_string(s.azimuth_bins),
                    fmt::format("{}", fmt::join(allowed, " or "))};
}

}  // namespace obliq
