// Where bins begin and end: hits exactly on an edge, bearings at the ends of their range, the smallest and
// the largest frames. SameBits.ComeFromTheWholeCircleForTheSameBearings (tests/accuracy) covers sectors
// across north and the full circle, RaysOfEveryShape (tests/unit) and
// SameBits.CoverEverySectorAndBinCountThatIsAllowed that every pixel belongs to one bin.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/output/describe_frame.h"
#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_samples.h"
#include "tests/support/made_worlds.h"
#include "tests/support/same_bits.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::bin_edges_test {
namespace {

RadarSettings settings() {
  return test::radar_settings(FrustumKind::oblique, {1500, 6000, 60}, {12, 30}, {96, 96});
}

std::shared_ptr<const Scene> flat_scene() {
  static const auto scene = test::make_scene(test::made_world(8000, 100, [](double, double) { return 0.0; }));
  return scene;
}

std::shared_ptr<const Scene> hills_scene() {
  static const auto scene =
      test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 8000, 100)));
  return scene;
}

BinGrid grid(double r_min_m, double r_max_m, int n) {
  RadarSettings s = test::sampled(settings(), test::kSamplings[2]);
  s.r_min_m = r_min_m;
  s.r_max_m = r_max_m;
  s.range_bins = n;
  const Pose pose = test::pose_at(flat_scene()->world(), {0, 1000, 0}, 0);
  return plan_frame(flat_scene(), test::snapshot(s), pose).plan->bins();
}

TEST(HardBinEdges, ARangeExactlyOnAnEdgeBelongsToTheBinThatBeginsThere) {
  // floor((r - r_min) / spacing), exact when edges are doubles. Rounding to the nearest bin puts edges half a
  // bin away; an upper edge that counts puts r_max into a bin that is not there.
  const BinGrid bins = grid(1024, 1024 + 64 * 32.5, 64);
  for (int k = 0; k < 64; ++k) {
    const double edge = 1024 + 32.5 * k;
    EXPECT_EQ(bins.range_bin(edge), k);
    EXPECT_EQ(bins.range_bin(std::nextafter(edge, 0)), k - 1);
    EXPECT_EQ(bins.range_bin(std::nextafter(edge, HUGE_VAL)), k);
  }
  EXPECT_EQ(bins.range_bin(1024 + 64 * 32.5), -1);
  EXPECT_EQ(bins.range_bin(std::nextafter(1024 + 64 * 32.5, 0)), 63);
  for (const double out : {0.0, -1.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) EXPECT_EQ(bins.range_bin(out), -1);
}

TEST(HardBinEdges, WithEdgesThatAreNoDoublesEveryRangeIsWithinTwoRoundingsOfItsBin) {
  for (const auto& [r_min, r_max, n] : {std::tuple{3700.0, 37000.1, 1000},
                                        {0.0, 0.3, 300},
                                        {1e-3, 500e3, 8192},
                                        {499999.0, 500e3, 997},
                                        {1 / 3.0, 1000 / 7.0, 7}}) {
    const BinGrid bins = grid(r_min, r_max, n);
    const double slack = 2 * (std::nextafter(r_max, HUGE_VAL) - r_max);
    for (int k = 0; k <= 3 * n; ++k) {
      const auto third = static_cast<long double>(k) / 3;
      const auto range = static_cast<double>(r_min + third * (static_cast<long double>(r_max) - r_min) / n);
      for (const double r : {std::nextafter(range, 0), range, std::nextafter(range, HUGE_VAL)}) {
        const int bin = bins.range_bin(r);
        if (r < r_min || r >= r_max) {
          EXPECT_EQ(bin, -1);
          continue;
        }
        ASSERT_TRUE(bin >= 0 && bin < n) << r;
        const long double spacing = (static_cast<long double>(r_max) - r_min) / n;
        EXPECT_GE(r, static_cast<double>(r_min + bin * spacing) - slack);
        EXPECT_LE(r, static_cast<double>(r_min + (bin + 1) * spacing) + slack);
      }
    }
  }
}

TEST(HardBinEdges, RaysExactlyOnAnAzimuthEdgeAreCastOnceAndInTheBinThatBeginsThere) {
  // An odd number of columns and an even number of bins: the middle column looks exactly along the edge
  // between two bins.
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.pixel_columns = 33;
    s.azimuth_bins = 2;
    const Pose pose = test::pose_at(flat_scene()->world(), {0, 1000, 0}, 0);
    const Frame frame = render(flat_scene(), test::snapshot(s), pose, {0, 2});
    RadarSettings one = s;
    one.azimuth_bins = 1;
    const Frame undivided = render(flat_scene(), test::snapshot(one), pose, {0, 1});
    test::expect_sane(frame, s, flat_scene()->materials());
    if (!sampling.rays()) continue;  // its columns are cut from the bins
    EXPECT_EQ(frame.stats.samples, undivided.stats.samples);
    const PlanResult planned = plan_frame(flat_scene(), test::snapshot(s), pose);
    const auto rays = make_ray_source(planned.plan->looks_at(), {0, 2});
    const auto batch = std::make_unique<RayBatch>();
    int on_edge = 0;
    while (rays->generate(*batch)) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k) {
        if (batch->pixel[k] % 33 != 16) continue;
        ++on_edge;
        EXPECT_NEAR(batch->dir_x[k], 0, 4e-16);  // a rounding of a bearing of 30 degrees from the left edge
        EXPECT_EQ(batch->azimuth_bin[k], 1);
      }
    }
    EXPECT_GT(on_edge, 50);
  }
}

