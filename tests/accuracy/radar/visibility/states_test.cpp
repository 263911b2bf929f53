// The state of every bin against brute-force profiles: points every half metre along 25 azimuths of the bin,
// line of sight by the highest slope so far. Shares no code with the renderer's exact march.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numbers>
#include <string>

#include "tests/support/figures.h"
#include "tests/support/scenes.h"

namespace obliq::states_test {
namespace {

constexpr double kStep_m = 0.5;
constexpr double kAntenna_m = 1200;

RadarSettings settings(FrustumKind kind, int pixels) {
  return test::radar_settings(kind, {1000, 9000, 70}, {60, 160}, {pixels, pixels});
}

/// Height of the two triangles of a cell; NaN where a corner is unknown.
double height_m(const HeightGrid& g, double x, double z) {
  const double u = (x - g.x0_m) / g.cell_m, v = (z - g.z0_m) / g.cell_m;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  if (i < 0 || j < 0 || i + 1 >= g.nx || j + 1 >= g.nz) return NAN;
  const auto at = [&](int a, int b) {
    return static_cast<double>(
        g.y_m[static_cast<std::size_t>(b) * static_cast<std::size_t>(g.nx) + static_cast<std::size_t>(a)]);
  };
  const double s = u - i, t = v - j;
  const double a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
  if (std::isnan(a + b + c + d)) return NAN;
  // The diagonal runs from (i + 1, j) to (i, j + 1).
  return s + t <= 1 ? a + s * (b - a) + t * (c - a) : d + (1 - s) * (c - d) + (1 - t) * (b - d);
}

/// Roofs by place: buildings in squares of 100 m, inside by the even-odd rule over all rings.
class Roofs {
 public:
  explicit Roofs(const Buildings& buildings) : buildings_(buildings) {
    for (std::uint32_t b = 0; b < buildings.list.size(); ++b) {
      double x0 = HUGE_VAL, x1 = -HUGE_VAL, z0 = HUGE_VAL, z1 = -HUGE_VAL;
      for_each_edge(b, [&](const glm::vec2& p, const glm::vec2&) {
        x0 = std::min<double>(x0, p.x), x1 = std::max<double>(x1, p.x);
        z0 = std::min<double>(z0, p.y), z1 = std::max<double>(z1, p.y);
      });
      for (int i = square(x0); i <= square(x1); ++i)
        for (int j = square(z0); j <= square(z1); ++j) squares_[{i, j}].push_back(b);
    }
  }

  /// The highest roof there, or the given ground.
  double highest_m(double x, double z, double ground_m) const {
    const auto found = squares_.find({square(x), square(z)});
    if (found == squares_.end()) return ground_m;
    for (const std::uint32_t b : found->second) {
      bool inside = false;
      for_each_edge(b, [&](const glm::vec2& p, const glm::vec2& q) {
        const double px = p.x, pz = p.y, qx = q.x, qz = q.y;
        if ((pz > z) != (qz > z) && x < px + (qx - px) * (z - pz) / (qz - pz)) inside = !inside;
      });
      if (inside) ground_m = std::max(ground_m, static_cast<double>(buildings_.list[b].roof_y_m));
    }
    return ground_m;
  }

 private:
  static int square(double m) { return static_cast<int>(std::floor(m / 100)); }

  template <class F>
  void for_each_edge(std::uint32_t b, F&& f) const {
    const Building& building = buildings_.list[b];
    for (std::uint32_t ring = building.first_ring; ring < building.first_ring + building.n_rings; ++ring) {
      const std::uint32_t begin = buildings_.ring_start[ring], end = buildings_.ring_start[ring + 1];
      for (std::uint32_t k = begin; k < end; ++k)
        f(buildings_.ring_xz_m[k], buildings_.ring_xz_m[k + 1 < end ? k + 1 : begin]);
    }
  }

