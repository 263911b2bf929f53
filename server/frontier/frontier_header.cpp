#include "server/frontier/frontier_header.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "terrain/base/errors.h"

namespace obliq {

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
