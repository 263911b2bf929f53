#include "tests/support/random_scenes.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "server/radar/profile/roofs.h"
#include "terrain/base/units.h"
#include "terrain/buildings/footprints.h"

namespace obliq::test {
namespace {

double rounded(double m, double quantum_m) { return std::round(m / quantum_m) * quantum_m; }

constexpr double kPlace_m = 1.0 / 1024;  ///< of antennas
constexpr double kCorner_m = 1.0 / 64;   ///< of outlines: exact in float32 within 131 km

enum class Ground { flat, noise, terraces, ridges, cliff, spikes, hills };
constexpr const char* kGroundNames[] = {"flat", "noise", "terraces", "ridges", "cliff", "spikes", "hills"};

/// A grid without heights.
HeightGrid empty_grid(Dice& dice, const RandomSceneOptions& options) {
  HeightGrid grid;
  grid.nx = std::max(2, options.nodes);
  const int more = dice.integer(-grid.nx / 4, grid.nx / 4);
  grid.nz = options.square ? grid.nx : std::max(2, grid.nx + more);
  grid.cell_m = dice.one_of({1.0, 3.03125, 10.0, 10.0, 30.0, 250.0, 1000.0});
  const double away_m = options.far_origin && dice.chance(1.0 / 6) ? 1e5 : grid.cell_m;
  grid.x0_m = rounded(dice.uniform(-away_m, away_m) - grid.cell_m * (grid.nx / 2), kGridQuantum_m);
  grid.z0_m = rounded(dice.uniform(-away_m, away_m) - grid.cell_m * (grid.nz / 2), kGridQuantum_m);
  grid.y_m.resize(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.nz));
  return grid;
}

/// Height above the datum, between 0 and about `relief_m`, for one kind of ground.
class Shape {
 public:
  Shape(Ground kind, const HeightGrid& grid, double relief_m, Dice& dice)
      : kind_(kind), relief_m_(relief_m), seed_(dice.bits()), steps_(dice.integer(2, 6)) {
    for (Wave& wave : waves_) {
      const double bearing = dice.uniform(0, 2 * std::numbers::pi);
      const double turns_a_cell = dice.logarithmic(0.5, 4) / std::max(grid.nx, grid.nz);
      wave = {std::sin(bearing) * turns_a_cell, std::cos(bearing) * turns_a_cell, dice.unit()};
    }
  }

  double height_m(int i, int j) const {
    const double noise = unit_from_hash(hash_cell(seed_, i, j));
    switch (kind_) {
      case Ground::flat:
        return 0;
      case Ground::noise:
        return relief_m_ * noise;
      case Ground::terraces:
        return relief_m_ * std::floor(steps_ * smooth(i, j)) / steps_;
      case Ground::ridges:
        return relief_m_ * (1 - std::abs(2 * turns(waves_[0], i, j) - 1));
      case Ground::cliff:
        return turns(waves_[0], i, j) < 0.5 ? 0 : relief_m_;
      case Ground::spikes:
        return noise < 0.03 ? relief_m_ * (noise / 0.03) : 0.02 * relief_m_ * smooth(i, j);
      case Ground::hills:
        return relief_m_ * smooth(i, j);
    }
    return 0;
  }

 private:
  struct Wave {
    double per_i, per_j, phase;
  };
  static double turns(const Wave& wave, int i, int j) {
    const double t = wave.per_i * i + wave.per_j * j + wave.phase;
    return t - std::floor(t);
  }
  double smooth(int i, int j) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(2 * std::numbers::pi * turns(wave, i, j));
    return 0.5 + sum / (2.001 * static_cast<double>(waves_.size()));
  }

  Ground kind_;
  double relief_m_;
  std::uint64_t seed_;
  int steps_;
  std::array<Wave, 4> waves_{};
};

/// Cuts rectangles and single nodes out of the ground, never all of it.
void cut_voids(HeightGrid& grid, Dice& dice) {
  const auto cut = [&](int i, int j) {
    if (i > 0 || j > 0) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
  };
  for (int n = dice.integer(0, 2); n > 0; --n) {
    const int i0 = dice.integer(0, grid.nx - 1),
              i1 = std::min(grid.nx - 1, i0 + dice.integer(0, grid.nx / 3));
    const int j0 = dice.integer(0, grid.nz - 1),
              j1 = std::min(grid.nz - 1, j0 + dice.integer(0, grid.nz / 3));
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) cut(i, j);
  }
  for (int n = dice.integer(0, 4); n > 0; --n)
    cut(dice.integer(0, grid.nx - 1), dice.integer(0, grid.nz - 1));
}

struct Rectangle {
  glm::dvec2 centre_m{0.0};
  double half_length_m = 0, half_width_m = 0, bearing_rad = 0;

