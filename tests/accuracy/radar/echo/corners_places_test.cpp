// Where corners of walls and ground are and are not: shadows, range bins, phases, awkward walls.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "server/radar/echo/speckle.h"
#include "tests/accuracy/radar/echo/corners_support.h"

namespace obliq::corners_places_test {
namespace {

using test::CornerWay;
using test::House;
using test::kPi;
using test::total;

constexpr CornerWay kExact{"exact", FrustumKind::sweep, 0, 1e-3};
constexpr CornerWay kColumns{"sub-columns", FrustumKind::sweep, 64, 1e-3};
constexpr CornerWay kRays{"rays", FrustumKind::oblique, 0, 0.05};
constexpr CornerWay kWays[] = {kExact, kColumns, kRays};

/// So near that the sweep looks at it by strips (NearView).
House near_house() {
  House house;
  house.distance_m = 1100;
  return house;
}

/// A wall across the sight before the house.
World with_wall_before(const House& house, double before_m, double height_m) {
  World world = house.world();
  test::add_prism(world, test::rectangle(0, house.distance_m - before_m - 2, 60, 4), height_m);
  return world;
}

TEST(CornerPlaces, HiddenFootHasNone) {
  for (const CornerWay& way : kWays) {
    for (const House& house : {House{}, near_house()}) {
      SCOPED_TRACE(way.name + std::string(" ") + std::to_string(house.distance_m));
      const RadarSettings s = test::corner_settings(house, way);
      const double open = total(test::corner_powers(house.world(), house, s, test::corner_materials()));
      // Its own corner is there: another 60 m wall. That of the house is not: its shadow is 22 m long.
      World alone = with_wall_before(house, 12, 8);
      const double both = total(test::corner_powers(alone, house, s, test::corner_materials()));
      World no_house = test::made_world(21000, 500, [](double, double) { return 0.0; });
      test::add_prism(no_house, test::rectangle(0, house.distance_m - 14, 60, 4), 8);
      no_house.buildings.corners = true;
      const double other = total(test::corner_powers(no_house, house, s, test::corner_materials()));
      EXPECT_GT(other, open);
      EXPECT_NEAR(both / other, 1, 1e-6);
    }
  }
}

TEST(CornerPlaces, ShadowBeforeTheFootShortensTheStrip) {
  // A wall of 4 m throws 11 m of shadow; its roof's far edge stands 22 m before the foot: 11 m are lit of 22.
  for (const CornerWay& way : kWays) {
    for (const House& house : {House{}, near_house()}) {
      SCOPED_TRACE(way.name + std::string(" ") + std::to_string(house.distance_m));
      const double tangent = std::tan(house.grazing_deg * kPi / 180);
      const double before_m = 22, high_m = 4;
      // Seen from above its foot: the shadow ends where the line over the roof's far edge meets the ground.
      const double edge_m = house.distance_m - before_m;
      const double antenna_m = house.antenna_m().y;
      const double lit_m = house.distance_m - edge_m / (1 - high_m / antenna_m);
      const double whole_m = test::kHeight_m / (tangent - test::kHeight_m / house.distance_m);
      const RadarSettings s = test::corner_settings(house, way);
      const double open = total(test::corner_powers(house.world(), house, s, test::corner_materials()));
      World world = house.world();
      test::add_prism(world, test::rectangle(0, edge_m - 2, 60, 4), high_m);
      World only = test::made_world(21000, 500, [](double, double) { return 0.0; });
      test::add_prism(only, test::rectangle(0, edge_m - 2, 60, 4), high_m);
      only.buildings.corners = true;
      const double both = total(test::corner_powers(world, house, s, test::corner_materials()));
      const double other = total(test::corner_powers(only, house, s, test::corner_materials()));
      EXPECT_NEAR((both - other) / open, lit_m / whole_m, 0.02);
    }
  }
}

TEST(CornerPlaces, PeaksAtTheFootsRangeBehindTheRoofsLayover) {
  for (const CornerWay& way : kWays) {
    SCOPED_TRACE(way.name);
    const House house;
    RadarSettings s = test::corner_settings(house, way);
    s.range_bins = 101;  // of 3 m, the foot in the middle of one
    std::vector<Material> materials = test::corner_materials();
    materials[1].gamma = 1;  // a floor, so that roof and wall show as well
    const std::vector<double> w = test::corner_powers(house.world(), house, s, materials);
    std::vector<double> by_range(static_cast<std::size_t>(s.range_bins));
    for (std::size_t k = 0; k < w.size(); ++k) by_range[k % by_range.size()] += w[k];
    const double foot_m = house.distance_m / std::cos(house.grazing_deg * kPi / 180);
    const auto peak = std::ranges::max_element(by_range) - by_range.begin();
    const auto foot = static_cast<std::ptrdiff_t>((foot_m - s.r_min_m) / s.range_bin_m());
    EXPECT_NEAR(static_cast<double>(peak), static_cast<double>(foot), 1);
    // The roof's near edge: 8 m up, 2.7 m nearer.
    const auto first = std::ranges::find_if(by_range, [](double p) { return p > 0; }) - by_range.begin();
    EXPECT_LT(first, foot);
    EXPECT_GT(by_range[static_cast<std::size_t>(peak)], 20 * by_range[static_cast<std::size_t>(first)]);
  }
}

TEST(CornerPlaces, PhaseFollowsTheFootOverACentimetre) {
  for (const CornerWay& way : {kExact, kColumns}) {
    for (const House& house : {House{}}) {
      SCOPED_TRACE(way.name);
      RadarSettings s = test::corner_settings(house, way, 500);
      s.range_bins = 5;
      s.azimuth_bins = 1;
      s.sector_deg = 0.5;  // cells wider than the wall
      const auto scene = test::make_scene(house.world(), test::corner_materials());
      const auto look = [&](const glm::dvec3& by_m) {
        const Frame frame =
            render(scene, test::snapshot(s), test::pose_at(scene->world(), house.antenna_m() + by_m, 0),
                   {0, s.azimuth_bins});
        const auto brightest = std::ranges::max_element(frame.bins.power_w) - frame.bins.power_w.begin();
        return std::pair(std::complex<double>(frame.bins.iq[static_cast<std::size_t>(brightest)]),
                         frame.bins.power_w[static_cast<std::size_t>(brightest)]);
      };
      const glm::dvec3 foot_m(0.3, 0, house.distance_m);
      const auto [first, power] = look({0, 0, 0});
      EXPECT_NEAR(std::norm(first) / power, 1, 1e-4);  // one scatterer of unit modulus
      for (const glm::dvec3& by_m :
           {glm::dvec3(0.01, 0, 0), glm::dvec3(0, 0.01, 0), glm::dvec3(0, 0, 0.01)}) {
        const std::complex<double> moved = look(by_m).first;
        const double nearer_m =
            glm::length(house.antenna_m() - foot_m) - glm::length(house.antenna_m() + by_m - foot_m);
        const double turn = 4 * kPi * nearer_m * s.frequency_ghz * 1e9 / 299792458.0;
        const std::complex<double> wanted = first * std::polar(1.0, turn);
        EXPECT_LT(std::abs(moved - wanted) / std::abs(first), 0.01);
      }
    }
  }
}

TEST(CornerPlaces, OtherPhaseThanTheWalls) {
  // The face's own scatterer and its corner's are two.
  const World world = House{}.world();
  const SpeckleField field(world, {0, 7000, 0}, 0.03, 50, 0.02, 1);
  const glm::dvec3 at_m(0.3, 0, 20000);
  const std::uint32_t wall = world.buildings.list[0].first_face + 1;
  const Scatterer corner = field.corner(21000, at_m, wall, 1);
  const Scatterer face = field.scatterer(21000, at_m, wall, 1);
  EXPECT_NE(field.hash(corner), field.hash(face));
  EXPECT_EQ(ScattererKey(corner).scatterer(), corner);
  EXPECT_NEAR(field.reference_point(corner).y, 0, 1e-9);
  EXPECT_NEAR(std::abs(field.response(corner)), 1, 1e-9);
  const SpeckleField fine(world, {0, 7000, 0}, 0.03, 4, 0.0001, 1);
  const Scatterer cell = fine.corner(21000, at_m + glm::dvec3(5, 0, 0), wall, 1);
  EXPECT_NE(cell.level, Scatterer::kWholeFace);
  EXPECT_EQ(ScattererKey(cell).scatterer(), cell);
  EXPECT_NEAR(std::abs(fine.response(cell)), 1, 1e-9);
}

TEST(CornerPlaces, SumOverRangeBinsDoesNotDependOnThem) {
  // A wall aslant that passes through the edges of bins of 2 m, and of 50 m.
  for (const CornerWay& way : {kExact, kColumns}) {
    House house;
    house.heading_deg = 5;
    RadarSettings s = test::corner_settings(house, way);
    s.range_bins = 6;
    const double coarse = total(test::corner_powers(house.world(), house, s, test::corner_materials()));
    s.range_bins = 150;
    const std::vector<double> w = test::corner_powers(house.world(), house, s, test::corner_materials());
    EXPECT_NEAR(total(w) / coarse, 1, 1e-3) << way.name;
    EXPECT_GE(std::ranges::count_if(w, [](double p) { return p > 0; }), 2) << way.name;
  }
}

TEST(CornerPlaces, AwkwardWallsAreFiniteAndTheSameForAnyThreads) {
  // A round tower of walls of 0.3 m, a needle, a house whose front stands before a void, one on a void's
  // edge, one on a cliff, an antenna beside a wall and below roofs.
  World world = test::made_world(4000, 20, [](double x, double z) {
    const bool hole = x > 100 && x < 160 && z > 1900 && z < 1990;
    return hole ? test::kUnknown : z > 2500 ? 40 + 0.1 * x : 0.02 * z;
  });
  Ring tower = test::ellipse(6, 6, 64);
  for (glm::dvec2& p : tower) p += glm::dvec2(-200, 1800);
  test::add_prism(world, tower, 12);
  test::add_prism(world, test::rectangle(-60, 1700, 0.2, 0.2), 30);
  test::add_prism(world, test::rectangle(130, 2011, 20, 20), 9);
  test::add_prism(world, test::rectangle(170, 1950, 14, 20), 9);
  test::add_prism(world, test::rectangle(0, 2504, 30, 6), 9);
  test::add_prism(world, test::rectangle(0, 40, 60, 30), 25);
  world.buildings.corners = true;
  std::vector<Material> materials = test::two_materials();
  materials[0].rms_slope = 0.3;
  const auto scene = test::make_scene(std::move(world), materials);
  bool any = false;
  for (const double height_m : {1.0, 20.0, 300.0, 2500.0}) {
    for (const CornerWay& way : {kExact, kColumns}) {
      RadarSettings s = test::radar_settings(FrustumKind::sweep, {10, 3500, 60}, {120, 500});
      s.pixel_columns = 240;
      s.sub_columns = way.sub_columns;
      const Pose pose = test::pose_at(scene->world(), {0, height_m, 0}, 0);
      RenderOptions one, four;
      one.threads = 1;
      four.threads = 4;
      const Frame a = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, one);
      const Frame b = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, four);
      EXPECT_EQ(a.bins.power_w, b.bins.power_w);
      EXPECT_EQ(a.bins.iq, b.bins.iq);
      for (const double p : a.bins.power_w) EXPECT_TRUE(std::isfinite(p) && p >= 0);
      World off = scene->world();
      off.buildings.corners = false;
      const Frame without = render(test::make_scene(std::move(off), materials), test::snapshot(s), pose,
                                   {0, s.azimuth_bins}, one);
      EXPECT_GE(total(a.bins.power_w), total(without.bins.power_w));
      any = any || total(a.bins.power_w) > total(without.bins.power_w);
    }
  }
  EXPECT_TRUE(any);
}

TEST(CornerPlaces, FramesWithoutHousesKeepTheirBits) {
  World world =
      test::made_world(9000, 40, [](double x, double z) { return 60 * std::sin(x / 300 + z / 700); });
  World with = world;
  with.buildings.corners = true;
  const RadarSettings s = test::small_frame(FrustumKind::sweep);
  const auto frame = [&](World of) {
    const auto scene = test::make_scene(std::move(of));
    return render(scene, test::snapshot(s), test::pose_at(scene->world(), {0, 900, 0}, 0),
                  {0, s.azimuth_bins});
  };
  const Frame a = frame(world), b = frame(with);
  EXPECT_EQ(a.bins.power_w, b.bins.power_w);
  EXPECT_EQ(a.bins.iq, b.bins.iq);
}

}  // namespace
}  // namespace obliq::corners_places_test