  const Buildings& buildings_;
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> squares_;
};

/// What one range bin can be: `sure` when several points say so, `maybe` when a point within two steps does.
struct Seen {
  int visible = 0, present = 0;
  bool maybe_visible = false, maybe_present = false;
};

/// One azimuth: its bins, and the slant range of its nearest point.
struct Strand {
  std::vector<Seen> bins;
  double nearest_m = HUGE_VAL;
};

Strand brute_force(const World& world, const Roofs& roofs, const RadarSettings& s, double bearing_rad) {
  Strand strand;
  std::vector<Seen>& bins = strand.bins;
  bins.resize(static_cast<std::size_t>(s.range_bins));
  const double spacing = (s.r_max_m - s.r_min_m) / s.range_bins;
  const auto bin = [&](double r) { return static_cast<int>(std::floor((r - s.r_min_m) / spacing)); };
  double highest = -HUGE_VAL;
  const auto point = [&](double d, double y) {
    const double slope = (y - kAntenna_m) / d;
    const double r = std::hypot(d, y - kAntenna_m);
    strand.nearest_m = std::min(strand.nearest_m, r);
    const int here = bin(r);
    // A millimetre at 1 km: rounding, and crests between two points.
    const bool maybe = slope >= highest - 1e-6;
    if (here >= 0 && here < s.range_bins) {
      ++bins[static_cast<std::size_t>(here)].present;
      bins[static_cast<std::size_t>(here)].visible += slope > highest ? 1 : 0;
    }
    for (int near = bin(r - 2 * kStep_m); near <= bin(r + 2 * kStep_m); ++near) {
      if (near < 0 || near >= s.range_bins) continue;
      bins[static_cast<std::size_t>(near)].maybe_present = true;
      if (maybe) bins[static_cast<std::size_t>(near)].maybe_visible = true;
    }
    highest = std::max(highest, slope);
  };
  double before_m = NAN;
  for (int n = 1; n * kStep_m < s.r_max_m; ++n) {
    const double d = n * kStep_m;
    const double x = d * std::sin(bearing_rad), z = d * std::cos(bearing_rad);
    double y = height_m(world.grid, x, z);
    if (!std::isnan(y)) y = roofs.highest_m(x, z, y);
    // A near wall: points up its face. NaN compares false.
    if (y > before_m + 2)
      for (double up = before_m + kStep_m; up < y; up += kStep_m) point(d, up);
    before_m = y;
    if (!std::isnan(y)) point(d, y);
  }
  return strand;
}

struct Tally {
  int of_state[5] = {0, 0, 0, 0, 0};
  int wrong = 0;
  int between = 0;  ///< sampled, but dark along all 25 azimuths: a ray between them, past a building
};

/// Compares every bin of a frame with brute-force profiles: hidden must be hidden along the bin's edges and
/// its centre, visible must be visible somewhere in it.
Tally compare(const std::shared_ptr<const Scene>& scene, const RadarSettings& s) {
  const Frame frame = render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), kAntenna_m),
                             {0, s.azimuth_bins});
  const Roofs roofs(scene->world().buildings);
  Tally tally;
  const bool nadir_known = !std::isnan(height_m(scene->world().grid, 0, 0));
  const double sector = s.sector_deg * std::numbers::pi / 180;
  for (int a = 0; a < s.azimuth_bins; ++a) {
    // 24 parts hold the halves, quarters, sixths and eighths that the renderer may divide a bin into.
    std::vector<Strand> strands;
    for (int part = 0; part <= 24; ++part)
      strands.push_back(
          brute_force(scene->world(), roofs, s, sector * ((a + part / 24.0) / s.azimuth_bins - 0.5)));
    double nearest_m = HUGE_VAL;
    for (const Strand& strand : strands) nearest_m = std::min(nearest_m, strand.nearest_m);
    for (std::size_t r = 0; r < static_cast<std::size_t>(s.range_bins); ++r) {
      const double end_m = s.r_min_m + static_cast<double>(r + 1) * (s.r_max_m - s.r_min_m) / s.range_bins;
      const std::uint8_t state =
          frame.bins.state[static_cast<std::size_t>(a) * static_cast<std::size_t>(s.range_bins) + r];
      ++tally.of_state[state];
      bool maybe_visible = false, maybe_present = false, visible = false, present = false;
      for (std::size_t part = 0; part <= 24; ++part) {
        const Seen& seen = strands[part].bins[r];
        maybe_visible |= seen.maybe_visible;
        maybe_present |= seen.maybe_present;
        if (part % 12 != 0) continue;
        visible |= seen.visible >= 3;
        present |= seen.present >= 3;
      }
      if (state == 1 && !maybe_visible && maybe_present) {
        ++tally.between;
        continue;
      }
      bool right = (state <= 1 ? maybe_visible : !visible) && (state <= 2 ? maybe_present : !present);
      if (state == 4) right &= nadir_known && end_m <= nearest_m + 2 * kStep_m;
      if (state == 3) right &= !nadir_known || end_m > nearest_m - 2 * kStep_m;
      if (!right && ++tally.wrong < 5)
        std::printf("    azimuth bin %d range bin %zu: state %d, but visible %d %d, present %d %d\n", a, r,
                    state, visible, maybe_visible, present, maybe_present);
    }
  }
  std::printf(
      "    not sampled %d, sampled %d, shadow %d, no surface %d, nearer than the ground %d; wrong %d, "
      "between %d\n",
      tally.of_state[0], tally.of_state[1], tally.of_state[2], tally.of_state[3], tally.of_state[4],
      tally.wrong, tally.between);
  return tally;
}

