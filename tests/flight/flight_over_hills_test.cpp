// The real daemon, flown out of what it has loaded.
#include <gtest/gtest.h>

#include "tests/flight/flight_run.h"
#include "tests/integration/daemon.h"

namespace obliq::test::flight_over_hills_test {
namespace {

TEST(FlightOverHills, TheGroundIsThereAllAlongTheWay) {
  const TestFolder folder;
  const std::string scene = folder.write("hills.toml", R"(
[terrain]
synthetic = "hills"
shape.height_m = 400
cell_m = 60
[earth]
radius_factor = 1.3333
[antenna]
latitude_deg = 33
longitude_deg = -99
height_m = 2500
[radar]
sector_deg = 90
r_min_m = 2600
r_max_m = 8000
[frustum]
kind = "sweep"
pixels = 64
[bins]
azimuth = 64
range = 128
[run]
threads = 1
)");
  const Daemon daemon({"--config", scene, "--port", "0", "--set", "http.enabled=false"}, folder.path());
  ASSERT_FALSE(daemon.address().empty()) << daemon.log();
  FlightOrder order;
  order.server = *client::parse_endpoint(daemon.address());
  // The first pose is where the scene was loaded. 2 km of margin at 250 m/s: a window may take 4 s.
  order.course = {33 + 8000 / 111195.0, -99, 40000, 8000};
  order.distance_m = 6000;
  order.speed_m_s = 250;
  order.frame_rate_hz = 5;
  const FlightReport report = fly(order);
  EXPECT_EQ(report.failure, "") << daemon.log();
  EXPECT_GE(report.windows, 2u) << report.text();
  // Without windows more than half would be missing in the end; with windows 2 s late, a quarter now and
  // then.
  EXPECT_GT(report.least_coverage, 0.75) << report.text();
  EXPECT_EQ(report.failures, 0u) << daemon.log();
  EXPECT_GE(report.frames, 20u);
}

}  // namespace
}  // namespace obliq::test::flight_over_hills_test
