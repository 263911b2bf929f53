#include "tests/integration/net/targets_fixture.h"

#include <sys/stat.h>

#include <thread>

#include "proto/obliq.pb.h"
#include "server/rendering/scene_renderer.h"
#include "server/security/security.h"

namespace obliq::test {

struct NetTargets::Server {
  explicit Server(const NetTargets& of)
      : renderer(of.scene_.shared(), "level"), server(renderer, {of.radar_}, of.options_) {
    thread = std::thread([this] { server.run(); });
  }
  ~Server() {
    server.stop();
    thread.join();
  }
  rendering::SceneRenderer renderer;
  net::Server server;
  std::thread thread;
};

NetTargets::NetTargets() {
  RadarSettings settings = beam_settings();
  settings.range_bins = 200;
  settings.azimuth_bins = 64;
  settings.pixel_columns = 256;
  settings.receiver.noise = true;
  radar_.name = "main";
  radar_.settings = settings;
  radar_.pose = scene_.pose().settings;
  options_ = small_options();
  options_.max_bins = 1'000'000;
  options_.max_memory_mb = 0;
}
NetTargets::~NetTargets() = default;

void NetTargets::with_tokens() {
  const std::string path = folder_.write("tokens", std::string("viewer ") + kViewer + "\ncontroller " +
                                                       kController + "\nadmin " + kAdmin + "\n");
  EXPECT_EQ(chmod(path.c_str(), 0600), 0);
  options_.security = std::make_shared<security::Security>(security::SecurityFiles{path, "", ""});
}

void NetTargets::serve() { server_ = std::make_unique<Server>(*this); }

client::Client NetTargets::connect(const std::string& token, const std::string& name) {
  client::Client made;
  EXPECT_TRUE(is_ok(made.connect({"127.0.0.1", server_->server.port()}, {.name = name, .token = token})));
  return made;
}

client::Client NetTargets::holder(const std::string& token) {
  client::Client made = connect(token, "host");
  EXPECT_TRUE(is_ok(made.claim_targets()));
  return made;
}

wire::Target NetTargets::target(std::uint64_t id, double north_m, double east_m) const {
  const Target at = scene_.at(east_m, north_m, 0);
  wire::Target message;
  message.set_id(id);
  message.set_latitude_deg(at.latitude_deg);
  message.set_longitude_deg(at.longitude_deg);
  message.set_rcs_dbsm(30);
  message.set_swerling(0);
  message.set_sim_time_ns(0);
  return message;
}

wire::SetTargets NetTargets::request_of(const std::vector<wire::Target>& targets) {
  wire::SetTargets request;
  for (const wire::Target& target : targets) *request.add_targets() = target;
  return request;
}

client::Status NetTargets::set(client::Client& client, const wire::SetTargets& request) {
  std::vector<std::string> warnings;
  return client.set_targets(request, warnings);
}

client::Status NetTargets::set(client::Client& client, const std::vector<wire::Target>& targets) {
  return set(client, request_of(targets));
}

wire::TargetList NetTargets::list_of(client::Client& client) {
  wire::TargetList list;
  EXPECT_TRUE(is_ok(client.get_targets(list)));
  list.clear_request_id();
  return list;
}

wire::RenderOnce NetTargets::frame_request(bool live, bool truth, std::int64_t sim_time_ns) const {
  wire::RenderOnce request;
  request.set_radar(radar_.name);
  request.set_as_live(true);
  request.mutable_pose()->set_sim_time_ns(sim_time_ns);
  request.add_planes(wire::POWER);
  request.set_live_targets(live);
  request.set_truth(truth);
  return request;
}

client::AssembledFrame NetTargets::render(client::Client& client, const wire::RenderOnce& request) {
  client::FrameAssembler frames(wire::plane_bit(wire::Plane::power));
  client.set_handler(&frames);
  wire::RenderOnce sent = request;
  EXPECT_TRUE(is_ok(client.render_once(sent)));
  EXPECT_TRUE(is_ok(receive_frame(client, frames)));
  client.set_handler(nullptr);
  return frames.take();
}

}  // namespace obliq::test
