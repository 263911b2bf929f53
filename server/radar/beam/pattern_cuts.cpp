#include "server/radar/beam/pattern_cuts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "terrain/base/csv_rows.h"

namespace obliq {
namespace {

/// A table that steps over half its own beam says nothing about it.
constexpr std::size_t kLeastRows = 3;

/// Beyond these a table is of losses, of ratios, or cut off.
constexpr double kMostOffBoresight_db = 6;
constexpr double kLeastEdge_db = 10;
constexpr double kAllRound_rad = 355 * std::numbers::pi / 180;

std::string decibels(double db) { return fmt::format("{:.3g}", db); }

void take_row(const CsvRows& row, PatternCuts& cuts) {
  const std::string& cut_name = row.cell(0);
  if (cut_name != "azimuth" && cut_name != "elevation")
    row.refuse(CsvRows::shown(cut_name), "azimuth or elevation");
  PatternCut& cut = cut_name == "azimuth" ? cuts.azimuth : cuts.elevation;
  const double angle = row.number(1, -180, 180) * std::numbers::pi / 180;
  if (!cut.angle_rad.empty() && angle <= cut.angle_rad.back())
    row.refuse(CsvRows::shown(row.cell(1)), "angles that rise from row to row");
  cut.angle_rad.push_back(angle);
  cut.gain_db.push_back(row.number(2, -300, 100));
}

/// Relative to the peak, which must be near the boresight: a table in the wrong units or of the wrong cut has
/// it elsewhere.
void normalise(const CsvRows& rows, const std::string& name, PatternCut& cut) {
  if (cut.angle_rad.empty()) return;
  if (cut.angle_rad.size() < kLeastRows)
    rows.refuse(std::to_string(cut.angle_rad.size()) + " rows of cut " + name,
                "at least " + std::to_string(kLeastRows));
  if (cut.angle_rad.front() > 0 || cut.angle_rad.back() < 0)
    rows.refuse("a cut " + name + " that leaves out angle 0",
                "angles from the boresight, on both sides of it");
  const double peak = *std::ranges::max_element(cut.gain_db);
  for (double& gain : cut.gain_db) gain -= peak;
  const double ahead_db = 10 * std::log10(cut.gain(0));
  if (ahead_db < -kMostOffBoresight_db)
    rows.refuse("a cut " + name + " that is " + decibels(-ahead_db) + " dB below its peak at angle 0",
                "gains, not losses, with the peak on the boresight or at most " +
                    decibels(kMostOffBoresight_db) + " dB above it");
  const bool all_round = cut.angle_rad.back() - cut.angle_rad.front() >= kAllRound_rad;
  const double edge_db = std::max(cut.gain_db.front(), cut.gain_db.back());
  if (!all_round && edge_db > -kLeastEdge_db)
    rows.refuse(
        "a cut " + name + " that is only " + decibels(-edge_db) + " dB below its peak where it ends",
        "dB, not ratios, and angles as far as at least " + decibels(kLeastEdge_db) + " dB below the peak");
}

}  // namespace

double PatternCut::gain(double offset_rad) const {
  if (angle_rad.empty() || !(offset_rad >= angle_rad.front() && offset_rad <= angle_rad.back())) return 0;
  const auto above = std::ranges::upper_bound(angle_rad, offset_rad);
  const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      above - angle_rad.begin(), 1, static_cast<std::ptrdiff_t>(angle_rad.size()) - 1));
  const double share = (offset_rad - angle_rad[k - 1]) / (angle_rad[k] - angle_rad[k - 1]);
  return std::pow(10, (gain_db[k - 1] + share * (gain_db[k] - gain_db[k - 1])) / 10);
}

double PatternCut::extent_rad(double edge) const {
  const double edge_db = 10 * std::log10(edge);
  double extent = 0;
  for (std::size_t k = 0; k < angle_rad.size(); ++k)
    for (const std::size_t near : {k == 0 ? k : k - 1, std::min(k + 1, angle_rad.size() - 1)})
      if (gain_db[k] > edge_db) extent = std::max(extent, std::abs(angle_rad[near]));
  return extent;
}

PatternCuts read_pattern_cuts(const std::filesystem::path& file) {
  CsvRows rows(file, "beam.file", "cut,angle_deg,gain_db");
  PatternCuts cuts;
  cuts.path = file;
  while (rows.next()) take_row(rows, cuts);
  if (cuts.azimuth.angle_rad.empty() && cuts.elevation.angle_rad.empty())
    rows.refuse("no rows", "rows of the cuts azimuth and elevation");
  normalise(rows, "azimuth", cuts.azimuth);
  normalise(rows, "elevation", cuts.elevation);
  return cuts;
}

}  // namespace obliq
