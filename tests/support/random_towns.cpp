#include "tests/support/random_towns.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "server/radar/profile/roofs.h"
#include "terrain/base/units.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/made_worlds.h"

namespace obliq::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCorner_m = 1.0 / 1024;  // of outlines: exact in float32 within 8 km

double rounded(double m) { return std::round(m / kCorner_m) * kCorner_m; }

enum class Ground { flat, hills, cliff, ridges, valley };
constexpr const char* kGroundNames[] = {"flat", "hills", "cliff", "ridges", "valley"};

/// A place in the town's own axes: across the cliff's edge, along it, metres.
class Land {
 public:
  Land(Ground kind, double side_m, Dice& dice)
      : kind_(kind),
        side_m_(side_m),
        relief_m_(kind == Ground::flat ? 0 : side_m * dice.logarithmic(0.005, 0.2)),
        cliff_at_(dice.uniform(0.3, 0.7) * side_m),
        phase_(dice.uniform(0, 2 * kPi)) {}

  double cliff_z_m() const { return cliff_at_; }
  double relief_m() const { return relief_m_; }

  double height_m(double x_m, double z_m) const {
    const double u = x_m / side_m_, v = z_m / side_m_;
    switch (kind_) {
      case Ground::flat:
        return 0;
      case Ground::hills:
        return relief_m_ * (0.5 + 0.25 * std::sin(9 * u + phase_) + 0.25 * std::sin(13 * v + 2 * u + phase_));
      case Ground::cliff:
        return z_m < cliff_at_ ? relief_m_ : 0;
      case Ground::ridges:
        return relief_m_ * std::abs(std::sin(7 * v + 3 * u + phase_));
      case Ground::valley:
        return relief_m_ * 4 * (v - 0.5) * (v - 0.5);
    }
    return 0;
  }

 private:
  Ground kind_;
  double side_m_, relief_m_, cliff_at_, phase_;
};

HeightGrid town_grid(const Land& land, double cell_m, int nodes, Dice& dice, bool& voids) {
  HeightGrid grid;
  grid.cell_m = cell_m;
  grid.nx = grid.nz = nodes;
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i)
      grid.y_m.push_back(static_cast<float>(land.height_m(i * cell_m, j * cell_m)));
  voids = dice.chance(0.2);
  for (int n = voids ? dice.integer(1, 4) : 0; n > 0; --n) {
    const int i0 = dice.integer(0, nodes - 1), j0 = dice.integer(nodes / 4, nodes - 1);
    const int size = dice.integer(0, nodes / 6);
    for (int j = j0; j <= std::min(nodes - 1, j0 + size); ++j)
      for (int i = i0; i <= std::min(nodes - 1, i0 + size); ++i)
        grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
  }
  return grid;
}

/// Outlines in a house's own axes, counter-clockwise, about (0, 0), a by b metres in all.
Ring box(double a, double b) { return {{-a / 2, -b / 2}, {a / 2, -b / 2}, {a / 2, b / 2}, {-a / 2, b / 2}}; }

Ring l_shape(double a, double b) {
  return {{-a / 2, -b / 2}, {a / 2, -b / 2}, {a / 2, 0}, {0, 0}, {0, b / 2}, {-a / 2, b / 2}};
}

Ring cross(double a, double b) {
  const double p = a / 6, q = b / 6;
  return {{-p, -b / 2}, {p, -b / 2}, {p, -q}, {a / 2, -q}, {a / 2, q},   {p, q},
          {p, b / 2},   {-p, b / 2}, {-p, q}, {-a / 2, q}, {-a / 2, -q}, {-p, -q}};
}

/// Teeth on one side, two of them a U.
Ring comb(double a, double b, int teeth) {
  Ring ring{{-a / 2, -b / 2}, {a / 2, -b / 2}};
  const double width = a / (2 * teeth - 1);
  for (int t = teeth - 1; t >= 0; --t) {
    const double left = -a / 2 + 2 * t * width, right = left + width;
    ring.emplace_back(right, b / 2);
    ring.emplace_back(left, b / 2);
    if (t == 0) break;
    ring.emplace_back(left, -b / 3);
    ring.emplace_back(left - width, -b / 3);
  }
  return ring;
}

