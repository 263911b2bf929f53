#include <gtest/gtest.h>

#include "terrain/dem/source_extents.h"

namespace obliq::test {
namespace {

SourceExtents of(const std::vector<std::vector<LonLat>>& edges) {
  SourceExtents extents("terrain.dem");
  for (const auto& edge : edges) extents.add(edge);
  return extents;
}

/// One degree of longitude and latitude, at the equator.
const std::vector<LonLat> kDegree{{10, 0}, {11, 0}, {11, 1}, {10, 1}};

TEST(SourceExtents, MadeUpGroundIsEverywhere) {
  const SourceExtents made_up;
  EXPECT_TRUE(made_up.covers({123, 45}));
  EXPECT_TRUE(made_up.reaches({123, 45}, 1));
  EXPECT_EQ(made_up.share({123, 45}, 1e5), 1);
}

TEST(SourceExtents, CoverWhatLiesWithinAFileWhicheverTurnItsLongitudesAreOf) {
  const SourceExtents files = of({kDegree, {{-60, 40}, {-59, 41}}});
  EXPECT_TRUE(files.covers({10.5, 0.5}));
  EXPECT_TRUE(files.covers({370.5, 0.5}));
  EXPECT_TRUE(files.covers({-59.5, 40.5}));
  EXPECT_FALSE(files.covers({10.5, 1.01}));
  EXPECT_FALSE(files.covers({-20, 20})) << "between the files";
  EXPECT_EQ(files.text(), "terrain.dem covers longitude -60.0000 to 11.0000, latitude 0.0000 to 41.0000");
}

TEST(SourceExtents, CrossTheAntimeridian) {
  const SourceExtents files = of({{{179.5, 0}, {-179.5, 0}, {-179.5, 1}, {179.5, 1}}});
  EXPECT_TRUE(files.covers({180, 0.5}));
  EXPECT_TRUE(files.covers({-179.6, 0.5}));
  EXPECT_FALSE(files.covers({0, 0.5}));
}

TEST(SourceExtents, AreReachedFromOutsideAsFarAsTheGreatCircleSays) {
  const SourceExtents files = of({kDegree});
  // A degree of latitude at the equator of WGS84 is 110.574 km.
  EXPECT_FALSE(files.reaches({10.5, 2}, 110500));
  EXPECT_TRUE(files.reaches({10.5, 2}, 110650));
}

TEST(SourceExtents, HalfOfADiscOnTheEdgeIsCovered) {
  const SourceExtents files = of({kDegree});
  EXPECT_EQ(files.share({10.5, 0.5}, 10000), 1);
  EXPECT_EQ(files.share({50, 0.5}, 10000), 0);
  EXPECT_NEAR(files.share({10.5, 1.00001}, 10000), 0.5, 0.07)
      << "16 places on a ring: 2 of them lie on the edge";
}

TEST(SourceExtents, EndWhereTheAreaDoes) {
  SourceExtents files = of({kDegree, {{30, 0}, {31, 1}}});
  const std::vector<LonLat> area{{10.5, 0.5}, {12, 0.5}, {12, 3}};
  files.cut_to(area);
  EXPECT_TRUE(files.covers({10.75, 0.75}));
  EXPECT_FALSE(files.covers({10.25, 0.75}));
  EXPECT_FALSE(files.covers({30.5, 0.5}));
  EXPECT_EQ(files.text(),
            "terrain.dem within terrain.area covers longitude 10.5000 to 11.0000, latitude 0.5000 to 1.0000");
}

}  // namespace
}  // namespace obliq::test