  Ring ring(double scale = 1) const {
    const glm::dvec2 along(std::sin(bearing_rad), std::cos(bearing_rad));
    const glm::dvec2 across(along.y, -along.x);
    Ring ring;
    for (const auto& [a, b] : {std::pair{-1, -1}, std::pair{-1, 1}, std::pair{1, 1}, std::pair{1, -1}}) {
      const glm::dvec2 p =
          centre_m + along * (scale * a * half_length_m) + across * (scale * b * half_width_m);
      ring.emplace_back(rounded(p.x, kCorner_m), rounded(p.y, kCorner_m));
    }
    return ring;
  }
};

void stand_prisms(World& world, int most, double relief_m, Dice& dice) {
  const HeightGrid& grid = world.grid;
  const double cell = grid.cell_m;
  const double side = cell * std::min(grid.nx - 1, grid.nz - 1);
  OutlineShaper shaper;
  Rectangle last;
  double last_height_m = 0;
  for (int n = dice.integer(0, most); n > 0; --n) {
    Rectangle r;
    r.centre_m = {dice.uniform(grid.x0_m, grid.x1_m()), dice.uniform(grid.z0_m, grid.z1_m())};
    r.half_length_m = cell * dice.logarithmic(0.1, 2);
    r.half_width_m = r.half_length_m * dice.uniform(0.2, 1);
    r.bearing_rad =
        dice.chance(0.3) ? std::numbers::pi / 2 * dice.integer(0, 3) : dice.uniform(0, 2 * std::numbers::pi);
    double height_m = std::max(0.5, dice.logarithmic(0.02, 2) * std::max(cell, relief_m));
    switch (dice.integer(0, 9)) {
      case 0:  // tiny
        r.half_length_m = r.half_width_m = dice.logarithmic(0.05, 0.5);
        break;
      case 1:  // huge
        r.half_length_m = side * dice.uniform(0.1, 0.25);
        r.half_width_m = side * dice.uniform(0.1, 0.25);
        break;
      case 2:  // a needle
        r.half_width_m = 0.05;
        break;
      case 3:  // nested in the last one, lower or higher
      case 4:
        if (last.half_length_m == 0) break;
        r = last;
        r.half_length_m *= dice.uniform(0.2, 0.9);
        r.half_width_m *= dice.uniform(0.2, 0.9);
        break;
      case 5:  // overlaps the last one, perhaps with the same height
        if (last.half_length_m == 0) break;
        r.centre_m = last.centre_m + glm::dvec2(last.half_length_m * dice.uniform(-1, 1));
        if (dice.chance(0.5)) height_m = last_height_m;
        break;
      default:
        break;
    }
    Polygon outline{{r.ring()}};
    if (dice.chance(0.15)) outline.rings.push_back(r.ring(0.5));
    stand_outline(world, shaper, outline, {height_m, 1, dice.bits()});
    last = r;
    last_height_m = height_m;
  }
}

/// Highest known node or roof.
double highest_m(const World& world) {
  double highest = -HUGE_VAL;
  for (const float y : world.grid.y_m)
    if (!std::isnan(y)) highest = std::max(highest, static_cast<double>(y));
  for (const Building& building : world.buildings.list)
    highest = std::max(highest, static_cast<double>(building.roof_y_m));
  return highest;
}

Pose stand_antenna(const World& world, double relief_m, Dice& dice, bool outside, const char*& place) {
  const HeightGrid& grid = world.grid;
  const double width = grid.x1_m() - grid.x0_m;
  const double depth = grid.z1_m() - grid.z0_m;
  // Position as a part of the grid's sides.
  double u = dice.uniform(0.05, 0.95), v = dice.uniform(0.05, 0.95);
  place = "inside";
  if (outside && dice.chance(0.1)) {
    place = "outside";
    u = dice.chance(0.5) ? dice.uniform(-0.3, -0.01) : dice.uniform(1.01, 1.3);
  } else if (dice.chance(0.15)) {
    place = "at the edge";
    v = dice.chance(0.5) ? dice.uniform(0, 0.02) : dice.uniform(0.98, 1);
  }
  Pose pose;
  glm::dvec3& at = pose.antenna.m;
  at = {rounded(grid.x0_m + u * width, kPlace_m), 0, rounded(grid.z0_m + v * depth, kPlace_m)};
  pose.ground_y_m = grid.height_at_m(at.x, at.z);
  const double top = highest_m(world);
  if (dice.chance(0.55) && !std::isnan(pose.ground_y_m)) {
    at.y = pose.ground_y_m + dice.logarithmic(0.02, 1) * std::max(grid.cell_m, relief_m);
  } else {
    at.y = top + dice.logarithmic(0.02, 1) * (width + depth) / 2;
  }
  at.y = rounded(at.y, kPlace_m) + kPlace_m;
  while (const auto roof = roof_above(world.buildings, at)) at.y = rounded(*roof, kPlace_m) + 2 * kPlace_m;
  pose.bearing_world_rad = dice.uniform(-std::numbers::pi, std::numbers::pi);
  return pose;
}

