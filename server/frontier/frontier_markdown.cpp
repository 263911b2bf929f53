#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "server/frontier/frontier_table.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

std::string missed_text(const FrontierRow& row) {
  if (row.buildings_visible == 0) return "";
  return fmt::format("{:.0f} of {:.0f}", row.buildings_missed, row.buildings_visible);
}

std::string sampling_cell(const FrontierRow& row) {
  return sampling_text(row.sampling) + (is_paper_sampling(row.sampling) ? " (the paper's)" : "");
}

/// How many times smaller ours is. Where theirs is 0 as well there was nothing to lower.
std::string ratio_text(double theirs, double ours) {
  if (theirs == 0) return "-";
  return ours > 0 ? short_number(theirs / ours) + " x" : "none left";
}

std::string comparison_rows(const std::vector<FrontierRow>& rows, double scene_cell_m, Returns returns) {
  const std::vector<FrontierRow> table = compare_with_paper(rows, scene_cell_m, returns);
  if (table.empty() || table.front().lit == 0) return "Nothing is lit here: nothing to compare.\n";
  const FrontierRow& paper = table.front();
  std::string text =
      "| sampling | frame, ms | quicker | E | E lower | gaps | gaps lower | false light | missed buildings "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const FrontierRow& row : table)
    text += fmt::format("| {} | {:.1f} | {} | {} | {} | {} | {} | {} | {} |\n", sampling_cell(row),
                        row.frame_ms, ratio_text(paper.frame_ms, row.frame_ms), short_number(row.power_error),
                        ratio_text(paper.power_error, row.power_error), percent_text(row.gap_fraction),
                        ratio_text(paper.gap_fraction, row.gap_fraction),
                        percent_text(row.false_light_fraction), missed_text(row));
  return text;
}

std::string comparison_tables(const FrontierHeader& h, const std::vector<FrontierRow>& rows) {
  if (compare_with_paper(rows, h.scene_cell_m).empty())
    return "The paper's setting (oblique 2048 x 2048, nearest bin) was not asked for or cannot see this "
           "scene, so there is nothing to compare with.\n";
  std::string text =
      "For each kind the sampling of least E that takes no more time than the paper's setting (the quickest "
      "one "
      "where all\ntake more). Ratios: the paper's figure over this one's.\n\n" +
      comparison_rows(rows, h.scene_cell_m, Returns::all);
  if (h.buildings > 0)
    text += "\nThe terrain's returns alone:\n\n" + comparison_rows(rows, h.scene_cell_m, Returns::terrain) +
            "\nThe buildings' returns alone:\n\n" + comparison_rows(rows, h.scene_cell_m, Returns::buildings);
  return text;
}

std::string error_table(const std::vector<FrontierRow>& rows, Returns returns) {
  std::string text =
      "| sampling | cell, m | frame, ms | without states, ms | processor, ms | E | median dB | 95 % dB | "
      "mean error | energy "
      "| gaps "
      "| false light, bins | energy | missed buildings |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const FrontierRow& row : rows) {
    if (row.returns != returns || !row.possible()) continue;
    text += fmt::format(
        "| {} | {} | {:.1f} | {:.1f} | {:.0f} | {} | {} | {} | {:+.3g} % | {} | {} | {} | {} |\n",
        sampling_cell(row), short_number(row.sampling.cell_m), row.frame_ms, row.bare_ms, row.processor_ms,
        short_number(row.power_error),
        row.has_decibels() ? short_number(row.median_db) + " | " + short_number(row.percentile95_db)
                           : std::string("- | -"),
        percent_text(row.mean_relative), 100 * row.energy_error, percent_text(row.gap_fraction),
        percent_text(row.false_light_fraction), percent_text(row.false_light_energy),
        returns == Returns::terrain ? "" : missed_text(row));
  }
  return text;
}

/// The bins of those returns, and the errors of every sampling in them.
std::string returns_section(const std::string& title, const std::vector<FrontierRow>& rows, Returns returns) {
  const auto row =
      std::ranges::find_if(rows, [&](const FrontierRow& r) { return r.returns == returns && r.possible(); });
  const std::string counts = row == rows.end()
                                 ? ""
                                 : fmt::format("{:.0f} bins are lit, {:.0f} dark, {:.0f} neither.\n\n",
                                               row->lit, row->dark, row->dont_care);
  return "\n## " + title + "\n\n" + counts + error_table(rows, returns);
}