TEST(HardBinEdges, BearingsAWholeTurnApartAreOneBearing) {
  // To the bit: 360 degrees in radians has a sine of -2.4e-16, which would move rays along a grid line to its
  // other side.
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(), sampling);
    const auto frame = [&](double bearing_deg) {
      return render(hills_scene(), test::snapshot(s),
                    test::pose_over_origin(hills_scene()->world(), 1450, bearing_deg), {0, s.azimuth_bins});
    };
    for (const auto& [a, b] :
         {std::pair{0.0, 360.0}, {0.0, -360.0}, {180.0, -180.0}, {270.0, -90.0}, {10.5, -349.5}}) {
      SCOPED_TRACE(b);
      test::expect_same_bits(frame(a).bins, frame(b).bins);
    }
  }
  EXPECT_EQ(std::sin(test::pose_over_origin(flat_scene()->world(), 1000, 360).bearing_world_rad), 0);
}

TEST(HardBinEdges, OneBinHoldsTheEnergyOfAll) {
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    if (sampling.rays()) s.speckle = SpeckleKind::geometric;
    const Pose pose = test::pose_over_origin(hills_scene()->world(), 1450, 33);
    const Frame many = render(hills_scene(), test::snapshot(s), pose, {0, s.azimuth_bins});
    const double total = test::expect_sane(many, s, hills_scene()->materials()).power_w;
    s.azimuth_bins = s.range_bins = 1;
    const Frame one = render(hills_scene(), test::snapshot(s), pose, {0, 1});
    test::expect_sane(one, s, hills_scene()->materials());
    EXPECT_EQ(one.bins.count.at(0), one.stats.samples);
    // The same rays in another order: only the order of at most 9216 sums differs, 1e-12. A sweep has one
    // azimuth a bin instead of twelve and finds its own pieces.
    if (one.stats.rays == many.stats.rays && one.stats.samples == many.stats.samples) {
      EXPECT_NEAR(one.bins.power_w.at(0) / total, 1, 1e-12);
    }
    EXPECT_NEAR(one.bins.power_w.at(0) / total, 1, 0.2);
  }
}

TEST(HardBinEdges, OnePixelIsOneSampleOfTheWholeSectorsSolidAngle) {
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.pixel_columns = s.pixel_rows = 1;
    for (const int bins : {1, 7, 64}) {
      s.azimuth_bins = s.range_bins = bins;
      const Pose pose = test::pose_at(flat_scene()->world(), {3, 1000, 8}, -45);
      const Frame frame = render(flat_scene(), test::snapshot(s), pose, {0, bins});
      test::expect_sane(frame, s, flat_scene()->materials());
      if (sampling.rays()) {
        EXPECT_LE(frame.stats.rays, 1u);
      }
      EXPECT_GE(frame.stats.samples, 1u);
    }
  }
}

