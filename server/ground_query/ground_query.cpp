#include "server/ground_query/ground_query.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "proto/ground_record.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/profile/ground_walk.h"
#include "server/radar/profile/line_to_point.h"
#include "server/scene/scene.h"
#include "server/scene/tolerances.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Looks for the first ground that is so far away, outwards.
struct FindRange {
  double antenna_y_m;
  double range_m;
  double found_m = -1;
  bool too_near = false, gap_met = false, begun = false;

  void ground(const GroundSegment& segment) {
    const double start = segment.start_m - antenna_y_m;
    const auto range2 = [&](double d) {
      const double h = start + segment.rise * d;
      return d * d + h * h;
    };
    const double wanted2 = range_m * range_m;
    if (!begun && range2(segment.d0_m) > wanted2) too_near = true;
    begun = true;
    if (enough() || range2(segment.d1_m) < wanted2) return;
    // d^2 + (start + rise d)^2 = range^2, the greater root: range grows there.
    const double a = 1 + segment.rise * segment.rise;
    const double b = start * segment.rise;
    const double c = start * start - wanted2;
    found_m = std::clamp((std::sqrt(std::max(0.0, b * b - a * c)) - b) / a, segment.d0_m, segment.d1_m);
  }
  void gap(double from_m, double to_m) {
    if (!enough() && to_m - from_m > kMargin_m) gap_met = true;
  }
  bool enough() const { return found_m >= 0 || too_near || gap_met; }
};

/// Where a slant range from the antenna meets the ground in one direction.
struct PlaceAtRange {
  wire::GroundState state = wire::GroundState::known;
  WorldPoint place;  ///< where the state is known
};

/// The nearest place at a true bearing whose ground is range_m away. Buildings do not count.
PlaceAtRange place_at_range(const Scene& scene, const Pose& antenna, double bearing_deg, double range_m) {
  const HeightGrid& grid = scene.world().grid;
  const glm::dvec3& at = antenna.antenna.m;
  const double bearing = std::remainder(bearing_deg, 360.0) * kDegree_rad + antenna.north_rad;
  const double sin = std::sin(bearing), cos = std::cos(bearing);
  // No ground is higher or lower over the antenna than this, so none nearer can be so far away.
  const double most_m =
      std::max(std::abs(scene.tiles().highest_m() - at.y), std::abs(scene.tiles().lowest_m() - at.y));
  const double from_m =
      most_m < range_m ? std::sqrt((range_m - most_m) * (range_m + most_m)) * (1 - 1e-12) - kMargin_m : 0;
  const double first_m = std::max(0.0, from_m);
  GroundWalk walk(grid, at, sin, cos, first_m, range_m + kMargin_m);
  if (walk.done() || walk.at_m() > first_m + kMargin_m) return {wire::GroundState::outside, {}};
  FindRange find{at.y, range_m};
  walk.advance(range_m + kMargin_m, find);
  if (find.too_near) return {wire::GroundState::too_near, {}};
  if (find.gap_met) return {wire::GroundState::unknown, {}};
  if (find.found_m < 0) return {wire::GroundState::outside, {}};
  const double x = at.x + find.found_m * sin, z = at.z + find.found_m * cos;
  const double y = grid.height_at_m(x, z);
  if (std::isnan(y)) return {wire::GroundState::unknown, {}};  // rounded across the edge of a void
  return {wire::GroundState::known, {glm::dvec3(x, y, z)}};
}

constexpr double kHalfTurn_rad = 180 * kDegree_rad;

/// Rise of the ground's triangle at a place per metre of x and z.
glm::dvec2 ground_slope(const HeightGrid& grid, double x_m, double z_m) {
  const double u = (x_m - grid.x0_m) / grid.cell_m;
  const double v = (z_m - grid.z0_m) / grid.cell_m;
  const int i = std::min(static_cast<int>(u), grid.nx - 2);
  const int j = std::min(static_cast<int>(v), grid.nz - 2);
  const double y10 = grid.node_y_m(i + 1, j), y01 = grid.node_y_m(i, j + 1);
  const bool lower = (u - i) + (v - j) <= 1;
  const double corner = lower ? grid.node_y_m(i, j) : grid.node_y_m(i + 1, j + 1);
  return (lower ? glm::dvec2(y10 - corner, y01 - corner) : glm::dvec2(corner - y01, corner - y10)) /
         grid.cell_m;
}

