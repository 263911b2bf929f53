// A beam over real mountains against the reference renderer, which integrates each facet with the beam at its
// own elevation. The elevation models are not part of the project: without them, skipped.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <ostream>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/radar_truth.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::mountain_beam_test {
namespace {

struct Mountains {
  const char* name;
  const char* dem;
  double posts_m;
  double longitude_deg, latitude_deg, height_m, bearing_deg;  // of the antenna
  /// From where on a beam is not so wide at the lowest ground that truth must go all round.
  double r_min_m;
  double r_max_m;
  /// Wanted of a frame of `standard`, dB.
  double median_db, percentile95_db;
};
void PrintTo(const Mountains& value, std::ostream* out) { *out << value.name; }

/// A fan behind 3 degrees for posts of 30 m, a pencil behind 2 degrees for those of 200 m and more.
RadarSettings radar_over(const Mountains& m) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sub_columns = 64;
  s.sector_deg = 60;
  s.azimuth_bins = 256;
  s.pixel_columns = 512;
  s.range_bins = 256;
  s.r_min_m = m.r_min_m;
  s.r_max_m = m.r_max_m;
  if (m.posts_m < 100) {
    s.beam.pattern = BeamPattern::gaussian;
    s.beam.width_deg = 3;
    s.beam.elevation = ElevationPattern::cosecant;
    s.beam.elevation_width_deg = 6;
    s.beam.cosecant_to_deg = 60;
    s.pulse.kind = PulseKind::rectangular;
    s.pulse.length_us = 0.5;
  } else {
    s.beam.pattern = BeamPattern::uniform;
    s.beam.width_deg = 2;
    s.beam.elevation = ElevationPattern::gaussian;
    s.beam.elevation_width_deg = 25;
    s.pulse.kind = PulseKind::compressed;
    s.pulse.window = PulseWindow::hann;
    s.pulse.bandwidth_mhz = 1.5;
    s.pulse.length_us = 10;
  }
  return s;
}

std::shared_ptr<const Scene> scene_of(const Mountains& m, const std::string& dem) {
  WorldSpec spec = test::scene(m.longitude_deg, m.latitude_deg, m.r_max_m + 1000, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.terrain.cell_m = std::min(m.posts_m, 60.0);
  return test::make_scene(load_world(spec));
}

class BeamOver : public testing::TestWithParam<Mountains> {
 protected:
  void SetUp() override {
    const Mountains& m = GetParam();
    const std::string dem = test::shared_file(m.dem);
    if (dem.empty()) GTEST_SKIP() << test::no_shared_file(m.dem);
    scene_ = scene_of(m, dem);
    PoseSettings at;
    at.longitude_deg = m.longitude_deg;
    at.latitude_deg = m.latitude_deg;
    at.height_m = m.height_m;
    at.bearing_deg = m.bearing_deg;
    at.tilt_deg = -12;
    std::vector<FieldError> errors;
    const auto pose = place_antenna(scene_->world(), at, errors);
    ASSERT_TRUE(pose) << all_text(errors);
    pose_ = *pose;
  }

  /// On every eighth wedge.
  BinErrors errors_of(const RadarSettings& s) const {
    AzimuthRuns runs;
    for (int first = 0; first + 8 <= s.azimuth_bins; first += 64) runs.push_back({first, 8});
    const PlanResult planned = plan_frame(scene_, test::snapshot(s), pose_);
    EXPECT_TRUE(planned.plan) << all_text(planned.errors);
    const TruthBins truth = integrate_radar_truth(*planned.plan, runs, {16, 4, 2});
    const Frame frame = render(scene_, test::snapshot(s), pose_, {0, s.azimuth_bins});
    const BinErrors errors =
        bin_errors(power_of_runs(frame.bins, runs), truth.power_w(Returns::all), range_bins(s));
    std::printf("    %s, %d planes a bin: total %+.2f %%, median %.3f dB, 95 %% %.3f dB, E %.4f, %llu lit\n",
                GetParam().name, s.pixel_columns / s.azimuth_bins, 100 * errors.energy_error(),
                errors.median_db, errors.percentile95_db, errors.power_error,
                static_cast<unsigned long long>(errors.lit));
    return errors;
  }

  std::shared_ptr<const Scene> scene_;
  Pose pose_;
};

TEST_P(BeamOver, FramesAreRightInAllAndByBin) {
  const BinErrors errors = errors_of(radar_over(GetParam()));
  EXPECT_NEAR(errors.energy_error(), 0, 0.003);
  EXPECT_LT(errors.median_db, GetParam().median_db);
  EXPECT_LT(errors.percentile95_db, GetParam().percentile95_db);
}

// With so many planes, and bins that are short against the pulse, what is left is the beam's part.
TEST_P(BeamOver, TheBeamsOwnPartIsSmall) {
  RadarSettings s = radar_over(GetParam());
  s.sub_columns = 0;
  s.pixel_columns = 8 * s.azimuth_bins;
  s.range_bins *= 4;
  const BinErrors errors = errors_of(s);
  EXPECT_NEAR(errors.energy_error(), 0, 0.003);
  EXPECT_LT(errors.percentile95_db, 0.15);
}

INSTANTIATE_TEST_SUITE_P(RealGround, BeamOver,
                         testing::Values(Mountains{"Lost River Range", "windninja_usfs/mackay.tif", 30,
                                                   -113.60, 43.80, 5000, 0, 5200, 20'000, 0.06, 0.8},
                                         Mountains{"Presidential Range", "nh_gridfloat_ned/PresRange_1as.flt",
                                                   30, -71.31, 44.22, 3000, 0, 3500, 10'000, 0.06, 0.8},
                                         Mountains{"Rocky Mountain Park", "small/rmnp-dem.tif", 232, -105.70,
                                                   40.19, 7000, 0, 5700, 24'000, 0.13, 1.9},
                                         Mountains{"Lost River Range at 300 m",
                                                   "windninja_usfs/some_nodata.tif", 300, -113.60, 43.80,
                                                   5500, 0, 5700, 22'000, 0.13, 1.9}));

}  // namespace
}  // namespace obliq::mountain_beam_test
