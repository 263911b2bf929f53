#include "terrain/buildings/footprint_heights.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "terrain/base/units.h"
#include "terrain/buildings/height_text.h"

namespace obliq {
namespace {

/// Half of the buildings of a town are houses of one or two storeys. Only the core of a large city has a
/// median above this: 9 m in San Francisco, 5 m in Venice, Los Angeles, in the outlines that we tried, which
/// read as feet would be 30 and 17.
constexpr double kTallMedian_m = 14;
constexpr std::size_t kManyBuildings = 100;

bool sane(std::optional<double> height_m) { return height_m && *height_m > 0 && *height_m <= kTallest_m; }

bool ends_in_feet(std::string name) {
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.ends_with("ft") || name.ends_with("feet") || name.ends_with("foot");
}

std::string shorter(const std::string& text) {
  constexpr std::size_t kMost = 40;
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

}  // namespace

FeatureHeight feature_height(const VectorFeature& feature, const BuildingSourceSpec& spec) {
  FeatureHeight result;
  const auto read = [&](const std::string& field, double metres_per_bare_unit) {
    const std::optional<std::string> text = feature.text(field);
    if (!text || text->empty()) return false;
    const std::optional<double> height_m = parse_height_m(*text, metres_per_bare_unit);
    if (sane(height_m)) {
      result.height_m = height_m;
    } else if (result.refused.empty()) {
      result.refused = *text;
    }
    return result.height_m.has_value();
  };
  if (read(spec.height_field, spec.unit == "ft" ? kFoot_m : 1.0)) return result;
  if (spec.height_field != "height" && read("height", 1.0)) return result;
  read("building:levels", kStorey_m);
  return result;
}

void SourceHeights::add(const FeatureHeight& height, std::int64_t feature) {
  if (height.height_m) {
    heights_m_.push_back(*height.height_m);
    return;
  }
  ++by_default_;
  if (height.refused.empty()) return;
  if (refused_++ == 0) first_refused_ = fmt::format("\"{}\" of feature {}", shorter(height.refused), feature);
}

void SourceHeights::report(LoadReport& report) const {
  BuildingHeights found{file_name(spec_.source), spec_.height_field, spec_.unit == "ft" ? "ft" : "m",
                        heights_m_.size()};
  found.by_default = by_default_;
  found.default_m = spec_.default_height_m;
  if (!heights_m_.empty()) {
    std::vector<double> sorted = heights_m_;
    std::ranges::sort(sorted);
    found.least_m = sorted.front();
    found.median_m = sorted[sorted.size() / 2];
    found.most_m = sorted.back();
  }
  if (refused_ > 0) {
    const std::string became =
        fmt::format(" became {:g} m (default_height_m), the first is ", spec_.default_height_m);
    report.warnings.push_back(fmt::format(
        "[[buildings]] {}: {}{}{}{}; allowed: more than 0, at most 2000 m", file_name(spec_.source), refused_,
        refused_ == 1 ? " height was refused and" : " heights were refused and", became, first_refused_));
  }
  warn_of_feet(found, report);
  report.building_heights.push_back(std::move(found));
}

void SourceHeights::warn_of_feet(const BuildingHeights& found, LoadReport& report) const {
  if (spec_.unit == "ft" || found.found == 0) return;
  const bool by_name = ends_in_feet(spec_.height_field);
  // Who writes unit = "m" has looked.
  const bool by_size = spec_.unit.empty() && found.found >= kManyBuildings && found.median_m > kTallMedian_m;
  if (!by_name && !by_size) return;
  const std::string heights =
      fmt::format("heights {:.3g} to {:.4g} m, median {:.3g} m", found.least_m, found.most_m, found.median_m);
  report.warnings.push_back(fmt::format(
      "[[buildings]] {}: found {} in the field \"{}\", {}{}", file_name(spec_.source), heights, found.field,
      by_name ? "whose name says feet" : "which is tall for a town",
      spec_.unit.empty() ? ", taken as metres; if they are feet, set unit = \"ft\", else unit = \"m\""
                         : ", and unit = \"m\"; if they are feet, set unit = \"ft\""));
}

}  // namespace obliq
