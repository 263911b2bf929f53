// What was looked at, and how it was measured: the sentences above the tables.
#include <fmt/format.h>

#include <cmath>

#include "server/explain/explanation.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "terrain/base/units.h"

namespace obliq {

std::vector<ReportRow> scene_rows(const Explanation& all) {
  constexpr double kBinsABeamwidth = 2;
  constexpr double kRounding = 1e-9;
  const SceneFacts& f = all.facts;
  const RadarSettings& s = f.settings;
  std::vector<FieldError> errors;
  const auto plan = needs_echo_plan(s) ? plan_echo(s, {f.height_m, 0}, errors) : std::nullopt;
  const EchoPlan sum = plan.value_or(EchoPlan{});
  const bool beam = plan && s.beam.pattern != BeamPattern::off;
  const bool pulse = plan && s.pulse.kind != PulseKind::off;
  const ElevationPattern elevation = s.beam.elevation;
  const double bin_rad = s.sector_deg * kDegree_rad / s.azimuth_bins;
  const double beam_rad = beam ? narrowest_beam_rad(s) : bin_rad;
  const double swath_m = s.r_max_m - s.r_min_m, bin_m = swath_m / s.range_bins;
  const PointResponse response(s);
  const Values measured = values(
      "scene"_is = f.scene, "radar"_is = f.radar, "frustum"_is = frustum_name(s.frustum),
      "columns"_is = s.pixel_columns, "rows"_is = s.pixel_rows, "sector_deg"_is = s.sector_deg,
      "r_min_km"_is = s.r_min_m / 1000, "r_max_km"_is = s.r_max_m / 1000, "azimuth"_is = s.azimuth_bins,
      "range"_is = s.range_bins, "height_m"_is = f.height_m, "k"_is = f.radius_factor, "cell_m"_is = f.cell_m,
      "buildings"_is = f.buildings, "plates"_is = fmt::format("{}", fmt::join(f.flat_plates, ", ")),
      "measured"_is = f.measured_azimuth_bins, "planes"_is = f.columns, "rays"_is = kComparisonDensity.rows,
      "points"_is = f.ground_points, "beam_deg"_is = beam_rad / kDegree_rad,
      "beam_bins"_is = beam_rad / bin_rad, "beam_m"_is = beam_rad * s.r_max_m,
      "azimuth_parts"_is = sum.azimuth_parts,
      "azimuths_do"_is = std::ceil(kBinsABeamwidth * bin_rad / beam_rad * s.azimuth_bins * (1 - kRounding)),
      "more"_is = 100 * (1.0 * sum.sharp.azimuth_bins / (s.azimuth_bins * sum.azimuth_parts) - 1),
      "elevation_deg"_is = s.beam.elevation_width_deg, "cosecant_deg"_is = s.beam.cosecant_to_deg,
      "resolution_m"_is = response.resolution_m(), "bin_m"_is = bin_m, "range_parts"_is = sum.range_parts,
      "ranges_do"_is = std::ceil(swath_m / response.resolution_m() * (1 - kRounding)),
      "level"_is = response.equivalent_length_m() / bin_m);
  return rows_of(
      measured,
      {{"scene", true,
        "{scene}, radar {radar}: {frustum} frustum of {columns} x {rows} pixels, sector of {sector_deg:4} "
        "degrees, {r_min_km:4} to {r_max_km:4} km, {azimuth} x {range} bins."},
       {"antenna", true, "The antenna is {height_m:.0f} m above its median ground; "},
       {"antenna", true, std::isfinite(f.radius_factor) ? "k = {k:4}" : "flat earth"},
       {"antenna", true, "; cells of {cell_m:4} m; {buildings} buildings."},
       {"beam", beam, "Beam: {beam_deg:3} degrees, {beam_bins:3} azimuth bins a beamwidth"},
       {"beam", beam && sum.azimuth_parts > 1, ", each cut into {azimuth_parts} sharp ones"},
       {"beam", beam,
        "; {azimuths_do} bins in the sector would do. At {r_max_km:4} km it is {beam_m:.0f} m wide. Each "
        "frame "
        "renders {more:.0f} % more azimuths for its edges."},
       {"elevation", elevation == ElevationPattern::cosecant,
        "Elevation: a fan, {elevation_deg:3} degrees and a cosecant squared down to {cosecant_deg:3}: level "
        "ground returns the same power from every range."},
       {"elevation", elevation == ElevationPattern::file, "Elevation: as in beam.file."},
       {"elevation", elevation == ElevationPattern::gaussian,
        "Elevation: a pencil of {elevation_deg:3} degrees: what lies a width off its middle is 24 dB down "
        "both "
        "ways."},
       {"pulse", pulse, "Pulse: resolution {resolution_m:4} m, range bins of {bin_m:4} m"},
       {"pulse", pulse && sum.range_parts > 1, ", each cut into {range_parts} sharp ones"},
       {"pulse", pulse,
        "; {ranges_do} bins in the swath would do for ground, twice as many for single houses. Level ground "
        "returns {level:3} of what a sharp range bin does."},
       {"speckle", plan && sum.speckle == SpeckleKind::independent,
        "Speckle: another draw in each azimuth bin and frame; no scatterers are sorted."},
       {"speckle", plan && sum.speckle == SpeckleKind::none,
        "Speckle: none; I&Q is the root of the mean power."},
       {"measured", true, "Measured in {measured} of {azimuth} azimuth bins, even wedges, with "},
       {"measured", true,
        f.flat_plates.empty() ? "the sweep, {planes} planes an azimuth bin"
                              : "rays of the {frustum} frustum, {planes} x {rays:.0f} a bin"},
       {"measured", all.wall_noise.has_value(), " (walls with rays, {planes} x {rays:.0f} a bin)"},
       {"measured", true, "; shifts at {points} ground points."},
       {"plates", !f.flat_plates.empty(),
        "Flat plates ({plates}): their power depends on how finely the surface is cut, so the cell size has "
        "no "
        "verdict in power, and the other changes in power hold for this cutting only."}});
}

}  // namespace obliq