constexpr const char* kHouseNames[] = {
    "L",     "U",      "comb",   "cross",  "courtyard", "row", "tower on podium",
    "round", "sliver", "needle", "copies", "hall",      "box"};

class Town {
 public:
  const std::string& kinds() const { return kinds_; }

  Town(World& world, Dice& dice) : world_(world), dice_(dice) {}

  /// One house, or a few that belong together, about a point of the world.
  void build(const glm::dvec2& at, double size_m) {
    at_ = at;
    const double bearing = dice_.chance(0.3) ? kPi / 2 * dice_.integer(0, 3) : dice_.uniform(0, 2 * kPi);
    along_ = {std::sin(bearing), std::cos(bearing)};
    const double a = size_m, b = size_m * dice_.logarithmic(0.3, 1);
    const double height = dice_.logarithmic(2, 60);
    const int kind = dice_.integer(0, 13);
    kinds_ += std::string(kinds_.empty() ? "" : ", ") + kHouseNames[std::min(kind, 12)];
    switch (kind) {
      case 0:
        return stand({l_shape(a, b)}, height);
      case 1:
        return stand({comb(a, b, 2)}, height);
      case 2:
        return stand({comb(a, b, dice_.integer(3, 6))}, height);
      case 3:
        return stand({cross(a, b)}, height);
      case 4:  // a courtyard, and perhaps a tower in it
        stand({box(a, b), box(0.6 * a, 0.6 * b)}, height);
        if (dice_.chance(0.5)) stand({box(0.2 * a, 0.2 * b)}, height * dice_.uniform(0.5, 2));
        return;
      case 5:  // a row with shared walls
        for (int n = dice_.integer(2, 6); n > 0; --n) {
          stand({box(a, b)}, dice_.chance(0.5) ? height : height * dice_.uniform(0.5, 1.5));
          at_ += a * glm::dvec2(along_.y, -along_.x);
        }
        return;
      case 6:  // a tower on a podium
        stand({box(a, b)}, height);
        return stand({ellipse(0.4 * a, 0.4 * b, 4)}, 2 * height);
      case 7:
        return stand({ellipse(a, b, dice_.integer(3, 24))}, height);
      case 8:  // a sliver
        return stand({box(a, 0.05)}, height);
      case 9:  // a needle
        return stand({box(0.01, 0.01)}, height);
      case 10: {  // the same outline again, as from a second data set
        const Ring ring = ellipse(a, b, dice_.integer(4, 8));
        stand({ring}, height);
        return stand({ring}, dice_.chance(0.5) ? height : height + 0.5);
      }
      case 11:  // a hall
        return stand({box(4 * a, 3 * b)}, height);
      default:
        return stand({box(a, b)}, height);
    }
  }

 private:
  void stand(const std::vector<Ring>& rings, double height_m) {
    Polygon outline;
    for (const Ring& ring : rings) {
      outline.rings.emplace_back();
      for (const glm::dvec2& p : ring) {
        const glm::dvec2 world = at_ + p.x * glm::dvec2(along_.y, -along_.x) + p.y * along_;
        outline.rings.back().emplace_back(rounded(world.x), rounded(world.y));
      }
    }
    stand_outline(world_, shaper_, outline, {height_m, 1, dice_.bits()});
  }

  World& world_;
  Dice& dice_;
  OutlineShaper shaper_;
  std::string kinds_;
  glm::dvec2 at_{0.0};
  glm::dvec2 along_{0, 1};
};

}  // namespace