int cell_of(double at_m, double first_m, double cell_m, int n) {
  return std::clamp(static_cast<int>((at_m - first_m) / cell_m), 0, n - 2);
}

bool on_grid(const HeightGrid& grid, const glm::dvec3& point) {
  return point.x >= grid.x0_m && point.x <= grid.x1_m() && point.z >= grid.z0_m && point.z <= grid.z1_m();
}

float degrees(double angle_rad) { return static_cast<float>(angle_rad / kDegree_rad); }

}  // namespace

GroundQuery::GroundQuery(const Scene& scene) : scene_(scene) {
  for (const Material& material : scene.materials()) is_water_.push_back(material.name == "water");
}

wire::GroundRecord GroundQuery::answer(double latitude_deg, double longitude_deg, const PointHeight& height,
                                       const Pose* antenna) const {
  wire::GroundRecord record;
  record.latitude_deg = latitude_deg;
  record.longitude_deg = longitude_deg;
  const World& world = scene_.world();
  const PlumbLine line(world.frame, latitude_deg * kDegree_rad, longitude_deg * kDegree_rad);
  const auto ground = line.meet(world.grid);
  if (ground) {
    describe_ground(line, *ground, record);
  } else {
    record.state =
        on_grid(world.grid, line.at_height(0)) ? wire::GroundState::unknown : wire::GroundState::outside;
  }
  switch (height.reference) {
    case HeightReference::datum:
      record.point_height_m = height.m;
      break;
    case HeightReference::ellipsoid:
      record.point_height_m = height.m - height.geoid_undulation_m;
      break;
    case HeightReference::ground:
      if (ground) record.point_height_m = ground->height_m + height.m;
      break;
  }
  if (antenna == nullptr) return record;
  if (!ground && height.reference == HeightReference::ground) {
    record.sight = wire::Sight::no_height;
  } else {
    look(line.at_height(record.point_height_m), *antenna, record);
  }
  return record;
}

wire::GroundRecord GroundQuery::answer_at_range(double bearing_deg, double range_m, const PointHeight& height,
                                                const Pose& antenna) const {
  const PlaceAtRange found = place_at_range(scene_, antenna, bearing_deg, range_m);
  if (found.state != wire::GroundState::known) {
    wire::GroundRecord record;
    record.state = found.state;
    record.sight = wire::Sight::no_height;
    return record;
  }
  const Geodetic place = scene_.world().frame.geodetic_from_world(found.place);
  return answer(place.latitude_rad / kDegree_rad, place.longitude_rad / kDegree_rad, height, &antenna);
}

void GroundQuery::describe_ground(const PlumbLine& line, const PlumbLine::Meeting& ground,
                                  wire::GroundRecord& record) const {
  const World& world = scene_.world();
  const HeightGrid& grid = world.grid;
  const glm::dvec3& at = ground.point_m;
  record.height_m = record.surface_height_m = ground.height_m;
  record.material = world.material_of_cell(cell_of(at.x, grid.x0_m, grid.cell_m, grid.nx),
                                           cell_of(at.z, grid.z0_m, grid.cell_m, grid.nz));
  // Of the height above the datum, which falls away with the earth's curvature.
  const glm::dvec2 slope =
      ground_slope(grid, at.x, at.z) - glm::dvec2(line.datum_slope_x(), line.datum_slope_z());
  const double steepness = std::sqrt(slope.x * slope.x + slope.y * slope.y);
  record.slope_deg = degrees(std::atan(steepness));
  if (steepness > 0) {
    const double downhill = std::atan2(-slope.x, -slope.y) - line.north_rad();
    record.downhill_deg = degrees(downhill < 0 ? downhill + 2 * kHalfTurn_rad : downhill);
  }
  if (const auto building = building_at(at.x, at.z)) {
    const Building& there = world.buildings.list[*building];
    const double roof_m = line.meet(static_cast<double>(there.roof_y_m)).height_m;
    record.building = *building + 1;
    if (roof_m > ground.height_m) {
      record.surface_height_m = roof_m;
      record.material = there.material;
    }
  }
  record.water = record.material < is_water_.size() && is_water_[record.material];
}

