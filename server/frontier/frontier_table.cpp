#include "server/frontier/frontier_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "server/output/frame_files.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {

namespace {

/// What a row is made of.
struct Measured {
  const FrameMeasurement& frame;
  const BinErrors& bins;
  const BuildingErrors& buildings;
  double load;
};
using M = const Measured&;
using Row = FrontierRow;

double count(std::uint64_t n) { return static_cast<double>(n); }

/// A number of a row: its name in the file, its member, and where it comes from.
struct Column {
  std::string_view name;
  double Row::*value;
  double (*of)(M measured);
};
constexpr Column kColumns[] = {
    {"frame_ms", &Row::frame_ms, [](M m) { return 1000 * m.frame.all_planes.least_s; }},
    {"frame_median_ms", &Row::frame_median_ms, [](M m) { return 1000 * m.frame.all_planes.median_s; }},
    {"bare_ms", &Row::bare_ms, [](M m) { return 1000 * m.frame.no_states.least_s; }},
    {"bare_median_ms", &Row::bare_median_ms, [](M m) { return 1000 * m.frame.no_states.median_s; }},
    {"processor_ms", &Row::processor_ms, [](M m) { return 1000 * m.frame.all_planes.processor_s; }},
    {"rays", &Row::rays, [](M m) { return count(m.frame.stats.rays); }},
    {"samples", &Row::samples, [](M m) { return count(m.frame.stats.samples); }},
    {"power_error", &Row::power_error, [](M m) { return m.bins.power_error; }},
    {"median_db", &Row::median_db, [](M m) { return m.bins.median_db; }},
    {"percentile95_db", &Row::percentile95_db, [](M m) { return m.bins.percentile95_db; }},
    {"mean_relative", &Row::mean_relative, [](M m) { return m.bins.mean_relative; }},
    {"energy_error", &Row::energy_error, [](M m) { return m.bins.energy_error(); }},
    {"bins", &Row::bins, [](M m) { return count(m.bins.bins); }},
    {"lit", &Row::lit, [](M m) { return count(m.bins.lit); }},
    {"dark", &Row::dark, [](M m) { return count(m.bins.dark); }},
    {"dont_care", &Row::dont_care, [](M m) { return count(m.bins.dont_care); }},
    {"gaps", &Row::gaps, [](M m) { return count(m.bins.gaps); }},
    {"gap_fraction", &Row::gap_fraction, [](M m) { return m.bins.gap_fraction(); }},
    {"false_light", &Row::false_light, [](M m) { return count(m.bins.false_light); }},
    {"false_light_fraction", &Row::false_light_fraction, [](M m) { return m.bins.false_light_fraction(); }},
    {"false_light_energy", &Row::false_light_energy, [](M m) { return m.bins.false_light_energy(); }},
    {"buildings_visible", &Row::buildings_visible, [](M m) { return count(m.buildings.visible); }},
    {"buildings_missed", &Row::buildings_missed, [](M m) { return count(m.buildings.missed); }},
    {"load", &Row::load, [](M m) { return m.load; }},
};
constexpr std::string_view kCaseColumns = "kind,columns,rows,plates,sub_columns,cell_m,returns";
constexpr std::size_t kCaseFields = 7;
constexpr std::size_t kFields = kCaseFields + std::size(kColumns) + 1;

/// The shortest text that reads back to the same bits.
std::string number_text(double value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T, std::size_t n>
bool choose(const std::string& text, const std::array<T, n>& values, std::string (*name)(T), T& chosen) {
  const auto found = std::ranges::find_if(values, [&](T value) { return name(value) == text; });
  if (found != values.end()) chosen = *found;
  return found != values.end();
}

std::optional<FrontierRow> row_of(const std::string& line) {
  const std::vector<std::string> fields = csv_fields(line);
  if (fields.size() != kFields) return std::nullopt;
  FrontierRow row;
  SamplingCase& c = row.sampling;
  const auto columns = number_of(fields[1]);
  const auto rows = number_of(fields[2]);
  const auto sub_columns = number_of(fields[4]);
  const auto cell_m = number_of(fields[5]);
  const std::array kinds{FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep};
  if (!choose(fields[0], kinds, frustum_name, c.kind) ||
      !choose(fields[3], std::array{PlateKind::spread, PlateKind::nearest}, plates_name, c.plates) ||
      !choose(fields[6], std::array{Returns::all, Returns::terrain, Returns::buildings}, returns_name,
              row.returns) ||
      !columns || !rows || !sub_columns || !cell_m)
    return std::nullopt;
  c.columns = static_cast<int>(*columns);
  c.rows = static_cast<int>(*rows);
  c.sub_columns = static_cast<int>(*sub_columns);
  c.cell_m = *cell_m;
  auto field = fields.begin() + kCaseFields;
  for (const Column& column : kColumns) {
    const auto value = number_of(*field++);
    if (!value) return std::nullopt;
    row.*column.value = *value;
  }
  row.not_possible = fields.back();
  return row;
}

}  // namespace

std::string returns_name(Returns returns) {
  constexpr std::array kNames{"all", "terrain", "buildings"};
  return kNames[static_cast<std::size_t>(returns)];
}

std::vector<FrontierRow> rows_of(const SamplingCase& sampling, const FrameMeasurement& measured,
                                 double load) {
  std::vector<FrontierRow> rows;
  for (const Returns returns : {Returns::all, Returns::terrain, Returns::buildings}) {
    if (returns != Returns::all && !measured.has_buildings) break;
    const auto& [bins, buildings] = measured.errors[static_cast<int>(returns)];
    FrontierRow row;
    row.sampling = sampling;
    row.returns = returns;
    for (const Column& column : kColumns) row.*column.value = column.of({measured, bins, buildings, load});
    rows.push_back(row);
  }
  return rows;
}

FrontierRow impossible_row(const SamplingCase& sampling, const std::string& reason) {
  FrontierRow row;
  row.sampling = sampling;
  row.not_possible = reason;
  return row;
}

std::string csv_header() {
  std::string text(kCaseColumns);
  for (const Column& column : kColumns) text += "," + std::string(column.name);
  return text + ",not_possible\n";
}

std::string csv_line(const FrontierRow& row) {
  const SamplingCase& c = row.sampling;
  std::string text =
      fmt::format("{},{},{},{},{},{},{}", frustum_name(c.kind), c.columns, c.rows, plates_name(c.plates),
                  c.sub_columns, number_text(c.cell_m), returns_name(row.returns));
  for (const Column& column : kColumns) text += "," + number_text(row.*column.value);
  return text + "," + csv_field(one_line(row.not_possible)) + "\n";
}

std::vector<FrontierRow> read_frontier_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line) || line + "\n" != csv_header())
    throw InputError(path.string() +
                     ": found no table of this version; allowed: one that `obliq frontier` wrote, or "
                     "--restart to begin again");
  std::vector<FrontierRow> rows;
  for (int number = 2; std::getline(file, line); ++number) {
    if (file.eof()) break;  // no newline behind it: it was cut off
    const auto row = row_of(line);
    if (!row)
      throw InputError(
          fmt::format("{}:{}: found a line that is none of this table's; allowed: what `obliq frontier` "
                      "wrote, or --restart to begin again",
                      path.string(), number));
    rows.push_back(*row);
  }
  return rows;
}

