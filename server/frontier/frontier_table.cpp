#include "server/frontier/frontier_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {

namespace {

struct Column {
  std::string_view name;
  double FrontierRow::*value;
};

constexpr std::array kColumns{
    Column{"frame_ms", &FrontierRow::frame_ms},
    Column{"frame_median_ms", &FrontierRow::frame_median_ms},
    Column{"bare_ms", &FrontierRow::bare_ms},
    Column{"bare_median_ms", &FrontierRow::bare_median_ms},
    Column{"processor_ms", &FrontierRow::processor_ms},
    Column{"rays", &FrontierRow::rays},
    Column{"samples", &FrontierRow::samples},
    Column{"power_error", &FrontierRow::power_error},
    Column{"median_db", &FrontierRow::median_db},
    Column{"percentile95_db", &FrontierRow::percentile95_db},
    Column{"mean_relative", &FrontierRow::mean_relative},
    Column{"energy_error", &FrontierRow::energy_error},
    Column{"bins", &FrontierRow::bins},
    Column{"lit", &FrontierRow::lit},
    Column{"dark", &FrontierRow::dark},
    Column{"dont_care", &FrontierRow::dont_care},
    Column{"gaps", &FrontierRow::gaps},
    Column{"gap_fraction", &FrontierRow::gap_fraction},
    Column{"false_light", &FrontierRow::false_light},
    Column{"false_light_fraction", &FrontierRow::false_light_fraction},
    Column{"false_light_energy", &FrontierRow::false_light_energy},
    Column{"buildings_visible", &FrontierRow::buildings_visible},
    Column{"buildings_missed", &FrontierRow::buildings_missed},
    Column{"load", &FrontierRow::load},
};
constexpr std::string_view kCaseColumns = "kind,columns,rows,plates,sub_columns,cell_m,returns";
constexpr std::size_t kCaseFields = 7;
constexpr std::size_t kFields = kCaseFields + kColumns.size() + 1;

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
  for (std::size_t k = 0; k < kColumns.size(); ++k) {
    const auto value = number_of(fields[kCaseFields + k]);
    if (!value) return std::nullopt;
    row.*kColumns[k].value = *value;
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
    const ReturnErrors& errors = measured.errors[static_cast<int>(returns)];
    const BinErrors& e = errors.bins;
    const auto count = [](std::uint64_t n) { return static_cast<double>(n); };
    FrontierRow row;
    row.sampling = sampling;
    row.returns = returns;
    row.frame_ms = measured.all_planes.least_s * 1000;
    row.frame_median_ms = measured.all_planes.median_s * 1000;
    row.bare_ms = measured.no_states.least_s * 1000;
    row.bare_median_ms = measured.no_states.median_s * 1000;
    row.processor_ms = measured.all_planes.processor_s * 1000;
    row.rays = count(measured.stats.rays);
    row.samples = count(measured.stats.samples);
    row.power_error = e.power_error;
    row.median_db = e.median_db;
    row.percentile95_db = e.percentile95_db;
    row.mean_relative = e.mean_relative;
    row.energy_error = e.energy_error();
    row.bins = count(e.bins);
    row.lit = count(e.lit);
    row.dark = count(e.dark);
    row.dont_care = count(e.dont_care);
    row.gaps = count(e.gaps);
    row.gap_fraction = e.gap_fraction();
    row.false_light = count(e.false_light);
    row.false_light_fraction = e.false_light_fraction();
    row.false_light_energy = e.false_light_energy();
    row.buildings_visible = errors.buildings.visible;
    row.buildings_missed = errors.buildings.missed;
    row.load = load;
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

std::vector<PaperComparison> compare_with_paper(const std::vector<FrontierRow>& rows, double scene_cell_m,
                                                Returns returns) {
  const FrontierRow* paper = find_row(rows, paper_sampling(scene_cell_m), returns);
  if (paper == nullptr || !paper->possible()) return {};
  const auto compared = [&](const FrontierRow& row) {
    const auto ratio = [](double theirs, double ours) { return ours > 0 ? theirs / ours : 0; };
    return PaperComparison{row, ratio(paper->frame_ms, row.frame_ms),
                           ratio(paper->power_error, row.power_error),
                           ratio(paper->gap_fraction, row.gap_fraction)};
  };
  std::vector<PaperComparison> table{compared(*paper)};
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    const FrontierRow* best = nullptr;
    const auto late = [&](const FrontierRow& row) { return row.frame_ms > paper->frame_ms; };
    for (const FrontierRow& row : rows) {
      if (!row.possible() || row.returns != returns || row.sampling.kind != kind ||
          row.sampling.cell_m != scene_cell_m)
        continue;
      const bool better = best == nullptr            ? true
                          : late(row) != late(*best) ? late(*best)
                          : late(row)                ? row.frame_ms < best->frame_ms
                                                     : row.power_error < best->power_error;
      if (better) best = &row;
    }
    if (best != nullptr && best != paper) table.push_back(compared(*best));
  }
  return table;
}

using nlohmann::ordered_json;

void write_frontier_header(const std::filesystem::path& path, const FrontierHeader& h) {
  ordered_json checks = ordered_json::array();
  for (const TruthCheck& check : h.truth_checks)
    checks.push_back({{"measure", check.measure},
                      {"truth", check.own},
                      {"smallest_shown", check.smallest},
                      {"holds", check.holds()}});
  const ordered_json json = {
      {"key", h.key},
      {"version", h.version},
      {"scene", h.scene},
      {"radar", h.radar},
      {"view", h.view},
      {"cpu", h.cpu},
      {"threads", h.threads},
      {"tracer", h.tracer},
      {"repeats", h.repeats},
      {"azimuth_bins", h.azimuth_bins},
      {"range_bins", h.range_bins},
      {"azimuths_compared", h.azimuths_compared},
      {"buildings", h.buildings},
      {"scene_cell_m", h.scene_cell_m},
      {"against", h.against == Against::truth ? "truth" : "reference"},
      {"truth",
       {{"cell_m", h.truth_cell_m},
        {"planes_per_bin", h.truth.planes_per_bin},
        {"step_m", h.truth.step_m},
        {"checked_azimuths", h.truth_check_azimuths},
        {"checks", checks}}},
  };
  // Renamed into place, so that a run that is cut off leaves the old one or the new one.
  const std::filesystem::path fresh = path.string() + ".new";
  std::ofstream file(fresh);
  file << json.dump(2) << '\n';
  file.close();
  std::error_code failed;
  if (file) std::filesystem::rename(fresh, path, failed);
  if (!file || failed) throw InputError(path.string() + ": cannot be written (disk full?)");
}

std::optional<FrontierHeader> read_frontier_header(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const ordered_json json = ordered_json::parse(file);
    FrontierHeader h;
    json.at("key").get_to(h.key);
    json.at("version").get_to(h.version);
    json.at("scene").get_to(h.scene);
    json.at("radar").get_to(h.radar);
    json.at("view").get_to(h.view);
    json.at("cpu").get_to(h.cpu);
    json.at("threads").get_to(h.threads);
    json.at("tracer").get_to(h.tracer);
    json.at("repeats").get_to(h.repeats);
    json.at("azimuth_bins").get_to(h.azimuth_bins);
    json.at("range_bins").get_to(h.range_bins);
    json.at("azimuths_compared").get_to(h.azimuths_compared);
    json.at("buildings").get_to(h.buildings);
    json.at("scene_cell_m").get_to(h.scene_cell_m);
    h.against = json.at("against") == "reference" ? Against::reference : Against::truth;
    const ordered_json& truth = json.at("truth");
    truth.at("cell_m").get_to(h.truth_cell_m);
    truth.at("planes_per_bin").get_to(h.truth.planes_per_bin);
    truth.at("step_m").get_to(h.truth.step_m);
    truth.at("checked_azimuths").get_to(h.truth_check_azimuths);
    for (const ordered_json& check : truth.at("checks"))
      h.truth_checks.push_back({check.at("measure"), check.at("truth"), check.at("smallest_shown")});
    return h;
  } catch (const nlohmann::json::exception& e) {
    throw InputError(path.string() + ": found no header of a frontier (" + e.what() +
                     "); allowed: one that `obliq frontier` wrote, or --restart to begin again");
  }
}

}  // namespace obliq
