#include "server/output/describe_load.h"

#include <algorithm>
#include <span>
#include <vector>

#include "proto/obliq.pb.h"

namespace obliq {
namespace {

constexpr std::size_t kMostEntries = 50;
constexpr std::size_t kLongestText = 500;

template <typename T>
std::span<const T> first_of(const std::vector<T>& all) {
  return std::span(all).first(std::min(all.size(), kMostEntries));
}

std::string cut(const std::string& text) {
  return text.size() <= kLongestText ? text : text.substr(0, kLongestText) + "...";
}

}  // namespace

void describe_load(const LoadReport& report, wire::FrameDescriptor& descriptor) {
  wire::LoadedGround& ground = *descriptor.mutable_ground();
  ground.set_lowest_m(report.lowest_m);
  ground.set_highest_m(report.highest_m);
  ground.set_water_km2(report.water_m2 / 1e6);
  for (const ElevationSource& source : first_of(report.elevation)) {
    wire::ElevationModel& row = *ground.add_elevation();
    row.set_file(cut(source.file));
    row.set_unit(cut(source.unit));
    row.set_unit_assumed(source.unit_assumed);
  }
  for (const BuildingHeights& source : first_of(report.building_heights)) {
    wire::BuildingHeights& row = *ground.add_building_heights();
    row.set_file(cut(source.file));
    row.set_field(cut(source.field));
    row.set_unit(source.unit);
    row.set_found(source.found);
    row.set_least_m(source.least_m);
    row.set_median_m(source.median_m);
    row.set_most_m(source.most_m);
    row.set_by_default(source.by_default);
    row.set_default_m(source.default_m);
  }
  for (const std::string& warning : first_of(report.warnings)) descriptor.add_warnings(cut(warning));
}

}  // namespace obliq
