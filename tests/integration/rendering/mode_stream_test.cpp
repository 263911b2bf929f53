// Modes that look at Doppler on the wire: a frame has the bits of `obliq render`, live and once; a beam from
// a file; what RenderOnce may take; registers of the operator's console.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/net/requests/request_limits.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/render.h"
#include "server/rendering/frame_cache.h"
#include "server/rendering/scene_renderer.h"
#include "terrain/base/units.h"
#include "tests/integration/modbus/modbus_fixture.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::test::mode_stream_test {
namespace {

PoseSettings flight() {
  PoseSettings pose = settings_over_origin(1400, 60);
  pose.velocity_north_m_s = 150;
  return pose;
}

/// Dense enough that lines between its points are the curve: |g|^2 = 2^-(2 th/width)^2 (3 dB at its edges).
std::shared_ptr<const PatternCuts> gaussian_file(double width_deg) {
  auto table = std::make_shared<PatternCuts>();
  for (int k = -400; k <= 400; ++k) {
    const double off_deg = k * width_deg / 200;
    table->azimuth.angle_rad.push_back(off_deg * kDegree_rad);
    table->azimuth.gain_db.push_back(-10 * std::log10(2) * std::pow(2 * off_deg / width_deg, 2));
  }
  return table;
}

RadarConfig radar_in(RadarMode mode, bool beam_of_file = false) {
  RadarConfig radar;
  radar.name = "main";
  radar.settings = radar_settings(FrustumKind::sweep, {4000, 6000, 8}, {64, 48}, {64, 1});
  radar.settings.mode = mode;
  radar.settings.doppler.resolution_m = 20;
  radar.settings.beam.pattern = beam_of_file ? BeamPattern::file : BeamPattern::gaussian;
  radar.settings.beam.width_deg = 3;
  radar.settings.beam.extent_deg = 6;
  radar.settings.beam.file = gaussian_file(3);
  radar.pose = flight();
  return radar;
}

std::shared_ptr<const Scene> hills() {
  static const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  return scene;
}

BinBlock rendered(const RadarSettings& settings) {
  std::vector<FieldError> errors;
  const auto pose = place_antenna(hills()->world(), flight(), errors);
  RenderOptions options;
  options.threads = 2;
  return render(hills(), snapshot(settings), *pose, {0, settings.azimuth_bins}, options).bins;
}

/// A server of one radar in a mode.
class Served1 {
 public:
  explicit Served1(const RadarConfig& radar)
      : renderer_(hills(), "hills"), cache_(renderer_), server_(cache_, {radar}, small_options()) {
    thread_ = std::thread([this] { server_.run(); });
    EXPECT_TRUE(is_ok(client.connect({"127.0.0.1", server_.port()}, {.name = "tester"})));
  }
  ~Served1() {
    server_.stop();
    thread_.join();
  }

 private:
  rendering::SceneRenderer renderer_;
  rendering::FrameCache cache_;
  net::Server server_;
  std::thread thread_;

