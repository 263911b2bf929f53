// The sea changed live: frames that follow have the bits of a fresh rendering of the new settings.
#include <gtest/gtest.h>

#include <thread>

#include "proto/obliq.pb.h"
#include "server/radar/render.h"
#include "server/rendering/frame_cache.h"
#include "server/rendering/scene_renderer.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::test::sea_stream_test {
namespace {

std::shared_ptr<const Scene> sea() {
  static const auto scene = [] {
    std::vector<Material> materials = two_materials();
    materials[0].model = ScatteringModel::sea;
    materials[0].gamma = 1e-4;
    return make_scene(load_world(synthetic_spec(SyntheticKind::flat, 7000, 100)), materials);
  }();
  return scene;
}

RadarConfig radar() {
  RadarConfig radar;
  radar.name = "main";
  radar.settings = radar_settings(FrustumKind::sweep, {4000, 6000, 8}, {64, 48}, {64, 1});
  radar.settings.beam.pattern = BeamPattern::gaussian;
  radar.settings.beam.width_deg = 3;
  radar.settings.beam.extent_deg = 6;
  radar.settings.sea.shape = 0;
  radar.pose = settings_over_origin(1400, 60);
  return radar;
}

BinBlock rendered(const RadarSettings& settings) {
  std::vector<FieldError> errors;
  const auto pose = place_antenna(sea()->world(), radar().pose, errors);
  return render(sea(), snapshot(settings), *pose, {0, settings.azimuth_bins}).bins;
}

TEST(SeaStream, AStateChangedLiveIsInTheFramesThatFollow) {
  rendering::SceneRenderer renderer(sea(), "sea");
  rendering::FrameCache cache(renderer);
  net::Server server(cache, {radar()}, small_options());
  std::thread thread([&] { server.run(); });
  {
    client::Client client;
    EXPECT_TRUE(is_ok(client.connect({"127.0.0.1", server.port()}, {.name = "tester"})));
    EXPECT_TRUE(is_ok(client.claim_control("main")));
    EXPECT_TRUE(is_ok(client.subscribe("main", 100)));
    RadarSettings wanted = radar().settings;
    const auto follows = [&](const wire::RadarSettings& change) {
      wire::Ack ack;
      if (change.ByteSizeLong() > 0 && !is_ok(client.set_settings("main", change, ack))) return false;
      const BinBlock fresh = rendered(wanted);
      for (int k = 0; k < 20; ++k) {
        client::FrameAssembler frames;
        const bool received = is_ok(receive_frame(client, frames));
        client.set_handler(nullptr);  // a request takes frames, too, while it waits for its answer
        if (!received) return false;
        if (same_bits(frames.frame().power_w, fresh.power_w) && same_bits(frames.frame().iq, fresh.iq))
          return true;
      }
      return false;
    };
    EXPECT_TRUE(follows({}));
    wire::RadarSettings change;
    change.set_sea_state(3);
    wanted.sea.state = 3;
    EXPECT_TRUE(follows(change)) << "state 3";
    change.Clear();
    change.set_sea_shape(0.5);
    wanted.sea.shape = 0.5;
    EXPECT_TRUE(follows(change)) << "texture";
    change.Clear();
    change.set_sea_shape(0);
    change.set_wind_m_s(10);
    change.set_sea_state_auto(true);
    wanted.sea.shape = 0;
    wanted.atmosphere.wind_m_s = 10;
    wanted.sea.state_auto = true;
    EXPECT_TRUE(follows(change)) << "the wind's state";
    change.Clear();
    change.set_mode(wire::MTI_MODE);
    wanted.mode = RadarMode::mti;
    EXPECT_TRUE(follows(change)) << "its motion";
    change.Clear();
    change.set_sea_state(0);
    wanted.sea.state_auto = false;
    wanted.sea.state = 0;
    EXPECT_TRUE(follows(change)) << "off";
  }
  server.stop();
  thread.join();
}

}  // namespace
}  // namespace obliq::test::sea_stream_test
