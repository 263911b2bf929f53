// The feet of a part's walls in the sub-columns of an azimuth bin.
#include <algorithm>
#include <cmath>

#include "server/radar/simd/kernels.h"
#include "server/radar/sweep/corner_view.h"

namespace obliq {

std::uint64_t CornerView::square_walls(const Columns& columns, const ConvexShape& part, float near_m,
                                       float from, float to) const {
  // The base lies below all ground there: no foot is seen at a greater depression.
  if (!(part.base_m < 0)) return 0;
  const float low = std::max(from, columns.all.left);
  const float high = std::min(to, columns.all.left + static_cast<float>(columns.all.n) * columns.all.width);
  const float limit = static_cast<float>(table_->greatest_along()) * -part.base_m / near_m + (high - low) / 2;
  return active_kernels().square_walls(part, (low + high) / 2, limit * limit);
}

void CornerView::see(const Columns& columns, const ConvexShape& part, int e, const Wall& wall) {
  const SubColumns& all = columns.all;
  const auto left = static_cast<double>(all.left);
  const auto width = static_cast<double>(all.width);
  const double per_width = 1 / width;
  const auto t0 = static_cast<double>(part.tangent[e]);
  const auto t1 = static_cast<double>(part.tangent[e + 1]);
  const double from = std::max(std::min(t0, t1), left);
  const double to = std::min(std::max(t0, t1), left + all.n * width);
  if (!(from < to)) return;
  // The lobe is narrow: by corners in double.
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const WallLine line = wall_line(world.buildings, wall.building, wall.face, antenna.x, antenna.z);
  const SinCos& centre = columns.centre;
  const double across = line.normal_x * centre.sin + line.normal_z * centre.cos;
  const double along = line.normal_x * centre.cos - line.normal_z * centre.sin;
  const auto secant_of = [](double tangent) { return std::sqrt(1 + tangent * tangent); };
  // How far ahead the wall stands, kept between its ends.
  const auto [nearest, farthest] = std::minmax(part.ahead_m[e], part.ahead_m[e + 1]);
  const auto near_m = static_cast<double>(nearest), far_m = static_cast<double>(farthest);
  const auto ahead_at = [&](double tangent) {
    return std::clamp(-line.distance_m / (across + tangent * along), near_m, far_m);
  };
  const double tangent = (from + to) / 2;
  const double secant = secant_of(tangent);
  const double cosine = 1 / secant;
  Foot foot{};
  foot.building = wall.building;
  foot.face = wall.face;
  foot.material = wall.material;
  foot.normal_x = line.normal_x;
  foot.normal_z = line.normal_z;
  foot.bearing = {(centre.sin + tangent * centre.cos) * cosine, (centre.cos - tangent * centre.sin) * cosine};
  foot.width_rad = (to - from) * per_width * static_cast<double>(all.width_rad);
  foot.distance_m = ahead_at(tangent) * secant;
  const double ground_y_m = world.grid.height_at_m(antenna.x + foot.distance_m * foot.bearing.sin,
                                                   antenna.z + foot.distance_m * foot.bearing.cos);
  if (std::isnan(ground_y_m)) return;
  foot.ground_m = std::max(ground_y_m - antenna.y, static_cast<double>(part.base_m));
  foot.roof_m = static_cast<double>(part.roof_m);
  const auto column_of = [&](double t) {
    return std::clamp(static_cast<int>((t - left) * per_width), 0, all.n - 1);
  };
  foot.plane = plane_of(column_of(tangent), all.nodes.planes, all.n);
  const auto [least, greatest] =
      std::minmax_element(all.shades + column_of(from), all.shades + column_of(to) + 1);
  if (-static_cast<double>(*least) * foot.distance_m <= -foot.ground_m || !begin(foot, all.nodes)) return;
  spread(ahead_at(from) * secant_of(from), ahead_at(to) * secant_of(to));
  if (is_whole(static_cast<double>(*greatest))) return light(0, 1, static_cast<double>(*greatest));
  // Neighbours that leave all of the light are one stretch.
  const int last = column_of(to);
  const auto shade_at = [&](int column) { return static_cast<double>(all.shades[column]); };
  for (int column = column_of(from), end = 0; column <= last; column = end) {
    end = column + 1;
    if (is_whole(shade_at(column)))
      while (end <= last && is_whole(shade_at(end))) ++end;
    const double begins = std::max(from, left + column * width);
    const double ends = std::min(to, left + end * width);
    if (begins < ends) light((begins - from) / (to - from), (ends - from) / (to - from), shade_at(column));
  }
}

}  // namespace obliq