 public:
  client::Client client;
};

TEST(ModeStream, FramesOfAllModesLiveAndOnceHaveTheBitsOfObliqRender) {
  for (const RadarMode mode : {RadarMode::mti, RadarMode::dbs, RadarMode::sar})
    for (const bool beam_of_file : {false, true}) {
      const RadarConfig radar = radar_in(mode, beam_of_file);
      Served1 served(radar);
      const BinBlock wanted = rendered(radar.settings);
      ASSERT_TRUE(is_ok(served.client.subscribe("main", 100)));
      // The first is rendered, later ones are made of what is kept.
      for (int k = 0; k < 3; ++k) {
        client::FrameAssembler frames;
        ASSERT_TRUE(is_ok(receive_frame(served.client, frames)));
        expect_same_bits(frames.frame(), wanted);
      }
      served.client.set_handler(nullptr);  // a request takes frames, too, while it waits for its answer
      ASSERT_TRUE(served.client.unsubscribe("main").ok());
      wire::RadarInfo info;
      ASSERT_TRUE(served.client.get_radar("main", info).ok());
      wire::RenderOnce request;
      request.set_radar("main");
      *request.mutable_settings() = info.settings();
      *request.mutable_pose() = info.pose();
      ASSERT_TRUE(is_ok(served.client.render_once(request)));
      client::FrameAssembler once;
      ASSERT_TRUE(is_ok(receive_frame(served.client, once)));
      expect_same_bits(once.frame(), wanted);
    }
}

TEST(ModeStream, ABeamFromAFileIsTheBeamThatTheFileHas) {
  for (const RadarMode mode : {RadarMode::map, RadarMode::mti, RadarMode::dbs}) {
    const BinBlock by_formula = rendered(radar_in(mode).settings);
    const BinBlock by_file = rendered(radar_in(mode, true).settings);
    double sum = 0, off = 0;
    for (std::size_t bin = 0; bin < by_formula.power_w.size(); ++bin) {
      EXPECT_TRUE(std::isfinite(by_file.power_w[bin]));
      sum += by_formula.power_w[bin];
      off += std::abs(by_file.power_w[bin] - by_formula.power_w[bin]);
    }
    // Lines between points 0.015 degrees apart; a pattern taken one way instead of two ways is 40 % off.
    EXPECT_GT(sum, 0);
    EXPECT_LT(off / sum, 0.01) << static_cast<int>(mode);
  }
}

TEST(ModeStream, RenderOnceCountsTheRowsOfAModeInWhatItMayTake) {
  wire::RenderOnce once = once_request();
  wire::RadarSettings& wanted = *once.mutable_settings();
  wanted.set_frustum(wire::SWEEP);
  wanted.set_sector_deg(60);
  wanted.set_azimuth_bins(512);
  wanted.set_range_bins(512);
  wanted.set_r_min_m(4000);
  wanted.set_r_max_m(20'000);
  wanted.set_beam_pattern(wire::GAUSSIAN_BEAM);
  wanted.set_beam_width_deg(3);
  wanted.set_doppler_pulses(64);
  const auto cost_mb = [&](wire::RadarMode mode) {
    wanted.set_mode(mode);
    RadarConfig config;
    EXPECT_TRUE(merge_message(wanted, config.settings).empty());
    return 1e-6 *
           static_cast<double>(net::once_cost(config.settings, wire::kAllPlanes, small_options()).bytes);
  };
  const double map_mb = cost_mb(wire::MAP_MODE);
  const double dbs_mb = cost_mb(wire::DBS_MODE);
  // Rows of an eighth of a bin, for an antenna of 1,000 m/s.
  EXPECT_GT(dbs_mb, 1.5 * map_mb);
  net::ServerOptions options = small_options();
  options.max_memory_mb = std::round((map_mb + dbs_mb) / 2);
  const TestServer server(options);
  client::Client client = connect(server);
  const client::Status refused = client.render_once(once);
  EXPECT_EQ(refused.number, number(wire::ErrorNumber::over_limit)) << refused.sentence();
  EXPECT_NE(refused.text.find("max_memory_mb is " + std::to_string(std::lround(options.max_memory_mb))),
            std::string::npos)
      << refused.text;
  wanted.set_mode(wire::MAP_MODE);
  EXPECT_TRUE(is_ok(client.render_once(once)));
}

/// Two registers, the most significant word first.
std::vector<std::uint16_t> words(std::int32_t value) {
  return {static_cast<std::uint16_t>(static_cast<std::uint32_t>(value) >> 16),
          static_cast<std::uint16_t>(value & 0xffff)};
}

TEST(ModeStream, TheConsolesRegistersSetModesLive) {
  ModbusServer s;
  client::Client client = connect(s.server);
  RawMaster master(s.service.port());
  // A mode without a beam is refused as a whole, and nothing changes.
  ASSERT_EQ(master.write(338, {2}), 0);
  EXPECT_NE(master.coil(2, true), 0);
  EXPECT_EQ(info_of(client).settings().mode(), wire::MAP_MODE);
  ASSERT_EQ(master.coil(4, true), 0) << "what was staged is dropped";

  ASSERT_EQ(master.write(261, {1}), 0);  // beam.pattern
  std::vector<std::uint16_t> all{2};     // 338: dbs
  const auto add = [&](const std::vector<std::uint16_t>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add(words(150'050));  // 339: 1500.5 Hz
  add({48, 4, 3, 1});   // 341: pulses, window, canceller, clutter lock
  add(words(12'500));   // 345: resolution, 12.5 m
  add(words(7'250));    // 347: wind, 7.25 m/s
  ASSERT_EQ(all.size(), 11u);
  ASSERT_EQ(master.write(338, all), 0);
  ASSERT_EQ(master.coil(2, true), 0);
  const wire::RadarSettings set = info_of(client).settings();
  EXPECT_EQ(set.mode(), wire::DBS_MODE);
  EXPECT_EQ(set.prf_hz(), 1500.5);
  EXPECT_EQ(set.doppler_pulses(), 48);
  EXPECT_EQ(set.doppler_window(), wire::BLACKMAN_HARRIS_DOPPLER_WINDOW);
  EXPECT_EQ(set.canceller(), 3);
  EXPECT_TRUE(set.clutter_lock());
  EXPECT_EQ(set.resolution_m(), 12.5);
  EXPECT_EQ(set.wind_m_s(), 7.25);
  EXPECT_EQ(master.read(3, 338, 11), all) << "and are read again as they were written";
  for (const auto& [at, value] : {std::pair{338, 9}, {341, 1}, {343, 4}, {342, 5}}) {
    const int exception = master.write(at, {static_cast<std::uint16_t>(value)});
    const bool staged = exception == 0;
    EXPECT_TRUE(!staged || master.coil(2, true) != 0) << at;
    EXPECT_EQ(info_of(client).settings().SerializeAsString(), set.SerializeAsString()) << at;
    if (staged) {
      ASSERT_EQ(master.coil(4, true), 0);
    }
  }
}

}  // namespace
}  // namespace obliq::test::mode_stream_test
