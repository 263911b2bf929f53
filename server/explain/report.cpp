// The report as text, Markdown and CSV.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "server/explain/explanation.h"
#include "server/explain/table.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// A column of the tables, and of the CSV, which has the number as it is.
template <class Of>
struct Column {
  const char *csv, *title, *unit;
  double (*of)(const Of& measured);
  const char* format;     ///< of a table's cell
  double factor = 1;      ///< from the number to a table's unit
  bool positive = false;  ///< 0 is nothing to a table
};
constexpr Column<PowerChange> kPower[] = {
    {"median_db", "median", "dB", [](const PowerChange& p) { return p.median_db; }, ".2f"},
    {"percentile95_db", "95 %", "dB", [](const PowerChange& p) { return p.percentile95_db; }, ".2f"},
    {"over_1_db", ">1 dB", "%", [](const PowerChange& p) { return p.over_1_db; }, ".2f", 100},
    {"vanished", "gone", "%", [](const PowerChange& p) { return p.vanished; }, ".2f", 100},
    {"appeared", "new", "%", [](const PowerChange& p) { return p.appeared; }, ".2f", 100},
    {"total_db", "total", "dB", [](const PowerChange& p) { return p.total_db(); }, ".2f"}};
constexpr Column<GroundShift> kShift[] = {
    {"slant_shift_m", "slant", "m", [](const GroundShift& s) { return s.slant_m; }, ".1f"},
    {"height_shift_m", "height", "m", [](const GroundShift& s) { return s.vertical_m; }, ".1f"}};
constexpr Column<Costs> kCosts[] = {
    {"frame_ms", "frame", "ms", [](const Costs& c) { return 1000 * c.frame_s; }, ".0f"},
    {"load_s", "load", "s", [](const Costs& c) { return c.load_s; }, ".2f", 1, true},
    {"build_s", "build", "s", [](const Costs& c) { return c.build_s; }, ".2f", 1, true},
    {"grid_mb", "grid", "MB", [](const Costs& c) { return megabytes(c.grid_bytes); }, ".1f"},
    {"buildings_mb", "buildings", "MB", [](const Costs& c) { return megabytes(c.building_bytes); }, ".1f"},
    {"embree_mb", "Embree", "MB", [](const Costs& c) { return megabytes(c.tracer_bytes); }, ".1f"}};
constexpr Column<SourceError> kSource[] = {
    {"source_error_p95_m", "", "", [](const SourceError& e) { return e.p95_m; }, ""}};
constexpr std::size_t kOfChange = std::size(kPower) + std::size(kShift);

/// A line of a table or of the CSV. What is null was not measured.
struct Line {
  std::string name, change = {}, verdict = {};
  const PowerChange* power = nullptr;
  const GroundShift* shift = nullptr;
  const Costs* costs = nullptr;
  const SourceError* source = nullptr;
  std::string threshold = {}, advice = {};
};

enum class Cells { csv_names, csv, titles, units, table };

template <class Of, std::size_t n>
void append(std::vector<std::string>& cells, Cells kind, const Column<Of> (&columns)[n], const Of* of) {
  for (const Column<Of>& column : columns) {
    const double value = of ? column.of(*of) : NAN;
    const bool shown = std::isfinite(value) && (value > 0 || kind == Cells::csv || !column.positive);
    cells.push_back(kind == Cells::csv_names ? column.csv
                    : kind == Cells::titles  ? column.title
                    : kind == Cells::units   ? column.unit
                    : kind == Cells::table   ? number_text(shown ? column.factor * value : NAN, column.format)
                    : shown                  ? fmt::format("{:.9g}", value)
                                             : "");
  }
}

/// Of all columns.
std::vector<std::string> cells_of(Cells kind, const Line& line = {}) {
  std::vector<std::string> cells;
  append(cells, kind, kPower, line.power);
  if (kind == Cells::table && line.power && line.power->nothing_left())
    cells[0] = cells[1] = "-", cells.back() = "none";
  append(cells, kind, kShift, line.shift);
  append(cells, kind, kCosts, line.costs);
  append(cells, kind, kSource, line.source);
  return cells;
}