TEST(HardBinEdges, TheNarrowestAndTheShortestBinsThatAreAllowed) {
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    for (const auto& [sector_deg, azimuth_bins] : {std::pair{1e-6, 1}, {8192e-6, 8192}}) {
      for (const auto& [r_min, r_max] : {std::pair{5000.0, 5000.0 + 0.064}, {1500.0, 6000.0}}) {
        RadarSettings s = test::sampled(settings(), sampling);
        s.sector_deg = sector_deg;
        s.azimuth_bins = azimuth_bins;
        s.range_bins = 64;
        s.r_min_m = r_min;
        s.r_max_m = r_max;
        ASSERT_TRUE(validate(s).empty()) << validate(s).front().text();
        const Pose pose = test::pose_at(flat_scene()->world(), {3, 1000, 8}, 30);
        const Frame frame = render(flat_scene(), test::snapshot(s), pose, {0, azimuth_bins});
        const test::Totals totals = test::expect_sane(frame, s, flat_scene()->materials());
        EXPECT_EQ(totals.of_state[2] + totals.of_state[3], 0u) << "flat ground lies in every bin, lit";
        if (r_max - r_min > 1) {
          EXPECT_GT(totals.power_w, 0);
        }
      }
    }
  }
}

TEST(HardBinEdges, ASwathFromTheAntennaOnIsRenderedDescribedAndWritten) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "obliq_hard_nadir";
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    for (const double height_m : {0.001, 7.0, 1000.0}) {
      RadarSettings s = test::sampled(settings(), sampling);
      s.r_min_m = 0;
      const Pose pose = test::pose_at(flat_scene()->world(), {200, height_m, 100}, 0);
      const PlanResult planned = plan_frame(flat_scene(), test::snapshot(s), pose);
      if (!planned.plan) {
        EXPECT_TRUE(sampling.rays());
        EXPECT_EQ(planned.errors.front().field, "radar.r_min_m");
        continue;
      }
      const Frame frame = render(flat_scene(), test::snapshot(s), pose, {0, s.azimuth_bins});
      const test::Totals totals = test::expect_sane(frame, s, flat_scene()->materials());
      EXPECT_GT(totals.power_w, 0);
      wire::FrameDescriptor descriptor;
      wire::FrameSummary summary;
      describe_frame(*planned.plan, "main", "test", descriptor);
      summarise_frame(*planned.plan, frame.stats, summary);
      EXPECT_TRUE(std::isfinite(descriptor.azimuth_error_bound_rad()));
      write_frame_files(folder, descriptor, summary, frame.bins);
      EXPECT_GT(std::filesystem::file_size(folder / "ground_map.png"), 1000u);
    }
  }
  std::filesystem::remove_all(folder);
}

TEST(HardBinEdges, EightThousandBinsBothWaysAreWhole) {
  // 1.4 GB of planes. Few pixels: hardly any bin has samples and the profile decides the rest.
  RadarSettings s = test::sampled(settings(), test::kSamplings[1]);
  s.plates = PlateKind::nearest;
  s.azimuth_bins = s.range_bins = 8192;
  s.pixel_columns = s.pixel_rows = 128;
  ASSERT_TRUE(validate(s).empty());
  const Pose pose = test::pose_at(flat_scene()->world(), {3, 1000, 8}, 30);
  const Frame frame = render(flat_scene(), test::snapshot(s), pose, {0, 8192});
  const test::Totals totals = test::expect_sane(frame, s, flat_scene()->materials());
  EXPECT_EQ(totals.of_state[0] + totals.of_state[1], std::size_t{8192} * 8192) << "all of it is lit ground";
  EXPECT_GT(totals.of_state[1], 9000u);
  EXPECT_LE(totals.of_state[1], 128u * 128u);
}

TEST(HardBinEdges, TheLastWedgeOfEightThousandBinsIsThatOfEveryWayOfSampling) {
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(), sampling);
    s.azimuth_bins = s.range_bins = 8192;
    s.pixel_columns = 16384;
    s.pixel_rows = 16;
    const Pose pose = test::pose_at(flat_scene()->world(), {3, 1000, 8}, 30);
    const Frame frame = render(flat_scene(), test::snapshot(s), pose, {8184, 8});
    ASSERT_EQ(frame.bins.first_azimuth, 8184);
    std::uint64_t samples = 0;
    for (const std::uint32_t n : frame.bins.count) samples += n;
    EXPECT_EQ(samples, frame.stats.samples);
    EXPECT_GT(samples, 8u);
    for (const std::uint8_t state : frame.bins.state) EXPECT_LE(state, 1);
  }
}

}  // namespace
}  // namespace obliq::bin_edges_test
