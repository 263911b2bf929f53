#include "server/ground_query/question.h"

#include <fmt/core.h>

namespace obliq {
namespace {

/// Slant ranges reach no farther than radar.r_max_m may (server/control/PARAMETERS.md).
constexpr double kMostRange_m = 1e6;
constexpr double kLeastRange_m = 1e-3;

struct Column {
  const char* name;
  double low, high;
  const std::vector<double>& values;
};

/// The first value out of its limits. NaN is within none.
void check_values(const Column& column, std::vector<FieldError>& faults) {
  for (std::size_t k = 0; k < column.values.size(); ++k) {
    const double value = column.values[k];
    if (value >= column.low && value <= column.high) continue;
    faults.push_back({fmt::format("{}[{}]", column.name, k), fmt::format("{}", value),
                      fmt::format("{} to {}", column.low, column.high)});
    return;
  }
}

void check_as_many(const Column& column, std::size_t points, std::vector<FieldError>& faults) {
  if (column.values.size() != points)
    faults.push_back({column.name, fmt::format("{} values", column.values.size()),
                      fmt::format("as many as there are points, which is {}", points)});
}

}  // namespace

std::vector<FieldError> faults_of(const GroundQuestion& question) {
  std::vector<FieldError> faults;
  const Column columns[] = {{"latitude_deg", -90, 90, question.latitude_deg},
                            {"longitude_deg", -180, 180, question.longitude_deg},
                            {"bearing_deg", -360, 360, question.bearing_deg},
                            {"range_m", kLeastRange_m, kMostRange_m, question.range_m},
                            {"height_m", -1000, 100000, question.height_m}};
  const bool geodetic = !question.latitude_deg.empty() || !question.longitude_deg.empty();
  if (geodetic && question.by_bearing()) {
    faults.push_back({"bearing_deg", "places by bearing and range and by latitude and longitude",
                      "one of the two in a query"});
    return faults;
  }
  if (!geodetic && !question.by_bearing()) {
    faults.push_back({"latitude_deg", "no point",
                      "latitude_deg and longitude_deg, or bearing_deg and range_m, "
                      "of at least one point"});
    return faults;
  }
  const std::size_t points = question.points();
  check_as_many(question.by_bearing() ? columns[3] : columns[1], points, faults);
  if (question.height_m.size() > 1) check_as_many(columns[4], points, faults);
  for (const Column& column : columns) check_values(column, faults);
  if (!(question.geoid_undulation_m >= -120 && question.geoid_undulation_m <= 120))
    faults.push_back({"geoid_undulation_m", fmt::format("{}", question.geoid_undulation_m), "-120 to 120"});
  if (question.by_bearing() && !question.antenna)
    faults.push_back({"radar", "none", "a radar or an antenna: bearings and ranges are counted from it"});
  return faults;
}

}  // namespace obliq
