#include "server/explain/beam_lines.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr double kBinsABeamwidth = 2;

std::string parts_text(int parts) {
  return parts == 1 ? "" : fmt::format(", each cut into {} sharp ones", parts);
}

std::string azimuth_line(const RadarSettings& s, const EchoPlan& plan) {
  const double bin_rad = s.sector_deg * std::numbers::pi / 180 / s.azimuth_bins;
  const double beam_rad = narrowest_beam_rad(s);
  const int would_do =
      static_cast<int>(std::ceil(kBinsABeamwidth * bin_rad / beam_rad * s.azimuth_bins * (1 - 1e-9)));
  return fmt::format(
      "Beam: {} degrees, {} azimuth bins a beamwidth{}; {} bins in the sector would do. At {} km it is "
      "{:.0f} m wide. "
      "Each frame renders {:.0f} % more azimuths for its edges.",
      short_number(beam_rad * 180 / std::numbers::pi, 3), short_number(beam_rad / bin_rad, 3),
      parts_text(plan.azimuth_parts), would_do, short_number(s.r_max_m / 1000, 4), beam_rad * s.r_max_m,
      100 * (static_cast<double>(plan.sharp.azimuth_bins) / (s.azimuth_bins * plan.azimuth_parts) - 1));
}

std::string elevation_line(const RadarSettings& s) {
  const std::string width = short_number(s.beam.elevation_width_deg, 3);
  switch (s.beam.elevation) {
    case ElevationPattern::cosecant:
      return fmt::format(
          "Elevation: a fan, {} degrees and a cosecant squared down to {}: level ground returns the "
          "same power from every range.",
          width, short_number(s.beam.cosecant_to_deg, 3));
    case ElevationPattern::file:
      return "Elevation: as in beam.file.";
    default:
      return fmt::format(
          "Elevation: a pencil of {} degrees: what lies a width off its middle is 24 dB down both ways.",
          width);
  }
}

std::string range_line(const RadarSettings& s, const EchoPlan& plan) {
  const double bin_m = (s.r_max_m - s.r_min_m) / s.range_bins;
  const PointResponse response(s);
  return fmt::format(
      "Pulse: resolution {} m, range bins of {} m{}; {} bins in the swath would do for ground, twice as many "
      "for single houses. Level ground returns {} "
      "of what a "
      "sharp range bin does.",
      short_number(response.resolution_m(), 4), short_number(bin_m, 4), parts_text(plan.range_parts),
      static_cast<int>(std::ceil((s.r_max_m - s.r_min_m) / response.resolution_m() * (1 - 1e-9))),
      short_number(response.equivalent_length_m() / bin_m, 3));
}

std::string speckle_line(SpeckleKind kind) {
  switch (kind) {
    case SpeckleKind::independent:
      return "Speckle: another draw in each azimuth bin and frame; no scatterers are sorted.";
    case SpeckleKind::none:
      return "Speckle: none; I&Q is the root of the mean power.";
    default:
      return {};
  }
}

}  // namespace

std::vector<std::string> beam_lines(const SceneFacts& facts) {
  const RadarSettings& s = facts.settings;
  std::vector<std::string> lines;
  if (s.beam.elevation != ElevationPattern::off) lines.push_back(elevation_line(s));
  if (!needs_echo_plan(s)) return lines;
  std::vector<FieldError> errors;
  const std::optional<EchoPlan> plan = plan_echo(s, {facts.height_m, 0}, errors);
  if (!plan) return lines;
  if (s.beam.pattern != BeamPattern::off) lines.insert(lines.begin(), azimuth_line(s, *plan));
  if (s.pulse.kind != PulseKind::off) lines.push_back(range_line(s, *plan));
  if (const std::string speckle = speckle_line(plan->speckle); !speckle.empty()) lines.push_back(speckle);
  return lines;
}

}  // namespace obliq
