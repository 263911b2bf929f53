// The same bits for any number of threads, for parts of a frame, and for sectors and bin counts at the
// edges of what is allowed.
#include "tests/support/same_bits.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "tests/support/scenes.h"

namespace obliq {
namespace {

void expect_same(const BinBlock& a, const BinBlock& b, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_EQ(a.first_azimuth, b.first_azimuth);
  test::expect_same_bits(a, b);
}

void expect_same(const FrameStats& a, const FrameStats& b, const std::string& what) {
  EXPECT_EQ(a.rays, b.rays) << what;
  EXPECT_EQ(a.hits, b.hits) << what;
  EXPECT_EQ(a.samples, b.samples) << what;
  EXPECT_EQ(a.rejected, b.rejected) << what;
  EXPECT_EQ(a.repaired, b.repaired) << what;
  EXPECT_EQ(std::memcmp(&a.covered_area_m2, &b.covered_area_m2, sizeof a.covered_area_m2), 0) << what;
}

/// Hills with a void, seen from above their tops; small enough for many frames.
class SameBits : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 12000, 50);
    spec.terrain.shape.height_m = 600;
    spec.radius_factor = 4.0 / 3;
    World world = load_world(spec);
    for (int j = 320; j < 340; ++j)
      for (int i = 250; i < 270; ++i) world.grid.y_m[world.grid.index(i, j)] = NAN;
    scene_ = test::make_scene(std::move(world));
  }
  static void TearDownTestSuite() { scene_.reset(); }

  static RadarSettings settings(FrustumKind kind, double sector_deg = 120) {
    RadarSettings s;
    s.frustum = kind;
    s.sector_deg = sector_deg;
    s.r_min_m = 2000;
    s.r_max_m = 10000;
    s.pixel_columns = 300;
    s.pixel_rows = 300;
    s.azimuth_bins = 100;
    s.range_bins = 90;
    return s;
  }
  static Frame frame(const RadarSettings& s, int threads, AzimuthRange range, double bearing_deg = 40) {
    RenderOptions options;
    options.threads = threads;
    return render(scene_, test::snapshot(s), test::pose_over_origin(scene_->world(), 1500, bearing_deg),
                  range, options);
  }
  static Frame frame(const RadarSettings& s, int threads = 2, double bearing_deg = 40) {
    return frame(s, threads, {0, s.azimuth_bins}, bearing_deg);
  }

  static std::shared_ptr<const Scene> scene_;
};
std::shared_ptr<const Scene> SameBits::scene_;

constexpr FrustumKind kKinds[] = {FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric};

TEST_F(SameBits, ComeFromOneTwoAndEightThreadsForEveryFrustumAndSpeckle) {
  for (const FrustumKind kind : kKinds) {
    for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::geometric}) {
      if (kind == FrustumKind::sweep && speckle == SpeckleKind::geometric) continue;  // has none
      RadarSettings s = settings(kind);
      s.speckle = speckle;
      const std::string what = "frustum " + std::to_string(static_cast<int>(kind)) + " speckle " +
                               std::to_string(static_cast<int>(speckle));
      const Frame one = frame(s, 1);
      EXPECT_GT(one.stats.samples, 10000u) << what;
      for (const int threads : {2, 8}) {
        const Frame many = frame(s, threads);
        expect_same(one.bins, many.bins, what + " threads " + std::to_string(threads));
        expect_same(one.stats, many.stats, what + " threads " + std::to_string(threads));
      }
      // The comparison can fail: another seed or kind is another picture.
      RadarSettings other = s;
      other.speckle_seed = 2;
      if (speckle == SpeckleKind::ground) {
        EXPECT_FALSE(test::same_bits(one.bins.iq, frame(other, 1).bins.iq)) << what;
      }
    }
  }
}

TEST_F(SameBits, ComeFromPartsOfAFrame) {
  for (const FrustumKind kind : kKinds) {
    const RadarSettings s = settings(kind);
    const Frame whole = frame(s);
    for (const AzimuthRange range :
         {AzimuthRange{0, 1}, AzimuthRange{3, 10}, AzimuthRange{8, 8}, AzimuthRange{99, 1}}) {
      const Frame part = frame(s, 2, range);
      BinBlock expected(range.first, range.count, s.range_bins);
      copy_azimuths(whole.bins, expected);
      expect_same(expected, part.bins, "azimuth " + std::to_string(range.first));
    }
  }
}

TEST_F(SameBits, ComeFromTheWholeCircleForTheSameBearings) {
  // 360 degrees in 1-degree bins, centre 40: bins 120..239 look at -20..100 degrees. The pixels of a sector
  // of 120 degrees lie elsewhere, so only the states can be compared, and rounding of the bin's bearing may
  // move a bin's edge across a mountain top.
  RadarSettings full = settings(FrustumKind::oblique, 360);
  full.pixel_columns = 720;
  full.azimuth_bins = 360;
  const Frame circle = frame(full);
  EXPECT_EQ(circle.stats.hits + circle.stats.rejected <= circle.stats.rays, true);
  RadarSettings part = settings(FrustumKind::oblique, 120);
  part.pixel_columns = 240;
  part.azimuth_bins = 120;
  const Frame sector = frame(part);
  int differ = 0;
  const auto hidden = [](std::uint8_t state) { return state >= 2; };
  for (std::size_t a = 0; a < 120; ++a)
    for (std::size_t r = 0; r < 90; ++r)
      differ +=
          hidden(circle.bins.state[(a + 120) * 90 + r]) != hidden(sector.bins.state[a * 90 + r]) ? 1 : 0;
  std::printf("    %d of 10800 bins differ\n", differ);
  EXPECT_LT(differ, 108);
}

TEST_F(SameBits, CoverEverySectorAndBinCountThatIsAllowed) {
  struct Case {
    double sector_deg, bearing_deg;
    int azimuth_bins;
  };
  for (const FrustumKind kind : kKinds) {
    for (const Case& k :
         {Case{360, 0, 360}, Case{360, 90, 1}, Case{60, 0, 64}, Case{60, 350, 7}, Case{200, 10, 33},
          Case{120, 180, 1}, Case{0.001, 45, 1}, Case{180, 270, 8}, Case{359.999, -180, 1000}}) {
      if (kind == FrustumKind::symmetric && k.sector_deg >= 180) continue;
      RadarSettings s = settings(kind, k.sector_deg);
      s.azimuth_bins = k.azimuth_bins;
      const std::string what = "frustum " + std::to_string(static_cast<int>(kind)) + " sector " +
                               std::to_string(k.sector_deg) + " bearing " + std::to_string(k.bearing_deg);
      const Frame one = frame(s, 1, k.bearing_deg);
      expect_same(one.bins, frame(s, 8, k.bearing_deg).bins, what);
      EXPECT_GT(one.stats.samples, 1000u) << what;
      std::uint64_t counted = 0;
      for (const std::uint32_t n : one.bins.count) counted += n;
      EXPECT_EQ(counted, one.stats.samples) << what;
      // A sweep has at least one plane a bin, and cuts ground and buildings elsewhere with other bins.
      if (kind == FrustumKind::sweep) continue;
      // No ray is lost between bins and none is counted twice: with rows and columns fixed, the number of
      // samples does not depend on how many bins the sector is divided into.
      RadarSettings single = s;
      single.azimuth_bins = 1;
      const Frame undivided = frame(single, 1, k.bearing_deg);
      EXPECT_EQ(one.stats.rays, undivided.stats.rays) << what;
      EXPECT_EQ(one.stats.samples, undivided.stats.samples) << what;
    }
  }
}

}  // namespace
}  // namespace obliq
