// What a request may cost obliqd and the commands that render, where nobody has set a limit.
#include <gtest/gtest.h>
#include <signal.h>

#include "client/client.h"
#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"

namespace obliq::test {
namespace {

class DaemonLimits : public testing::Test {
 protected:
  static client::Client come(const std::string& address) {
    client::Client made;
    EXPECT_TRUE(made.connect(*client::parse_endpoint(address), {.name = "tester"}).ok());
    return made;
  }
  static wire::RenderOnce request() {
    wire::RenderOnce once;
    once.mutable_pose()->set_latitude_deg(0);
    once.mutable_pose()->set_longitude_deg(0);
    once.mutable_pose()->set_height_m(1500);
    wire::RadarSettings& settings = *once.mutable_settings();
    settings.set_frustum(wire::SWEEP);
    settings.set_r_min_m(2000);
    settings.set_r_max_m(9000);
    return once;
  }

  TestFolder folder;
  const std::string scene = folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat}));
};

TEST_F(DaemonLimits, RefuseAFrameThatNoMachineHasTheMemoryFor) {
  const Daemon daemon({"--config", scene, "--port", "0"}, folder.path());
  client::Client client = come(daemon.address());
  const std::uint64_t limit_mb = client.welcome().limits().max_memory_mb();
  EXPECT_GT(limit_mb, 0u);
  wire::RenderOnce once = request();
  once.mutable_settings()->set_azimuth_bins(1);
  once.mutable_settings()->set_range_bins(8192);
  once.mutable_settings()->set_pixel_columns(16384);
  const client::Status status = client.render_once(once);
  EXPECT_EQ(status.number, static_cast<std::uint32_t>(wire::ErrorNumber::over_limit)) << status.sentence();
  EXPECT_EQ(status.text.find("max_memory_mb is " + std::to_string(limit_mb) + ": "), 0u) << status.text;
}

// Four million weights of a Taylor pattern, each for three bearings of a turning antenna: some seconds.
TEST_F(DaemonLimits, LeaveOthersServedWhileALongPlanIsMade) {
  const Daemon daemon({"--config", scene, "--port", "0"}, folder.path());
  client::Client client = come(daemon.address());
  wire::RenderOnce once = request();
  wire::RadarSettings& settings = *once.mutable_settings();
  settings.set_sector_deg(360);
  settings.set_azimuth_bins(1024);
  settings.set_range_bins(1024);
  settings.set_pixel_columns(1024);
  settings.set_scan_mode(wire::CIRCULAR_SCAN);
  settings.set_beam_pattern(wire::TAYLOR_BEAM);
  settings.set_beam_width_deg(0.0879);
  settings.set_beam_extent_deg(180);
  settings.set_pulse_kind(wire::RECTANGULAR_PULSE);
  settings.set_pulse_length_us(0.0058);
  settings.set_pulse_extent_bins(1);
  const client::Status asked = client.render_once(once);
  ASSERT_TRUE(asked.ok()) << asked.sentence();
  client::Client other = come(daemon.address());
  wire::RadarList radars;
  EXPECT_TRUE(other.list_radars(radars).ok());
  EXPECT_TRUE(client.list_radars(radars).ok());
  const std::string log = daemon.log();
  const std::size_t at = log.find("HTTP on ");
  ASSERT_NE(at, std::string::npos);
  const std::string http = log.substr(at + 8, log.find(": /", at) - at - 8);
  EXPECT_EQ(http_get(port_of(http), "/healthz").status, 200);
}

TEST_F(DaemonLimits, HoldForACommandThatRendersAsWell) {
  const std::vector<std::string> one_bin = {"render", scene,
                                            "--out",  (folder / "frame").string(),
                                            "--set",  "bins.azimuth=1",
                                            "--set",  "bins.range=8192",
                                            "--set",  "frustum.pixel_columns=16384",
                                            "--set",  "frustum.kind=sweep"};
  const Outcome refused = run_program(OBLIQ_PROGRAM, one_bin, folder.path());
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("server.max_memory_mb is "), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--set server.max_memory_mb=MB"), std::string::npos) << refused.err;
  const auto render = [&](const std::string& limit) {
    return run_program(
        OBLIQ_PROGRAM,
        {"render", scene, "--out", (folder / "frame").string(), "--set", "server.max_memory_mb=" + limit},
        folder.path());
  };
  EXPECT_EQ(render("1").code, 1);
  EXPECT_EQ(render("inf").code, 0);
}

}  // namespace
}  // namespace obliq::test
