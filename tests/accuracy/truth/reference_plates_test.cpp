// The reference renderer on lone buildings, against quadrature over each face in its own coordinates, and
// what it refuses.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "terrain/base/errors.h"
#include "tests/accuracy/reference_support.h"

namespace obliq::reference_plates_test {
namespace {

using test::add_prism;
using test::integrate_all;
using test::made_world;
using test::rectangle;
using test::view_from;

constexpr double kAgreement = 1e-3;

/// Ground that returns next to nothing, and the design's default building, without its floor.
std::vector<Material> specular() {
  Material terrain{"terrain"};
  Material building{"building"};
  building.model = ScatteringModel::geometric_optics;
  building.reflectivity = 0.5;
  building.rms_slope = 0.2;
  building.gamma = 0;
  return {terrain, building};
}

/// sigma0 of the geometric-optics model, per surface area: R2 exp(-t^2 / 2 s^2) (1 + t^2)^(5/2) / (2 s^2) is
/// per projected area, so sigma0 is that times cos(theta).
double specular_sigma0(double cos_incidence) {
  const double sec2 = 1 / (cos_incidence * cos_incidence);
  const double s2 = 0.2 * 0.2;
  return 0.5 * std::exp(-(sec2 - 1) / (2 * s2)) * std::pow(sec2, 2.5) / (2 * s2) * cos_incidence;
}

struct FaceIntegral {
  double power_w = 0;
  double solid_angle_sr = 0;
};

/// K sigma0 / r^4 over the parallelogram origin + u a + v b, u, v in 0..1, by the midpoint rule on 400 x 400
/// (error 1e-5 of the power on faces of tens of metres at a kilometre).
FaceIntegral over_face(const ReferenceView& view, const glm::dvec3& origin, const glm::dvec3& a,
                       const glm::dvec3& b) {
  constexpr int kN = 400;
  const glm::dvec3 across(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  const double area = std::sqrt(across.x * across.x + across.y * across.y + across.z * across.z);
  FaceIntegral sum;
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      const glm::dvec3 off = origin + a * ((i + 0.5) / kN) + b * ((j + 0.5) / kN) - view.antenna_m;
      const double r2 = off.x * off.x + off.y * off.y + off.z * off.z;
      const double cosine =
          std::abs(across.x * off.x + across.y * off.y + across.z * off.z) / (area * std::sqrt(r2));
      sum.power_w += test::range_constant(view) * specular_sigma0(cosine) / (r2 * r2) * area / (kN * kN);
      sum.solid_angle_sr += cosine / r2 * area / (kN * kN);
    }
  }
  return sum;
}

/// The lone building of a world against the faces that the antenna sees, all in one range bin.
void expect_faces(const char* what, const World& world, const ReferenceView& view,
                  const std::vector<FaceIntegral>& faces) {
  const ReferenceBins bins = integrate_all(world, specular(), view, {400, 0.5, 0});
  double power = 0, expected = 0, solid_angle = 0;
  for (const double w : bins.building_w) power += w;
  for (const FaceIntegral& face : faces) {
    expected += face.power_w;
    solid_angle += face.solid_angle_sr;
  }
  std::printf("    %s: power off by %.2g, solid angle by %.2g\n", what, power / expected - 1,
              bins.buildings[0].visible_sr / solid_angle - 1);
  EXPECT_NEAR(power / expected, 1, kAgreement);
  EXPECT_NEAR(bins.buildings[0].visible_sr / solid_angle, 1, kAgreement);
  // Nothing else hides it.
  EXPECT_NEAR(bins.buildings[0].unoccluded_sr / bins.buildings[0].visible_sr, 1, 1e-12);
}

World lone_prism(const Ring& corners, double height_m) {
  World world = made_world(3000, 100, [](double, double) { return 0; });
  add_prism(world, corners, height_m);
  return world;
}

TEST(ReferencePlate, RoofAtNormalIncidenceIsItsQuadrature) {
  // From 500 m over the middle of a roof 20 m up: the plate's lobe, 0.2 rms slope, is narrower than the roof.
  const World world = lone_prism(rectangle(0, 0, 300, 200), 20);
  const ReferenceView view = view_from({0, 520, 0}, 0, 360, 8, 100, 1000, 1);
  expect_faces("roof from above", world, view, {over_face(view, {-150, 20, -100}, {300, 0, 0}, {0, 0, 200})});
}

TEST(ReferencePlate, RoofAtObliqueIncidenceIsItsQuadrature) {
  // 30 degrees off nadir, below the antenna's sight of any wall: seen from inside the outline's shadow of
  // itself there is none, so the near wall is taken into the sum.
  const World world = lone_prism(rectangle(0, 600, 60, 40), 20);
  const ReferenceView view = view_from({0, 1060, 0}, 0, 20, 4, 1000, 1400, 1);
  expect_faces("roof and wall, oblique", world, view,
               {over_face(view, {-30, 20, 580}, {60, 0, 0}, {0, 0, 40}),
                over_face(view, {-30, 0, 580}, {60, 0, 0}, {0, 20, 0})});
}

TEST(ReferencePlate, WallAtNormalIncidenceIsItsQuadrature) {
  // Level with the middle of a wall 60 m high, below its roof.
  const World world = lone_prism(rectangle(0, 510, 80, 20), 60);
  const ReferenceView view = view_from({0, 30, 0}, 0, 20, 4, 400, 600, 1);
  expect_faces("wall head on", world, view, {over_face(view, {-40, 0, 500}, {80, 0, 0}, {0, 60, 0})});
}

TEST(ReferencePlate, TwoWallsAtObliqueIncidenceAreTheirQuadrature) {
  // A square prism on its corner, 20 degrees off: two walls, each at its own incidence, and the roof.
  const double turn = 25 * kDegree_rad;
  const glm::dvec2 u(30 * std::cos(turn), 30 * std::sin(turn));
  const glm::dvec2 v(-u.y, u.x);
  const glm::dvec2 near(0, 400);
  const World world = lone_prism({near, near + u, near + u + v, near + v}, 25);
  const ReferenceView view = view_from({0, 100, 0}, 0, 30, 4, 300, 600, 1);
  // The corners were rounded to float32: take them as they are.
  const auto corner = [&](std::uint32_t k) {
    return glm::dvec3(world.buildings.ring_xz_m[k].x, 0, world.buildings.ring_xz_m[k].y);
  };
  std::uint32_t nearest = 0;
  for (std::uint32_t k = 1; k < 4; ++k)
    if (corner(k).z < corner(nearest).z) nearest = k;
  const glm::dvec3 at = corner(nearest);
  const glm::dvec3 right = corner((nearest + 1) % 4) - at;
  const glm::dvec3 left = corner((nearest + 3) % 4) - at;
  expect_faces("two walls and a roof", world, view,
               {over_face(view, at, right, {0, 25, 0}), over_face(view, at, left, {0, 25, 0}),
                over_face(view, at + glm::dvec3(0, 25, 0), right, left)});
}

TEST(ReferencePlate, WallSeenEdgeOnStaysFinite) {
  // The plane of the side wall goes through the antenna: its |n . e| is 0 within rounding.
  World world = made_world(3000, 100, [](double, double) { return 0; });
  add_prism(world, {{0, 500}, {40, 500}, {40, 540}, {0, 540}}, 30);
  std::vector<Material> materials = specular();
  materials[1].gamma = 0.1;
  const ReferenceView view = view_from({0, 100, 0}, 0, 2e-9, 1, 400, 600, 10);
  const ReferenceBins bins = integrate_all(world, materials, view, {3, 1, 0});
  for (const double w : bins.building_w) EXPECT_TRUE(std::isfinite(w) && w >= 0);
  EXPECT_TRUE(std::isfinite(bins.buildings[0].visible_sr));
}

TEST(ReferenceBuildings, AnotherBuildingInFrontHidesButDoesNotChangeTheUnoccludedAngle) {
  World world = made_world(3000, 100, [](double, double) { return 0; });
  add_prism(world, rectangle(0, 1000, 40, 20), 10);
  const ReferenceView view = view_from({0, 60, 0}, 0, 10, 8, 300, 2000, 40);
  const ReferenceBins alone = integrate_all(world, specular(), view);
  // 40 m high at 500 m: the sight line over its roof falls 20 m in 500 m and meets z = 990 at 20 m: all
  // hidden.
  add_prism(world, rectangle(0, 500, 100, 20), 40);
  const ReferenceBins hidden = integrate_all(world, specular(), view);
  EXPECT_GT(alone.buildings[0].visible_sr, 0);
  EXPECT_GT(alone.buildings[0].largest_share, 0.5);
  EXPECT_EQ(hidden.buildings[0].visible_sr, 0);
  EXPECT_EQ(hidden.buildings[0].largest_share, 0);
  EXPECT_EQ(hidden.buildings[0].unoccluded_sr, alone.buildings[0].unoccluded_sr);
  EXPECT_GT(hidden.buildings[1].visible_sr, 0);
}

TEST(ReferenceBuildings, ARoofUnderTheGroundIsNotSeen) {
  // A cliff of 100 m across a long building 20 m high above its mean ground: its lower half stands 70 m out
  // of the ground, its upper half is buried.
  World world = made_world(3000, 50, [](double, double z) { return z > 1000 ? 100 : 0; });
  add_prism(world, rectangle(0, 1000, 30, 400), 20);
  ASSERT_NEAR(static_cast<double>(world.buildings.list[0].roof_y_m), 70, 1e-3);
  const ReferenceView view = view_from({0, 400, 0}, 0, 20, 8, 500, 2000, 1);
  const ReferenceBins bins = integrate_all(world, specular(), view, {100, 1, 0});
  // Visible: the near wall and the roof up to where the cliff's face passes 70 m, 35 m beyond its foot.
  const double expected = over_face(view, {-15, 0, 800}, {30, 0, 0}, {0, 70, 0}).solid_angle_sr +
                          over_face(view, {-15, 70, 800}, {30, 0, 0}, {0, 0, 235}).solid_angle_sr;
  EXPECT_NEAR(bins.buildings[0].visible_sr / expected, 1, kAgreement);
}

TEST(ReferenceBuildings, ACourtyardShowsItsWalls) {
  // From straight above a square of 100 m with a hole of 60 m: a ring of roof and the hole's four walls, lit
  // on their inside. A version that forgets holes sees a whole roof and no wall.
  World world = made_world(3000, 100, [](double, double) { return 0; });
  OutlineShaper shaper;
  const ShapedOutline shaped = shaper.shape(Polygon{{rectangle(0, 0, 100, 100), rectangle(0, 0, 60, 60)}});
  ASSERT_EQ(shaped.parts.size(), 1u);
  append_prism(world.buildings, shaped.parts[0], footing_of(world.grid, shaped.parts[0]), {20, 1, 1});
  const ReferenceView view = view_from({0, 220, 0}, 0, 360, 8, 100, 400, 1);
  const ReferenceBins bins = integrate_all(world, specular(), view, {100, 0.5, 0});
  const auto seen = [&](const glm::dvec3& origin, const glm::dvec3& a, const glm::dvec3& b) {
    return over_face(view, origin, a, b).solid_angle_sr;
  };
  const double roof =
      seen({-50, 20, -50}, {100, 0, 0}, {0, 0, 100}) - seen({-30, 20, -30}, {60, 0, 0}, {0, 0, 60});
  const double wall = seen({-30, 0, -30}, {60, 0, 0}, {0, 20, 0});
  EXPECT_NEAR(bins.buildings[0].visible_sr / (roof + 4 * wall), 1, kAgreement);
}

TEST(ReferenceBuildings, ATowerInABlockStandsOutOfItsRoof) {
  // 60 m high inside a block of 20 m: its upper 40 m and its roof show. Alone it would stand on the ground.
  World world = made_world(3000, 100, [](double, double) { return 0; });
  add_prism(world, rectangle(0, 1000, 60, 60), 20);
  add_prism(world, rectangle(0, 1000, 20, 20), 60);
  const ReferenceView view = view_from({0, 400, 0}, 0, 20, 8, 500, 2000, 1);
  const ReferenceBins bins = integrate_all(world, specular(), view, {100, 0.5, 0});
  const auto wall = [&](double from, double to) {
    return over_face(view, {-10, from, 990}, {20, 0, 0}, {0, to - from, 0}).solid_angle_sr;
  };
  const double roof = over_face(view, {-10, 60, 990}, {20, 0, 0}, {0, 0, 20}).solid_angle_sr;
  EXPECT_NEAR(bins.buildings[1].visible_sr / (wall(20, 60) + roof), 1, kAgreement);
  EXPECT_NEAR(bins.buildings[1].unoccluded_sr / (wall(0, 60) + roof), 1, kAgreement);
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReferenceRefuses, AFlatPlateMaterialByItsName) {
  World world = made_world(1000, 100, [](double, double) { return 0; });
  const ReferenceView view = view_from({0, 100, 0}, 0, 10, 1, 100, 900, 4);
  std::vector<Material> materials = specular();
  materials[1].model = ScatteringModel::flat_plate;
  // In the library but not in the world: no objection.
  EXPECT_EQ(refusal([&] { integrate_all(world, materials, view); }), "no error");
  add_prism(world, rectangle(0, 500, 10, 10), 5);
  const std::string text = refusal([&] { integrate_all(world, materials, view); });
  EXPECT_NE(text.find("\"building\""), std::string::npos) << text;
  EXPECT_NE(text.find("flat_plate"), std::string::npos) << text;
}

TEST(ReferenceRefuses, AnAntennaInTheGroundOrInABuilding) {
  World world = made_world(1000, 100, [](double, double) { return 50; });
  add_prism(world, rectangle(0, 0, 20, 20), 30);
  const auto from = [&](const glm::dvec3& antenna_m) {
    return refusal([&] { integrate_all(world, specular(), view_from(antenna_m, 0, 360, 4, 10, 900, 4)); });
  };
  EXPECT_NE(from({300, 49, 0}).find("below the ground"), std::string::npos);
  EXPECT_NE(from({0, 70, 0}).find("inside building 0"), std::string::npos);
  EXPECT_EQ(from({0, 81, 0}), "no error");
  EXPECT_EQ(from({11, 70, 0}), "no error");
}

}  // namespace
}  // namespace obliq::reference_plates_test