WorldSpec spec(SyntheticKind kind, double reach_m = 12000) {
  WorldSpec w = test::synthetic_spec(kind, reach_m, 40);
  w.terrain.shape.height_m = kind == SyntheticKind::hills ? 1100 : 700;
  w.terrain.shape.distance_m = 4000;
  w.terrain.shape.width_m = 900;
  w.terrain.shape.bearing_deg = 20;
  return w;
}

/// Tall and broad ones, so that whole bins lie behind them.
WorldSpec with_prisms(WorldSpec w) {
  w.prisms.push_back({});
  w.prisms.back().per_km2 = 20;
  w.prisms.back().width_m = {40, 80};
  w.prisms.back().length_m = {60, 200};
  w.prisms.back().height_m = {20, 120};
  return w;
}

/// A rectangle of nodes made unknown.
World with_void(World world, double x_m, double z_m, double side_m) {
  for (int j = 0; j < world.grid.nz; ++j)
    for (int i = 0; i < world.grid.nx; ++i)
      if (std::abs(world.grid.node_x_m(i) - x_m) < side_m / 2 &&
          std::abs(world.grid.node_z_m(j) - z_m) < side_m / 2)
        world.grid.y_m[world.grid.index(i, j)] = NAN;
  return world;
}

struct Named {
  const char* name;
  std::function<World()> world;
  int shadow, no_surface, hole;  ///< at least so many bins of each
  double missed = 0;             ///< share of sampled bins whose view lies between two strands
};

const Named kScenes[] = {
    // Of 1200 m over flat ground, 200 lie in the swath: four bins of 50 m in 60 azimuths.
    {"ridge", [] { return load_world(spec(SyntheticKind::ridge)); }, 500, 0, 240},
    {"hills", [] { return load_world(spec(SyntheticKind::hills)); }, 200, 0, 0},
    {"hills with prisms", [] { return load_world(with_prisms(spec(SyntheticKind::hills))); }, 300, 0, 0,
     3e-3},
    {"void", [] { return with_void(load_world(spec(SyntheticKind::flat)), 300, 4000, 1500); }, 0, 200, 240},
    {"void under the antenna", [] { return with_void(load_world(spec(SyntheticKind::flat)), 0, 0, 900); }, 0,
     60, 0},
    {"void behind a ridge",
     [] { return with_void(load_world(spec(SyntheticKind::ridge)), 1500, 5200, 1200); }, 300, 200, 240},
    {"edge of the elevation model", [] { return load_world(spec(SyntheticKind::hills, 5000)); }, 0, 1000, 0},
};

TEST(BinStates, WithoutSamplesAreThoseOfTheBruteForceProfile) {
  for (const Named& scene : kScenes) {
    std::printf("    %s:\n", scene.name);
    // One pixel: hardly any bin is sampled, so the profile decides.
    RadarSettings s = settings(FrustumKind::symmetric, 1);
    s.r_min_m = kAntenna_m;
    const Tally tally = compare(test::make_scene(scene.world()), s);
    EXPECT_EQ(tally.wrong, 0) << scene.name;
    EXPECT_GE(tally.of_state[0], 1000) << scene.name;
    EXPECT_GE(tally.of_state[2], scene.shadow) << scene.name;
    EXPECT_GE(tally.of_state[3], scene.no_surface) << scene.name;
  }
}