RandomScene random_town(std::uint64_t seed) {
  Dice dice(mix64(seed + 77));
  RandomScene town;
  town.seed = seed;
  World& world = town.world;
  const double factor = dice.one_of({std::numeric_limits<double>::infinity(), 4.0 / 3});
  world.frame = WorldFrame(33 * kDegree_rad, -99.5 * kDegree_rad, factor);
  const double cell_m = dice.one_of({4.0, 10.0, 30.0});
  const int nodes = dice.integer(49, 97);
  const double side_m = cell_m * (nodes - 1);
  const auto kind = static_cast<Ground>(dice.integer(0, 4));
  const Land land(kind, side_m, dice);
  bool voids = false;
  world.grid = town_grid(land, cell_m, nodes, dice, voids);

  // The antenna stands near the southern edge and looks across the town.
  glm::dvec3& at = town.pose.antenna.m;
  at.x = rounded(side_m * dice.uniform(0.3, 0.7));
  at.z = rounded(side_m * dice.uniform(0.02, 0.1));
  town.pose.bearing_world_rad = dice.uniform(-0.4, 0.4);
  RadarSettings& s = town.settings;
  s.frustum = FrustumKind::sweep;
  s.r_min_m = side_m * dice.uniform(0.03, 0.4);
  s.r_max_m = s.r_min_m + side_m * dice.uniform(0.1, 0.5);
  const double middle_m = (s.r_min_m + s.r_max_m) / 2;
  const double width_deg = dice.chance(0.05)
                               ? dice.uniform(1, 10)
                               : std::clamp(dice.logarithmic(0.5, 60) / middle_m / kDegree_rad, 0.02, 0.9);
  s.azimuth_bins = dice.integer(4, 24);
  s.sector_deg = width_deg * s.azimuth_bins;
  s.range_bins = static_cast<int>(std::clamp((s.r_max_m - s.r_min_m) / dice.logarithmic(2, 60), 4.0, 96.0));
  s.pixel_columns = 2 * s.azimuth_bins;
  s.speckle_seed = dice.integer(1, 1000);

  const double half_sector_rad = s.sector_deg * kDegree_rad / 2;
  const double size_m = dice.logarithmic(3, 30);
  Town houses(world, dice);
  for (int n = static_cast<int>(dice.logarithmic(2, 150)); n > 0; --n) {
    const double bearing = town.pose.bearing_world_rad + half_sector_rad * dice.uniform(-1.2, 1.2);
    double range_m = dice.uniform(0.9 * s.r_min_m, 1.05 * s.r_max_m);
    if (dice.chance(0.1)) range_m = dice.chance(0.5) ? s.r_min_m : s.r_max_m;
    if (dice.chance(0.05)) range_m = dice.uniform(2, 50);
    glm::dvec2 place(at.x + range_m * std::sin(bearing), at.z + range_m * std::cos(bearing));
    if (kind == Ground::cliff && dice.chance(0.2)) place.y = land.cliff_z_m();
    houses.build(place, size_m * dice.logarithmic(0.5, 2));
  }
  town.pose.ground_y_m = world.grid.height_at_m(at.x, at.z);
  const double ground_m = std::isnan(town.pose.ground_y_m) ? 0 : town.pose.ground_y_m;
  const char* place = "high";
  at.y = ground_m + middle_m * dice.uniform(0.05, 0.6);
  if (dice.chance(0.3)) {
    place = "low";
    at.y = ground_m + dice.logarithmic(2, 30);
  }
  at.y = rounded(at.y) + kCorner_m;
  while (const auto roof = roof_above(world.buildings, at)) {
    place = "on a roof";
    at.y = rounded(*roof) + 2;
  }
  std::ostringstream text;
  text << "town seed " << seed << ": " << kGroundNames[static_cast<int>(kind)] << (voids ? " with voids" : "")
       << ", " << nodes << " x " << nodes << " nodes of " << cell_m << " m, relief " << land.relief_m()
       << " m, earth factor " << factor << ", " << world.buildings.list.size() << " prisms of some " << size_m
       << " m, antenna " << place << " at (" << at.x << ", " << at.y << ", " << at.z << "), ground "
       << ground_m << ", sector " << s.sector_deg << " at " << town.pose.bearing_world_rad / kDegree_rad
       << " degrees, " << s.r_min_m << " to " << s.r_max_m << " m, " << s.azimuth_bins << " x "
       << s.range_bins << " bins; houses: " << houses.kinds();
  town.text = text.str();
  return town;
}

}  // namespace obliq::test