RadarSettings random_settings(const HeightGrid& grid, const Pose& pose, double most_sector_deg, Dice& dice) {
  const double diagonal_m = std::hypot(grid.x1_m() - grid.x0_m, grid.z1_m() - grid.z0_m);
  const double above_m =
      pose.antenna.m.y - (std::isnan(pose.ground_y_m) ? grid.node_y_m(0, 0) : pose.ground_y_m);
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.sector_deg =
      std::min(most_sector_deg, dice.one_of({dice.logarithmic(1, 60), 60.0, 120.0, 179.0, 200.0, 360.0}));
  // The perspective frusta need r_min of at least the height above ground; the sweep takes any.
  settings.r_min_m = dice.chance(0.5) ? above_m * dice.uniform(1, 1.5) : diagonal_m * dice.uniform(0, 0.2);
  settings.r_max_m = settings.r_min_m + diagonal_m * dice.uniform(0.3, 1.2);
  settings.azimuth_bins = dice.one_of({1, 3, 8, 12, 17});
  settings.range_bins = dice.one_of({1, 5, 16, 16, 40});
  settings.pixel_columns = settings.azimuth_bins * dice.integer(1, 4);
  settings.pixel_rows = dice.integer(8, 64);
  settings.speckle_seed = static_cast<std::int64_t>(dice.integer(1, 1000));
  return settings;
}

}  // namespace

double Dice::logarithmic(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

RandomScene random_scene(std::uint64_t seed, const RandomSceneOptions& options) {
  Dice dice(seed);
  RandomScene scene;
  scene.seed = seed;
  World& world = scene.world;
  constexpr double kFlat = std::numeric_limits<double>::infinity();
  const double drawn = dice.one_of({kFlat, kFlat, 4.0 / 3, 1.0});
  const double factor = options.curved ? drawn : kFlat;
  world.frame = WorldFrame(33 * kDegree_rad, -99.5 * kDegree_rad, factor);
  world.grid = empty_grid(dice, options);
  HeightGrid& grid = world.grid;
  const auto kind = static_cast<Ground>(dice.integer(0, 6));
  const double relief_m = kind == Ground::flat ? 0 : std::min(4000.0, grid.cell_m * dice.logarithmic(0.1, 8));
  const Shape shape(kind, grid, relief_m, dice);
  const double base_m = dice.one_of({0.0, 0.0, -80.0, 1500.0});
  for (int j = 0; j < grid.nz; ++j)
    for (int i = 0; i < grid.nx; ++i)
      grid.y_m[grid.index(i, j)] = static_cast<float>(
          base_m + shape.height_m(i, j) + world.frame.datum_y_m(grid.node_x_m(i), grid.node_z_m(j)));
  const bool voids = options.voids && dice.chance(1.0 / 3);
  if (voids) cut_voids(grid, dice);
  stand_prisms(world, options.most_prisms, relief_m, dice);
  const char* place = "";
  scene.pose = stand_antenna(world, relief_m, dice, options.outside, place);
  scene.settings = random_settings(grid, scene.pose, options.most_sector_deg, dice);

  const RadarSettings& s = scene.settings;
  std::ostringstream text;
  text << "scene seed " << seed << ": " << kGroundNames[static_cast<int>(kind)]
       << (voids ? " with voids" : "") << ", " << grid.nx << " x " << grid.nz << " nodes of " << grid.cell_m
       << " m from (" << grid.x0_m << ", " << grid.z0_m << "), relief " << relief_m << " m, earth factor "
       << factor << ", " << world.buildings.list.size() << " prisms, antenna " << place << " at ("
       << scene.pose.antenna.m.x << ", " << scene.pose.antenna.m.y << ", " << scene.pose.antenna.m.z
       << "), sector " << s.sector_deg << " at " << scene.pose.bearing_world_rad / kDegree_rad << " degrees, "
       << s.r_min_m << " to " << s.r_max_m << " m, " << s.azimuth_bins << " x " << s.range_bins << " bins, "
       << s.pixel_columns << " x " << s.pixel_rows << " pixels";
  scene.text = text.str();
  return scene;
}

std::shared_ptr<const Scene> scene_of(RandomScene& random) {
  return std::make_shared<const Scene>(std::make_shared<const World>(std::move(random.world)),
                                       std::vector<Material>(8), 0);
}

}  // namespace obliq::test
