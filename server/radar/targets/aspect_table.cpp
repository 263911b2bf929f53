#include "server/radar/targets/aspect_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "terrain/base/csv_rows.h"

namespace obliq {
namespace {

constexpr double kMost_dbsm = 100;

/// Where a value lies among rising ones: before which, and how far towards the next.
struct Between {
  std::size_t first = 0, second = 0;
  double share = 0;
};

Between between(const std::vector<double>& rising, double value) {
  if (value <= rising.front()) return {0, 0, 0};
  if (value >= rising.back()) return {rising.size() - 1, rising.size() - 1, 0};
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(rising, value) - rising.begin());
  return {above - 1, above, (value - rising[above - 1]) / (rising[above] - rising[above - 1])};
}

}  // namespace

AspectTable AspectTable::read(const std::filesystem::path& file) {
  CsvRows rows(file, "rcs_file", "aspect_deg,elevation_deg,rcs_dbsm");
  std::map<std::pair<double, double>, double> values;
  std::set<double> aspects, elevations;
  double greatest_deg = 0, least_deg = 0;
  while (rows.next()) {
    const double given_deg = rows.number(0, -360, 360);
    const double elevation_deg = rows.number(1, -90, 90);
    greatest_deg = std::max(greatest_deg, given_deg);
    least_deg = std::min(least_deg, given_deg);
    const double aspect_deg = given_deg < 0 ? given_deg + 360 : given_deg == 360 ? 0 : given_deg;
    const double rcs_dbsm = rows.number(2, -kMost_dbsm, kMost_dbsm);
    const auto [at, is_new] = values.try_emplace({aspect_deg, elevation_deg}, rcs_dbsm);
    // 360 may repeat 0, and 180 -180.
    if (!is_new && at->second != rcs_dbsm)
      rows.refuse("aspect " + rows.cell(0) + " and elevation " + rows.cell(1) + " again, with another value",
                  "each once");
    aspects.insert(aspect_deg);
    elevations.insert(elevation_deg);
  }
  if (values.empty()) rows.refuse("no rows", "a row for each aspect and elevation");
  if (values.size() != aspects.size() * elevations.size())
    rows.refuse(std::to_string(values.size()) + " rows of " + std::to_string(aspects.size()) +
                    " aspects and " + std::to_string(elevations.size()) + " elevations",
                "each aspect with each elevation: " + std::to_string(aspects.size() * elevations.size()));
  AspectTable table;
  table.path_ = file;
  table.aspect_deg_.assign(aspects.begin(), aspects.end());
  table.elevation_deg_.assign(elevations.begin(), elevations.end());
  table.both_sides_ = least_deg >= 0 && greatest_deg <= 180;
  double sum_m2 = 0;
  for (const auto& [at, rcs_dbsm] : values) {  // in the order of aspect, then elevation
    table.rcs_dbsm_.push_back(rcs_dbsm);
    table.all_positive_ &= rcs_dbsm >= 0;
    sum_m2 += std::pow(10.0, rcs_dbsm / 10);
  }
  table.mean_dbsm_ = 10 * std::log10(sum_m2 / static_cast<double>(values.size()));
  return table;
}

double AspectTable::rcs_dbsm(double aspect_deg, double elevation_deg) const {
  double around_deg = aspect_deg - 360 * std::floor(aspect_deg / 360);
  if (both_sides_ && around_deg > 180) around_deg = 360 - around_deg;
  Between aspect = between(aspect_deg_, around_deg);
  if (!both_sides_ && aspect.first == aspect.second && aspect_deg_.size() > 1) {
    // Across the nose, from the last to the first.
    const double last_deg = aspect_deg_.back(), gap_deg = aspect_deg_.front() + 360 - last_deg;
    const double past_deg = around_deg >= last_deg ? around_deg - last_deg : around_deg + 360 - last_deg;
    aspect = {aspect_deg_.size() - 1, 0, gap_deg > 0 ? past_deg / gap_deg : 0};
  }
  const Between elevation = between(elevation_deg_, elevation_deg);
  const std::size_t n = elevation_deg_.size();
  const auto of_aspect = [&](std::size_t k) {
    const double low = rcs_dbsm_[k * n + elevation.first], high = rcs_dbsm_[k * n + elevation.second];
    return low + elevation.share * (high - low);
  };
  const double first = of_aspect(aspect.first), second = of_aspect(aspect.second);
  return first + aspect.share * (second - first);
}

}  // namespace obliq
