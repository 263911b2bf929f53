// The feet of a part's walls in the sub-columns of an azimuth bin.
#include <algorithm>
#include <cmath>

#include "server/radar/sweep/corner_view.h"

namespace obliq {
namespace {

/// An edge of a part in the bin's axes.
struct Edge {
  double right_m, ahead_m;  ///< where it begins
  double dr, da;            ///< how far it goes
  double from, to;          ///< tangents of its ends, in rising order

  Edge(const ConvexShape& part, int e)
      : right_m(static_cast<double>(part.right_m[e])),
        ahead_m(static_cast<double>(part.ahead_m[e])),
        dr(static_cast<double>(part.right_m[e + 1]) - right_m),
        da(static_cast<double>(part.ahead_m[e + 1]) - ahead_m),
        from(static_cast<double>(std::min(part.tangent[e], part.tangent[e + 1]))),
        to(static_cast<double>(std::max(part.tangent[e], part.tangent[e + 1]))) {}

  /// Above 0 where it faces the antenna.
  double cross() const { return ahead_m * dr - right_m * da; }
  double nearest_m() const { return std::min(ahead_m, ahead_m + da); }
  double ahead_at(double tangent) const {
    return std::clamp(cross() / (dr - tangent * da), nearest_m(), nearest_m() + std::abs(da));
  }
  /// Least sine of the angle between the wall's normal and the sight, between two tangents.
  double least_along(double low, double high) const {
    const double at_low = dr * low + da;
    const double at_high = dr * high + da;
    if (!(at_low * at_high > 0)) return 0;
    return std::min(std::abs(at_low), std::abs(at_high)) / std::sqrt(dr * dr + da * da);
  }
};

}  // namespace

void CornerView::see(const Columns& columns, const ConvexShape& part, const std::uint32_t* faces,
                     std::uint8_t material) {
  const SubColumns& all = columns.all;
  const auto left = static_cast<double>(all.left);
  const auto width = static_cast<double>(all.width);
  // The base lies below all ground there: from above it no foot is seen at a smaller angle.
  const auto base_m = static_cast<double>(part.base_m);
  if (!(base_m < 0)) return;
  for (int e = 0; e < part.n; ++e) {
    const Edge edge(part, e);
    if ((part.walls >> e & 1) == 0 || !(edge.cross() > 0)) continue;
    const double from = std::max(edge.from, left);
    const double to = std::min(edge.to, left + all.n * width);
    if (!(from < to) || !table_->may_shine(edge.least_along(from, to) * edge.nearest_m() / base_m)) continue;
    // The lobe is narrow: by corners in double.
    const glm::dvec3& antenna = plan_.sector().antenna_m;
    const WallPlane plane = wall_plane(plan_.scene().world().buildings, faces[e], antenna.x, antenna.z);
    Foot foot{};
    foot.face = faces[e];
    foot.material = material;
    foot.normal_x = plane.normal_x;
    foot.normal_z = plane.normal_z;
    foot.roof_m = static_cast<double>(part.roof_m);
    const auto column_of = [&](double tangent) {
      return std::clamp(static_cast<int>((tangent - left) / width), 0, all.n - 1);
    };
    for (int column = column_of(from); column <= column_of(to); ++column)
      see_foot(columns, part, e, column, foot);
  }
}

/// The foot of a wall in one sub-column.
void CornerView::see_foot(const Columns& columns, const ConvexShape& part, int e, int column, Foot foot) {
  const SubColumns& all = columns.all;
  const Edge edge(part, e);
  const auto width = static_cast<double>(all.width);
  const double left = static_cast<double>(all.left) + column * width;
  const double from = std::max(edge.from, left);
  const double to = std::min(edge.to, left + width);
  if (!(from < to)) return;
  const double tangent = (from + to) / 2;
  const double secant = std::sqrt(1 + tangent * tangent);
  const SinCos& centre = columns.centre;
  foot.distance_m = edge.ahead_at(tangent) * secant;
  foot.left_m = edge.ahead_at(from) * secant;
  foot.right_m = edge.ahead_at(to) * secant;
  foot.bearing = {(centre.sin + tangent * centre.cos) / secant, (centre.cos - tangent * centre.sin) / secant};
  foot.width_rad = (to - from) / width * static_cast<double>(all.width_rad);
  foot.shade = static_cast<double>(all.roofs[column]);
  foot.plane = column * all.nodes.planes >> all.log2_n;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double ground_y_m = plan_.scene().world().grid.height_at_m(
      antenna.x + foot.distance_m * foot.bearing.sin, antenna.z + foot.distance_m * foot.bearing.cos);
  if (std::isnan(ground_y_m)) return;
  foot.ground_m = std::max(ground_y_m - antenna.y, static_cast<double>(part.base_m));
  add(foot, all.nodes);
}

}  // namespace obliq