std::optional<std::uint32_t> GroundQuery::building_at(double x_m, double z_m) const {
  const Buildings& all = scene_.world().buildings;
  const BuildingCircles& circles = scene_.circles();
  std::optional<std::uint32_t> highest;
  (void)scene_.building_index().any_near(x_m, z_m, [&](std::uint32_t b) {
    const double dx = static_cast<double>(circles.x_m[b]) - x_m;
    const double dz = static_cast<double>(circles.z_m[b]) - z_m;
    const double reach = static_cast<double>(circles.radius_m[b]) + kMargin_m;
    if (dx * dx + dz * dz > reach * reach) return false;
    if ((!highest || all.list[b].roof_y_m > all.list[*highest].roof_y_m) &&
        inside_building(all, b, x_m, -HUGE_VAL, z_m, 0))
      highest = b;
    return false;
  });
  return highest;
}

void GroundQuery::look(const glm::dvec3& point_m, const Pose& antenna, wire::GroundRecord& record) const {
  const World& world = scene_.world();
  if (point_m.y < world.grid.height_at_m(point_m.x, point_m.z) - kOnSurface_m) {
    record.sight = wire::Sight::below_ground;
    return;
  }
  const auto building = building_at(point_m.x, point_m.z);
  if (building && point_m.y < static_cast<double>(world.buildings.list[*building].roof_y_m) - kOnSurface_m) {
    record.sight = wire::Sight::inside_building;
    return;
  }
  const glm::dvec3& eye = antenna.antenna.m;
  const Obstacle highest = highest_before(scene_, eye, point_m);
  const glm::dvec3 to = point_m - eye;
  const double d = std::sqrt(to.x * to.x + to.z * to.z);
  record.obstacle_range_m = static_cast<float>(highest.d_m);
  // From the obstacle's direction up to the point's; without an obstacle, from straight down.
  const double above = to.y * highest.d_m - highest.h_m * d;
  const double along = d * highest.d_m + to.y * highest.h_m;
  const double clearance = std::atan2(above, along);
  const double hidden_m =
      highest.d_m > 0 ? -above / highest.d_m : 0;  // so far above the point the line passes
  if (hidden_m > kOnSurface_m) {
    record.clearance_deg = degrees(clearance);
    record.sight = highest.building ? wire::Sight::behind_building : wire::Sight::behind_ground;
    return;
  }
  record.clearance_deg = degrees(std::max(clearance, 0.0));
  record.sight =
      passes_unknown(scene_, eye, point_m) ? wire::Sight::visible_over_unknown : wire::Sight::visible;
}

GroundAnswers answer_ground(const std::shared_ptr<const Scene>& scene, const GroundQuestion& question,
                            const std::stop_token& stop) {
  GroundAnswers answers;
  std::optional<Pose> antenna;
  if (question.antenna) {
    antenna = place_antenna(scene->world(), *question.antenna, answers.errors);
    if (!antenna) return answers;
  }
  for (const Material& material : scene->materials()) answers.materials.push_back(material.name);
  const GroundQuery query(*scene);
  for (std::size_t k = 0; k < question.points() && !stop.stop_requested(); ++k) {
    PointHeight height;
    if (!question.height_m.empty())
      height = {question.height_m[question.height_m.size() == 1 ? 0 : k], question.height_reference,
                question.geoid_undulation_m};
    answers.records.push_back(
        question.by_bearing()
            ? query.answer_at_range(question.bearing_deg[k], question.range_m[k], height, *antenna)
            : query.answer(question.latitude_deg[k], question.longitude_deg[k], height,
                           antenna ? &*antenna : nullptr));
  }
  return answers;
}

}  // namespace obliq
