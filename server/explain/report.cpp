#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "server/explain/explanation.h"
#include "server/explain/table.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr std::size_t kWidth = 100;

const char* verdict_word(const Comparison& c) {
  switch (c.verdict) {
    case Verdict::needed:
      return c.below_frustum_noise ? "needed, below the sampling noise of this frustum" : "needed";
    case Verdict::not_needed:
      return "may be left out";
    case Verdict::beyond_measure:
      return "below the sampling noise";
    case Verdict::not_measured:
      return "not measured";
  }
  return "";
}

std::string number(double value, int digits) {
  value = without_sign_of_zero(value, std::pow(10.0, -digits));
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

std::string percent(double share) { return number(100 * share, 2); }

std::string megabytes(std::uint64_t bytes) { return number(static_cast<double>(bytes) / 1e6, 1); }

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

/// What the beam and the pulse of the scene do to its bins, a sentence each; nothing where they are off.
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

std::vector<std::string> scene_lines(const Explanation& all) {
  const SceneFacts& f = all.facts;
  const RadarSettings& s = f.settings;
  std::vector<std::string> lines;
  lines.push_back(fmt::format(
      "{}, radar {}: {} frustum of {} x {} pixels, sector of {} degrees, {} to {} km, {} x {} bins.", f.scene,
      f.radar, frustum_name(s.frustum), s.pixel_columns, s.pixel_rows, short_number(s.sector_deg, 4),
      short_number(s.r_min_m / 1000, 4), short_number(s.r_max_m / 1000, 4), s.azimuth_bins, s.range_bins));
  const std::string earth =
      std::isfinite(f.radius_factor) ? "k = " + short_number(f.radius_factor, 4) : "flat earth";
  lines.push_back(
      fmt::format("The antenna is {:.0f} m above its median ground; {}; cells of {} m; {} buildings.",
                  f.height_m, earth, short_number(f.cell_m, 4), f.buildings));
  for (std::string& line : beam_lines(f)) lines.push_back(std::move(line));
  std::string density = f.flat_plates.empty()
                            ? fmt::format("the sweep, {} planes an azimuth bin", f.columns)
                            : fmt::format("rays of the {} frustum, {} x {:.0f} a bin",
                                          frustum_name(s.frustum), f.columns, kComparisonDensity.rows);
  if (all.wall_noise)
    density += fmt::format(" (walls with rays, {} x {:.0f} a bin)", f.columns, kComparisonDensity.rows);
  lines.push_back(
      fmt::format("Measured in {} of {} azimuth bins, even wedges, with {}; shifts at {} ground points.",
                  f.measured_azimuth_bins, s.azimuth_bins, density, f.ground_points));
  if (!f.flat_plates.empty()) {
    std::string names;
    for (const std::string& name : f.flat_plates) names += (names.empty() ? "" : ", ") + name;
    lines.push_back(
        "Flat plates (" + names +
        "): their power depends on how finely the surface is cut, so the cell size has no verdict "
        "in power, and the other changes in power hold for this cutting only.");
  }
  return lines;
}

std::vector<std::string> change_cells(const PowerChange& p) {
  if (p.nothing_left())
    return {"-", "-", percent(p.over_1_db), percent(p.vanished), percent(p.appeared), "none"};
  return {number(p.median_db, 2), number(p.percentile95_db, 2), percent(p.over_1_db),
          percent(p.vanished),    percent(p.appeared),          number(p.total_db(), 2)};
}

Table change_table(const Explanation& all) {
  Table table;
  table.head = {{"", "", "median", "95 %", ">1 dB", "gone", "new", "total", "slant", "height"},
                {"ingredient", "changed to", "dB", "dB", "%", "%", "%", "dB", "m", "m"}};
  for (const Comparison& c : all.comparisons) {
    if (c.ingredient == Ingredient::speckle) continue;  // powers stay
    std::vector<std::string> row{c.name, c.change};
    const auto cells =
        c.reason.empty() && c.power_counts ? change_cells(c.power) : std::vector<std::string>(6, "-");
    row.insert(row.end(), cells.begin(), cells.end());
    row.push_back(c.shift ? number(c.shift->slant_m, 1) : "-");
    row.push_back(c.shift ? number(c.shift->vertical_m, 1) : "-");
    table.rows.push_back(row);
  }
  return table;
}

std::string noise_text(const PowerChange& p) {
  if (p.nothing_left()) return "nothing sampled, every lit bin is without a sample";
  return fmt::format(
      "median {:.2f} dB, 95 % of bins within {:.2f} dB, {:.1f} % of them off by more than 1 dB; {:.1f} % of "
      "lit bins without a sample; total {:+.3f} dB",
      p.median_db, p.percentile95_db, 100 * p.over_1_db, 100 * p.vanished,
      without_sign_of_zero(p.total_db(), 0.001));
}

struct NamedText {
  std::string name, text;
};

std::vector<NamedText> noises(const Explanation& all) {
  std::vector<NamedText> list{{"sampling noise of this frustum", noise_text(all.frustum_noise)},
                              {"sampling noise of this measurement", noise_text(all.measurement_noise)}};
  if (all.wall_noise)
    list.push_back({"sampling noise where walls are compared", noise_text(*all.wall_noise)});
  return list;
}

std::vector<std::string> cost_cells(const Costs& c) {
  return {number(1000 * c.frame_s, 0),
          c.load_s > 0 ? number(c.load_s, 2) : "-",
          c.build_s > 0 ? number(c.build_s, 2) : "-",
          megabytes(c.grid_bytes),
          megabytes(c.building_bytes),
          megabytes(c.tracer_bytes)};
}

Table cost_table(const Explanation& all) {
  Table table;
  table.head = {{"", "", "frame", "load", "build", "grid", "buildings", "Embree"},
                {"ingredient", "changed to", "ms", "s", "s", "MB", "MB", "MB"}};
  const auto add = [&](const std::string& name, const std::string& change, const Costs& costs) {
    std::vector<std::string> row{name, change};
    const auto cells = cost_cells(costs);
    row.insert(row.end(), cells.begin(), cells.end());
    table.rows.push_back(row);
  };
  add("as the scene is", "", all.costs);
  for (const Comparison& c : all.comparisons)
    if (c.reason.empty()) add(c.name, c.change, c.costs);
  return table;
}

std::string times_text(const Explanation& all) {
  return fmt::format(
      "Frame: the scene's own frustum on these wedges, processor time scaled to all azimuth bins and {} "
      "threads. Differences within {:.0f} ms are not told from repetitions. Load and build as the clock saw "
      "them.",
      all.facts.threads, 1000 * frame_repeats_within_s(all));
}

/// "earth curvature (flat earth)".
std::string title(const Comparison& c) { return c.name + " (" + c.change + ")"; }

/// What the star in a verdict means; empty when none has one.
std::string star_text(const Explanation& all) {
  for (const Comparison& c : all.comparisons) {
    if (c.verdict == Verdict::needed && c.below_frustum_noise && c.ingredient != Ingredient::speckle)
      return all.frustum_noise.nothing_left()
                 ? "* Not in this frustum, which samples nothing: a finer one shows it."
                 : fmt::format(
                       "* In single bins below the sampling noise of this frustum (median {:.2f} dB): a "
                       "finer one shows it.",
                       all.frustum_noise.median_db);
  }
  return {};
}

}  // namespace