TEST(BinStates, NearerThanTheGroundAreTheBinsOfTheAltitudeHoleForEverySource) {
  // Flat ground 1200 m below: its nearest point is there in every azimuth. The perspective frusta take no
  // swath that begins nearer than that.
  const auto known = test::make_scene(load_world(spec(SyntheticKind::flat)));
  const auto unknown = test::make_scene(with_void(load_world(spec(SyntheticKind::flat)), 0, 0, 1e6));
  for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric}) {
    RadarSettings s = settings(kind, 240);
    s.azimuth_bins = 10;
    if (kind != FrustumKind::sweep) s.r_min_m = 1200;
    for (const auto& [scene, state] :
         {std::pair{known, BinState::nearer_than_ground}, {unknown, BinState::no_surface}}) {
      const Frame frame =
          render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), kAntenna_m), {0, 10});
      for (std::size_t k = 0; k < frame.bins.state.size(); ++k) {
        const bool hole =
            s.r_min_m + static_cast<double>(k % 160 + 1) * (s.r_max_m - s.r_min_m) / 160 <= kAntenna_m;
        if (scene == unknown || hole) {
          ASSERT_EQ(frame.bins.state[k], static_cast<std::uint8_t>(state))
              << static_cast<int>(kind) << ' ' << k;
          ASSERT_EQ(frame.bins.count[k], 0u);
          ASSERT_EQ(frame.bins.power_w[k], 0);
          ASSERT_EQ(frame.bins.iq[k], std::complex<float>(0));
        } else {
          ASSERT_LE(frame.bins.state[k], 1) << static_cast<int>(kind) << ' ' << k;
        }
      }
    }
  }
}

TEST(BinStates, WithSamplesAreThoseOfTheBruteForceProfile) {
  for (const Named& scene : kScenes) {
    std::printf("    %s:\n", scene.name);
    RadarSettings s = settings(FrustumKind::sweep, 960);
    s.sub_columns = 0;
    const Tally tally = compare(test::make_scene(scene.world()), s);
    EXPECT_EQ(tally.wrong, 0) << scene.name;
    EXPECT_GE(tally.of_state[1], 1000) << scene.name;
    EXPECT_GE(tally.of_state[4], scene.hole) << scene.name;
    // Strands stand between the corners of buildings and see slits that evenly spaced profiles pass by.
    EXPECT_LE(tally.between, 6e-3 * tally.of_state[1]) << scene.name;
  }
}

TEST(BinStates, TurnFromSampledIntoNotSampledAndNotIntoShadowWhenRaysAreDropped) {
  int all_wrong = 0, all_sampled = 0;
  for (const Named& scene : kScenes) {
    const auto built = test::make_scene(scene.world());
    const Pose pose = test::pose_over_origin(built->world(), kAntenna_m);
    for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::symmetric, FrustumKind::sweep}) {
      const auto render_with = [&](int pixels) {
        RadarSettings s = settings(kind, pixels);
        s.sector_deg = 7;  // bins of 0.117 degrees, as 120 degrees in 1024: two strands a bin
        s.r_min_m = 1250;  // the perspective frusta need at least the antenna's height above ground
        return render(built, test::snapshot(s), pose, {0, s.azimuth_bins});
      };
      const Frame many = render_with(960);
      const Frame few = render_with(303);  // a tenth of the rays
      int lost = 0, wrong = 0, sampled = 0;
      for (std::size_t n = 0; n < many.bins.state.size(); ++n) {
        if (many.bins.state[n] != 1) {
          if (many.bins.state[n] >= 2 && few.bins.state[n] == 0) ++wrong;
          continue;
        }
        ++sampled;
        lost += few.bins.state[n] == 0 ? 1 : 0;
        wrong += few.bins.state[n] >= 2 ? 1 : 0;
      }
      std::printf("    %s, frustum %d: %d bins sampled, %d of them not with a tenth of the rays, %d wrong\n",
                  scene.name, static_cast<int>(kind), sampled, lost, wrong);
      all_wrong += wrong;
      all_sampled += sampled;
      // A gap between two buildings that falls between two strands is missed. With one strand a bin (the
      // named wrong version) bare hills fail too, with one bin in 100.
      // The sweep's sub-columns call a bin hidden of which less than a 64th of the light is left.
      const double allowed = kind == FrustumKind::sweep ? 2 * scene.missed : scene.missed;
      EXPECT_LE(wrong, allowed * sampled) << scene.name;
    }
  }
  test::record_figure("states_wrong", all_wrong);
  test::record_figure("states_sampled", all_sampled);
}

}  // namespace
}  // namespace obliq::states_test
