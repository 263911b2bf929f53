#include "server/radar/echo/foot_corner.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/line_to_point.h"
#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"
#include "terrain/ground_slope.h"

namespace obliq {
namespace {

constexpr int kAFoot = 200;  // in units of ask()

/// So far before a foot the ground is looked at: a wall of 8 m at a grazing angle of 0.5 degrees.
constexpr double kFarthest_m = 1000;

}  // namespace

FootCorner::FootCorner(const ScenePlan& plan, const CornerTable& corners)
    : plan_(plan), table_(corners), surface_(plan.scene().world(), plan.sector().antenna_m) {}

std::optional<FootCorner::Corner> FootCorner::at(std::uint32_t wall, double x_m, double z_m) {
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const Building& building = world.buildings.list[world.buildings.building_of_face[wall]];
  if (wall == building.first_face) return std::nullopt;  // a roof
  const WallPlane plane = wall_plane(world.buildings, wall, antenna.x, antenna.z);
  const double about_m = std::hypot(x_m - antenna.x, z_m - antenna.z);
  if (!(plane.distance_m > 0 && about_m > kNearest_m)) return std::nullopt;
  bearing_ = {(x_m - antenna.x) / about_m, (z_m - antenna.z) / about_m};
  const double across = -(plane.normal_x * bearing_.sin + plane.normal_z * bearing_.cos);
  const double along = plane.normal_x * bearing_.cos - plane.normal_z * bearing_.sin;
  // Samples lie on the wall but for rounding.
  const double distance_m = plane.distance_m / across;
  if (!(across > 0 && std::abs(distance_m - about_m) < 1)) return std::nullopt;
  const double base_m = static_cast<double>(building.base_y_m) - antenna.y;
  if (!(base_m < 0 && std::abs(along) * distance_m <= -base_m * table_.greatest_along())) return std::nullopt;
  const double foot_x_m = antenna.x + distance_m * bearing_.sin;
  const double foot_z_m = antenna.z + distance_m * bearing_.cos;
  const double ground_y_m = world.grid.height_at_m(foot_x_m, foot_z_m);
  if (std::isnan(ground_y_m)) return std::nullopt;
  const double ground_m = std::max(ground_y_m - antenna.y, base_m);
  const double roof_m = static_cast<double>(building.roof_y_m) - antenna.y;
  if (!(ground_m < 0 && ground_m < roof_m)) return std::nullopt;
  ask(kAFoot);
  const glm::dvec3 foot_m(foot_x_m, antenna.y + ground_m, foot_z_m);
  if (!is_lit(foot_m)) return std::nullopt;
  const double per_rad = strip_sum(plane, building.material, distance_m, ground_m, roof_m);
  if (!(per_rad > 0)) return std::nullopt;
  const double range_m = std::hypot(distance_m, ground_m);
  const double sines = roof_m / std::hypot(distance_m, roof_m) - ground_m / range_m;
  return Corner{per_rad / sines, range_m, foot_m};
}

bool FootCorner::is_lit(const glm::dvec3& foot_m) const {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const Obstacle highest = highest_before(plan_.scene(), antenna, foot_m);
  if (!(highest.d_m > 0)) return true;
  const double distance_m = std::hypot(foot_m.x - antenna.x, foot_m.z - antenna.z);
  return highest.h_m / highest.d_m * distance_m - (foot_m.y - antenna.y) <= kOnSurface_m;
}

/// Turns the surface to the foot, with the roofs over the last stretch before it.
void FootCorner::aim(const glm::dvec3& foot_m, double distance_m, double reach_m) {
  const Scene& scene = plan_.scene();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  near_.clear();
  spans_.clear();
  const double from_m = std::max(0.0, distance_m - reach_m);
  scene.building_index().along({antenna.x + from_m * bearing_.sin, antenna.z + from_m * bearing_.cos},
                               {foot_m.x, foot_m.z}, near_);
  for (const std::uint32_t b : near_)
    add_roof_spans(scene.world().buildings, b, antenna.x, antenna.z, bearing_.sin, bearing_.cos, spans_);
  spans_ = disjoint_roofs(spans_);
  surface_.aim(bearing_.sin, bearing_.cos, spans_);
}

/// What the ground before the foot returns for a radian of azimuth: of each lit piece of it, as far as the
/// ray that it mirrors meets the wall below its roof.
double FootCorner::strip_sum(const WallPlane& wall, std::uint8_t material, double distance_m, double ground_m,
                             double roof_m) {
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const double down = -ground_m / distance_m;
  const double level = 1 / std::sqrt(1 + down * down);
  const double across = -(wall.normal_x * bearing_.sin + wall.normal_z * bearing_.cos);
  const double along = wall.normal_x * bearing_.cos - wall.normal_z * bearing_.sin;
  const double reach_m = std::min({4 * (roof_m - ground_m) / down, kFarthest_m, distance_m});
  aim({antenna.x + distance_m * bearing_.sin, 0, antenna.z + distance_m * bearing_.cos}, distance_m, reach_m);
  visible_.clear();
  surface_.walk_in({distance_m, ground_m, -down}, -HUGE_VAL, distance_m - reach_m, visible_);
  // What takes part lies before the foot in the direction that the wall mirrors.
  const double mirrored_x = 2 * across * wall.normal_x + bearing_.sin;
  const double mirrored_z = 2 * across * wall.normal_z + bearing_.cos;
  const auto place = [&](double before_m) {
    return glm::dvec2(antenna.x + distance_m * bearing_.sin + before_m * mirrored_x,
                      antenna.z + distance_m * bearing_.cos + before_m * mirrored_z);
  };
  double sum = 0;
  double lit_m = 0;
  for (const SurfaceSegment& piece : visible_) {
    const double from_m = distance_m - piece.far_d_m;
    if (piece.near_d_m > distance_m - kTouching_m) continue;  // the wall itself
    // What is lit behind a shadow, or beyond a roof, is not before this foot.
    if (piece.face != kNoFace || from_m > lit_m + kTouching_m) break;
    lit_m = distance_m - piece.near_d_m;
    const glm::dvec2 middle = place((from_m + lit_m) / 2);
    const GroundSlope slope = ground_slope_at(world.grid, middle.x, middle.y);
    if (!slope.known) break;
    const double gain = slope.per_x * mirrored_x + slope.per_z * mirrored_z;
    const double at_middle_m = slope.y_m - antenna.y;
    // As far as the ray between the ground and the antenna's image meets the wall below the roof:
    // h D / (D + before) is that height.
    const auto room_m = [&](double before_m) {
      const double h = at_middle_m + gain * (before_m - (from_m + lit_m) / 2);
      return roof_m * (1 + before_m / distance_m) - h;
    };
    if (!(room_m(from_m) > 0)) break;
    const bool last = room_m(lit_m) < 0;
    const double to_m =
        last ? from_m + room_m(from_m) / (room_m(from_m) - room_m(lit_m)) * (lit_m - from_m) : lit_m;
    const double before = (from_m + to_m) / 2 / distance_m;
    const double down_there = -(at_middle_m + gain * (to_m - lit_m) / 2) / distance_m;
    const CornerSight sight = CornerSight::over_ground(across, along, level, before, down_there);
    const FootSlope of_wall{slope.per_x * wall.normal_x + slope.per_z * wall.normal_z,
                            slope.per_x * wall.normal_z - slope.per_z * wall.normal_x};
    // Rays spread on their way from the wall over the strip.
    const double area_m2 = distance_m * (1 + before) * (to_m - from_m) *
                           std::sqrt(1 + slope.per_x * slope.per_x + slope.per_z * slope.per_z);
    const std::uint8_t ground = world.material_of_cell(slope.i, slope.j);
    if (const double lobe = table_.lobe(ground, sight, of_wall); lobe > 0)
      sum += lobe * area_m2 * table_.reflectivity(material, ground, sight.across);
    if (last) break;
  }
  return sum;
}

}  // namespace obliq