Line line_of(const Comparison& c) {
  const char* verdict = c.verdict == Verdict::not_measured     ? "not measured"
                        : c.verdict == Verdict::not_needed     ? "may be left out"
                        : c.verdict == Verdict::beyond_measure ? "below the sampling noise"
                        : c.below_frustum_noise ? "needed, below the sampling noise of this frustum"
                                                : "needed";
  const bool measured = c.reason.empty();
  return {.name = c.name,
          .change = c.change,
          .verdict = verdict,
          .power = measured && c.power_counts ? &c.power : nullptr,
          .shift = c.shift ? &*c.shift : nullptr,
          .costs = measured ? &c.costs : nullptr,
          .source = c.source_error ? &*c.source_error : nullptr,
          .threshold = c.threshold,
          .advice = c.advice};
}

/// A table of `count` columns, from the first on.
Table table_of(const std::vector<Line>& lines, std::size_t first, std::size_t count) {
  const auto row = [&](const std::string& name, const std::string& change,
                       const std::vector<std::string>& cells) {
    std::vector<std::string> whole{name, change};
    const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(first);
    whole.insert(whole.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    return whole;
  };
  Table table{{row("", "", cells_of(Cells::titles)), row("ingredient", "changed to", cells_of(Cells::units))},
              {}};
  for (const Line& line : lines)
    table.rows.push_back(row(line.name, line.change, cells_of(Cells::table, line)));
  return table;
}

std::string noise_text(const PowerChange& p) {
  return text_of(
      values("median_db"_is = p.median_db, "percentile95_db"_is = p.percentile95_db,
             "over_1_db"_is = 100 * p.over_1_db, "vanished"_is = 100 * p.vanished,
             "total_db"_is = p.total_db()),
      {{"", p.nothing_left(), "nothing sampled, every lit bin is without a sample."},
       {"", !p.nothing_left(),
        "median {median_db:.2f} dB, 95 % of bins within {percentile95_db:.2f} dB, {over_1_db:.1f} % of "
        "them off by more than 1 dB; {vanished:.1f} % of lit bins without a sample; total "
        "{total_db:+.3f} dB."}});
}

struct Noise {
  std::string name;
  const PowerChange* change;
};
std::vector<Noise> noises(const Explanation& all) {
  std::vector<Noise> list{{"sampling noise of this frustum", &all.frustum_noise},
                          {"sampling noise of this measurement", &all.measurement_noise}};
  if (all.wall_noise) list.push_back({"sampling noise where walls are compared", &*all.wall_noise});
  return list;
}

/// What the star in a verdict means; empty when none has one.
std::string star_text(const Explanation& all) {
  const bool starred = std::ranges::any_of(all.comparisons, [](const Comparison& c) {
    return c.verdict == Verdict::needed && c.below_frustum_noise && c.ingredient != Ingredient::speckle;
  });
  return text_of(
      values("median_db"_is = all.frustum_noise.median_db),
      {{"", starred && all.frustum_noise.nothing_left(),
        "* Not in this frustum, which samples nothing: a finer one shows it."},
       {"", starred && !all.frustum_noise.nothing_left(),
        "* In single bins below the sampling noise of this frustum (median {median_db:.2f} dB): a finer "
        "one shows it."}});
}

std::string report(const Explanation& all, bool markdown) {
  constexpr std::size_t kWidth = 100;
  constexpr std::size_t kLabel = 19;
  std::string text;
  const auto paragraph = [&](const std::string& what) {
    text += markdown ? what + "\n" : wrapped("", what, kWidth, 0);
  };
  const auto heading = [&](const std::string& plain, const std::string& marked) {
    text += "\n" + (markdown ? "## " + marked : plain) + "\n\n";
  };
  const auto table = [&](const Table& cells) {
    text += markdown ? markdown_table(cells) : plain_table(cells);
  };
  const auto item = [&](const std::string& name, const std::string& what) {
    if (what.empty()) return;
    text += markdown ? fmt::format("- **{}**: {}\n", name, what) : wrapped(name, what, kWidth, kLabel);
  };

  std::vector<Line> changes, costs{{.name = "as the scene is", .costs = &all.costs}};
  for (const Comparison& c : all.comparisons) {
    if (c.ingredient != Ingredient::speckle) changes.push_back(line_of(c));  // powers stay
    if (c.reason.empty()) costs.push_back(line_of(c));
  }
  if (markdown) text += "# What " + all.facts.scene + " needs\n\n";
  for (const ReportRow& row : scene_rows(all)) paragraph(row.text);
  heading("WHAT EACH CHANGE DOES: |10 log10| of the power ratio in lit bins; greatest shift of ground points",
          "What each change does\n\nMedian, 95 %: |10 log10| of the power ratio in lit bins. Slant, height: "
          "greatest shift of a ground point.");
  table(table_of(changes, 0, kOfChange));
  text += "\n";
  for (const Noise& noise : noises(all)) {
    const std::string what = noise_text(*noise.change);
    markdown ? item(noise.name, what) : paragraph(noise.name + ": " + what);
  }
  heading("WHAT IT COSTS", "What it costs");
  table(table_of(costs, kOfChange, std::size(kCosts)));
  if (markdown) text += "\n";
  paragraph(
      text_of(values("threads"_is = all.facts.threads, "within_ms"_is = 1000 * frame_repeats_within_s(all)),
              {{"", true,
                "Frame: the scene's own frustum on these wedges, processor time scaled to all azimuth bins "
                "and {threads} threads. Differences within {within_ms:.0f} ms are not told from "
                "repetitions. Load and build as the clock saw them."}}));
  heading("FROM WHERE ON IT MATTERS, by closed forms with this scene's numbers", "From where on it matters");
  for (const Comparison& c : all.comparisons)
    item(markdown ? c.name + " (" + c.change + ")" : c.name, c.threshold);
  heading("BETWEEN ECHOES AND DISPLAY", "Between echoes and display");
  for (const ReportRow& row : all.radar) item(row.name, row.text);
  heading("VERDICT", "Verdict");
  if (!all.unsampled.empty()) item("sampling", all.unsampled + ".");
  for (const Comparison& c : all.comparisons) item(c.name, c.advice);
  if (const std::string star = star_text(all); !star.empty())
    text += markdown ? "\n\\" + star + "\n" : wrapped("", star, kWidth, 2);
  return text;
}

}  // namespace

std::string plain_report(const Explanation& all) { return report(all, false); }
std::string markdown_report(const Explanation& all) { return report(all, true); }

std::string csv_report(const Explanation& all) {
  std::string text;
  const auto add = [&](const Line& line, Cells kind = Cells::csv) {
    std::vector<std::string> fields = cells_of(kind, line);
    fields.insert(fields.begin(), {line.name, line.change, line.verdict});
    fields.insert(fields.end(), {line.threshold, line.advice});
    for (std::size_t n = 0; n < fields.size(); ++n) text += (n > 0 ? "," : "") + csv_field(fields[n]);
    text += "\n";
  };
  add({.name = "ingredient",
       .change = "changed_to",
       .verdict = "verdict",
       .threshold = "threshold",
       .advice = "advice"},
      Cells::csv_names);
  add({.name = "scene", .change = all.facts.scene, .costs = &all.costs, .source = &all.facts.source_error});
  for (const Noise& noise : noises(all)) add({.name = noise.name, .power = noise.change});
  const PowerChange no_noise;
  if (!all.wall_noise) add({.name = "sampling noise where walls are compared", .power = &no_noise});
  for (const Comparison& c : all.comparisons) add(line_of(c));
  return text;
}

}  // namespace obliq