std::string plain_report(const Explanation& all) {
  constexpr std::size_t kLabel = 19;
  std::string text;
  for (const std::string& line : scene_lines(all)) text += wrapped("", line, kWidth, 0);
  text +=
      "\nWHAT EACH CHANGE DOES: |10 log10| of the power ratio in lit bins; greatest shift of ground "
      "points\n\n";
  text += plain_table(change_table(all)) + "\n";
  for (const NamedText& noise : noises(all))
    text += wrapped("", noise.name + ": " + noise.text + ".", kWidth, 0);
  text += "\nWHAT IT COSTS\n\n" + plain_table(cost_table(all));
  text += wrapped("", times_text(all), kWidth, 0);
  text += "\nFROM WHERE ON IT MATTERS, by closed forms with this scene's numbers\n\n";
  for (const Comparison& c : all.comparisons)
    if (!c.threshold.empty()) text += wrapped(c.name, c.threshold, kWidth, kLabel);
  text += "\nBETWEEN ECHOES AND DISPLAY\n\n";
  for (const RadarRow& row : all.radar) text += wrapped(row.name, row.text, kWidth, kLabel);
  text += "\nVERDICT\n\n";
  if (!all.unsampled.empty()) text += wrapped("sampling", all.unsampled + ".", kWidth, kLabel);
  for (const Comparison& c : all.comparisons) text += wrapped(c.name, c.advice, kWidth, kLabel);
  if (!star_text(all).empty()) text += wrapped("", star_text(all), kWidth, 2);
  return text;
}

