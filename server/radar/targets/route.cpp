#include "server/radar/targets/route.h"

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace obliq {

Route::Route(double latitude_deg, double longitude_deg, double height_m, RouteSpec spec)
    : spec_(std::move(spec)), start_{latitude_deg, longitude_deg, height_m, 0} {
  Place end = start_;
  const auto go_to = [&](double latitude, double longitude, double height, double speed_m_s) {
    const GeographicLib::GeodesicLine line = GeographicLib::Geodesic::WGS84().InverseLine(
        end.latitude_deg, end.longitude_deg, latitude, longitude);
    if (const double length_m = line.Distance(); length_m > 0) {
      const double lasts_s = length_m / speed_m_s;
      legs_.push_back({line, length_m, end.height_m, height, lasts_s_, lasts_s});
      lasts_s_ += lasts_s;
    }
    end = {latitude, longitude, height, 0};
  };
  for (const RoutePoint& point : spec_.points)
    go_to(point.latitude_deg, point.longitude_deg, point.height_m.value_or(height_m), point.speed_m_s);
  if (spec_.loops && !spec_.points.empty())
    go_to(latitude_deg, longitude_deg, height_m, spec_.points.back().speed_m_s);
}

Route::Place Route::at(double age_s) const {
  if (legs_.empty()) return start_;
  double t_s = std::max(age_s, 0.0);
  if (spec_.loops) t_s = std::fmod(t_s, lasts_s_);
  const auto next = std::ranges::upper_bound(legs_, t_s, {}, &Leg::begins_s);
  const Leg& leg = next == legs_.begin() ? legs_.front() : *std::prev(next);
  const double share = std::min((t_s - leg.begins_s) / leg.lasts_s, 1.0);
  Place place;
  leg.line.Position(share * leg.length_m, place.latitude_deg, place.longitude_deg, place.course_deg);
  place.height_m = leg.from_height_m + share * (leg.to_height_m - leg.from_height_m);
  return place;
}

}  // namespace obliq