/// The check against what the table shows; before it was measured, the finest frames stood for it.
TruthCheck against_rows(TruthCheck check, const std::vector<FrontierRow>& rows) {
  constexpr std::pair<const char*, double FrontierRow::*> kMeasures[] = {
      {"E", &FrontierRow::power_error},
      {"median dB", &FrontierRow::median_db},
      {"gaps", &FrontierRow::gap_fraction},
      {"false light", &FrontierRow::false_light_fraction}};
  for (const auto& [name, value] : kMeasures) {
    bool first = true;
    for (const FrontierRow& row : rows) {
      if (!row.possible() || check.measure != name + (", " + returns_name(row.returns))) continue;
      if (std::exchange(first, false)) check.smallest = 0;
      if (row.*value > 0 && (check.smallest <= 0 || row.*value < check.smallest)) check.smallest = row.*value;
    }
  }
  return check;
}

std::string truth_text(const FrontierHeader& h, const std::vector<FrontierRow>& rows) {
  const bool reference = h.against == Against::reference;
  std::string text = fmt::format(
      "Truth: {}{} planes in each azimuth bin{}, on the grid of {} m, compared on {} of {} azimuth bins.\n",
      reference ? "the sweep with " : "", h.truth.planes_per_bin,
      reference ? std::string(" and exact strands (quality \"reference\")")
                : ", steps of " + short_number(h.truth.step_m) + " m",
      short_number(h.truth_cell_m), h.azimuths_compared, h.azimuth_bins);
  if (h.truth_checks.empty()) return text + "Its own error was not measured.\n";
  text += fmt::format(
      "Its own error (against twice the planes{}, {} azimuth bins), to be at most a tenth of the smallest "
      "error shown:\n\n| measure | truth's own | smallest shown | |\n|---|---|---|---|\n",
      reference ? "" : " and half the step", h.truth_check_azimuths);
  for (const TruthCheck& expected : h.truth_checks) {
    const TruthCheck check = against_rows(expected, rows);
    text += fmt::format("| {} | {} | {} | {} |\n", check.measure, short_number(check.own),
                        short_number(check.smallest), check.holds() ? "held" : "NOT held");
  }
  return text;
}

/// Times mean little on a busy machine, and the reader is to know.
std::string load_text(const std::vector<FrontierRow>& rows, int threads) {
  std::vector<double> loads;
  for (const FrontierRow& row : rows)
    if (row.possible()) loads.push_back(row.load);
  if (loads.empty()) return "";
  const auto [least, most] = std::ranges::minmax(loads);
  return fmt::format(" The machine's load before the frames was {} to {}; this run alone makes up to {}.",
                     short_number(least), short_number(most), threads);
}

std::string impossible_list(const std::vector<FrontierRow>& rows) {
  std::string text;
  for (const FrontierRow& row : rows)
    if (!row.possible())
      text += fmt::format("- {}, cell {} m: {}\n", sampling_text(row.sampling),
                          short_number(row.sampling.cell_m), row.not_possible);
  return text.empty() ? text : "\n## Not possible here\n\n" + text;
}

}  // namespace

std::string frontier_markdown(const FrontierHeader& h, const std::vector<FrontierRow>& rows) {
  std::string text = fmt::format(
      "# Speed against error: {}\n\n{}; {} buildings.\n{}.{}\n\n![Frame time against "
      "error](frontier.svg)\n\n## Against the paper's setting\n\n{}",
      h.scene, h.view, h.buildings, machine_text(h), load_text(rows, h.threads), comparison_tables(h, rows));
  text += returns_section("All returns", rows, Returns::all);
  if (h.buildings > 0)
    text += returns_section("Returns of the terrain alone", rows, Returns::terrain) +
            returns_section("Returns of the buildings alone", rows, Returns::buildings);
  return text + impossible_list(rows) +
         "\n## How it was measured\n\n"
         "Frame: plan, render and every plane of the whole sector, as a client gets it. Without states: the "
         "same without the\n`state` plane. Processor: time of all threads together. T is the truth's power "
         "of a bin, P the frame's, q = r^3 T, M the median of q over T > 0. Lit: q >= 1e-3 M.\nDark: T = 0. "
         "E = sqrt(sum q^2 (P/T - 1)^2 / sum q^2) over lit bins; dB: |10 log10 P/T| over lit bins with P > "
         "0; "
         "mean error:\nmean of min(|P/T - 1|, 1); gaps: lit, P = 0, of the lit; false light: dark, P > 0, of "
         "the dark, and its share of the truth's\nenergy. A building is missed when the truth " +
         std::string(h.against == Against::reference ? "has a sample on it"
                                                     : "sees at least 1 % of it and of one bin's power") +
         ", and the frame has none.\nRows of another cell size are compared with the same truth.\n\n" +
         truth_text(h, rows);
}

std::string machine_text(const FrontierHeader& h) {
  return fmt::format("{}, {}{}{}, obliq {}; least of {} frames after one unmeasured", h.cpu, h.threads,
                     h.threads == 1 ? " thread, " : " threads, ", h.tracer, h.version, h.repeats);
}

}  // namespace obliq