std::string markdown_report(const Explanation& all) {
  std::string text = "# What " + all.facts.scene + " needs\n\n";
  for (const std::string& line : scene_lines(all)) text += line + "\n";
  text +=
      "\n## What each change does\n\nMedian, 95 %: |10 log10| of the power ratio in lit bins. Slant, height: "
      "greatest shift of a ground point.\n\n";
  text += markdown_table(change_table(all)) + "\n";
  const auto item = [&](const std::string& name, const std::string& what) {
    if (!what.empty()) text += fmt::format("- **{}**: {}\n", name, what);
  };
  for (const NamedText& noise : noises(all)) item(noise.name, noise.text + ".");
  text += fmt::format("\n## What it costs\n\n{}\n{}\n", markdown_table(cost_table(all)), times_text(all));
  text += "\n## From where on it matters\n\n";
  for (const Comparison& c : all.comparisons) item(title(c), c.threshold);
  text += "\n## Between echoes and display\n\n";
  for (const RadarRow& row : all.radar) item(row.name, row.text);
  text += "\n## Verdict\n\n";
  if (!all.unsampled.empty()) item("sampling", all.unsampled + ".");
  for (const Comparison& c : all.comparisons) item(c.name, c.advice);
  if (!star_text(all).empty()) text += "\n\\" + star_text(all) + "\n";
  return text;
}

std::string csv_report(const Explanation& all) {
  std::string text =
      "ingredient,changed_to,verdict,median_db,percentile95_db,over_1_db,vanished,appeared,total_db,slant_"
      "shift_m,"
      "height_shift_m,frame_ms,load_s,build_s,grid_mb,buildings_mb,embree_mb,source_error_p95_m,threshold,"
      "advice\n";
  const auto exact = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
  };
  const auto line = [&](const std::vector<std::string>& fields) {
    for (std::size_t n = 0; n < fields.size(); ++n) text += (n > 0 ? "," : "") + csv_field(fields[n]);
    text += "\n";
  };
  const auto power_fields = [&](std::vector<std::string>& to, const PowerChange& p) {
    for (const double value :
         {p.median_db, p.percentile95_db, p.over_1_db, p.vanished, p.appeared, p.total_db()})
      to.push_back(exact(value));
  };
  const auto cost_fields = [&](std::vector<std::string>& to, const Costs& c) {
    for (const double value :
         {1000 * c.frame_s, c.load_s, c.build_s, static_cast<double>(c.grid_bytes) / 1e6,
          static_cast<double>(c.building_bytes) / 1e6, static_cast<double>(c.tracer_bytes) / 1e6})
      to.push_back(exact(value));
  };
  std::vector<std::string> scene{"scene", all.facts.scene, "", "", "", "", "", "", "", "", ""};
  cost_fields(scene, all.costs);
  scene.push_back(exact(all.facts.source_error.p95_m));
  scene.insert(scene.end(), {"", ""});
  line(scene);
  const auto noise = [&](const char* name, const PowerChange& p) {
    std::vector<std::string> fields{name, "", ""};
    power_fields(fields, p);
    fields.resize(20);
    line(fields);
  };
  noise("sampling noise of this frustum", all.frustum_noise);
  noise("sampling noise of this measurement", all.measurement_noise);
  noise("sampling noise where walls are compared", all.wall_noise.value_or(PowerChange{}));
  for (const Comparison& c : all.comparisons) {
    std::vector<std::string> fields{c.name, c.change, verdict_word(c)};
    if (c.reason.empty()) {
      if (c.power_counts) power_fields(fields, c.power);
      fields.resize(9);
      fields.push_back(c.shift ? exact(c.shift->slant_m) : "");
      fields.push_back(c.shift ? exact(c.shift->vertical_m) : "");
      cost_fields(fields, c.costs);
      fields.push_back(c.source_error ? exact(c.source_error->p95_m) : "");
    }
    fields.resize(18);
    fields.insert(fields.end(), {c.threshold, c.advice});
    line(fields);
  }
  return text;
}

}  // namespace obliq