const FrontierRow* find_row(const std::vector<FrontierRow>& rows, const SamplingCase& sampling,
                            Returns returns) {
  const auto found = std::ranges::find_if(
      rows, [&](const FrontierRow& row) { return row.sampling == sampling && row.returns == returns; });
  return found != rows.end() ? &*found : nullptr;
}

std::vector<FrontierRow> compare_with_paper(const std::vector<FrontierRow>& rows, double scene_cell_m,
                                            Returns returns) {
  const FrontierRow* paper = find_row(rows, paper_sampling(scene_cell_m), returns);
  if (paper == nullptr || !paper->possible()) return {};
  const auto rank = [&](const FrontierRow& row) {
    const bool late = row.frame_ms > paper->frame_ms;
    return std::pair(late, late ? row.frame_ms : row.power_error);
  };
  std::vector<FrontierRow> table{*paper};
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    const FrontierRow* best = nullptr;
    for (const FrontierRow& row : rows)
      if (row.possible() && row.returns == returns && row.sampling.kind == kind &&
          row.sampling.cell_m == scene_cell_m && (best == nullptr || rank(row) < rank(*best)))
        best = &row;
    if (best != nullptr && best != paper) table.push_back(*best);
  }
  return table;
}

using nlohmann::ordered_json;

NLOHMANN_JSON_SERIALIZE_ENUM(Against, {{Against::truth, "truth"}, {Against::reference, "reference"}})

static void to_json(ordered_json& json, const TruthCheck& check) {
  json = {{"measure", check.measure},
          {"truth", check.own},
          {"smallest_shown", check.smallest},
          {"holds", check.holds()}};
}
static void from_json(const ordered_json& json, TruthCheck& check) {
  check = {json.at("measure"), json.at("truth"), json.at("smallest_shown")};
}

/// Describes each entry of frontier.json, in its order: where it is, and which member it has.
static void each_entry(auto& h, auto&& entry) {
  entry("/key", h.key);
  entry("/version", h.version);
  entry("/scene", h.scene);
  entry("/radar", h.radar);
  entry("/view", h.view);
  entry("/cpu", h.cpu);
  entry("/threads", h.threads);
  entry("/tracer", h.tracer);
  entry("/repeats", h.repeats);
  entry("/azimuth_bins", h.azimuth_bins);
  entry("/range_bins", h.range_bins);
  entry("/azimuths_compared", h.azimuths_compared);
  entry("/buildings", h.buildings);
  entry("/scene_cell_m", h.scene_cell_m);
  entry("/against", h.against);
  entry("/truth/cell_m", h.truth_cell_m);
  entry("/truth/planes_per_bin", h.truth.planes_per_bin);
  entry("/truth/step_m", h.truth.step_m);
  entry("/truth/checked_azimuths", h.truth_check_azimuths);
  entry("/truth/checks", h.truth_checks);
}

void write_frontier_header(const std::filesystem::path& path, const FrontierHeader& header) {
  ordered_json json;
  each_entry(header,
             [&](const char* where, const auto& value) { json[ordered_json::json_pointer(where)] = value; });
  write_text(path, json.dump(2) + "\n");
}

std::optional<FrontierHeader> read_frontier_header(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const ordered_json json = ordered_json::parse(file);
    FrontierHeader header;
    each_entry(header, [&](const char* where, auto& value) {
      json.at(ordered_json::json_pointer(where)).get_to(value);
    });
    return header;
  } catch (const nlohmann::json::exception& e) {
    throw InputError(path.string() + ": found no header of a frontier (" + e.what() +
                     "); allowed: one that `obliq frontier` wrote, or --restart to begin again");
  }
}

}  // namespace obliq
