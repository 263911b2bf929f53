// The session whose bytes are recorded, message by message.
#include "tests/integration/session/session_script.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <optional>
#include <thread>

#include "server/net/panel.h"
#include "server/rendering/scene_renderer.h"
#include "tests/integration/net_fixture.h"
#include "tests/integration/session/session_peer.h"
#include "tests/integration/session/session_server.h"
#include "tests/integration/session/session_targets.h"
#include "tests/integration/session/session_words.h"
#include "tests/integration/web_server.h"

namespace obliq::test {
namespace {

using wire::MessageType;
using enum wire::MessageType;

class Script {
 public:
  explicit Script(Door door) : door_(door) {}

  void all() {
    with_server([](net::ServerOptions&) {},
                [&](net::Server& server, const client::Endpoint& at) {
                  RecordedPeer viewer(record_, "viewer", at, door_);
                  RecordedPeer controller(record_, "controller", at, door_);
                  RecordedPeer admin(record_, "admin", at, door_);
                  greet(viewer, controller, admin);
                  control(viewer, controller, admin);
                  live_frames(viewer, controller);
                  aborted_frames(viewer, controller);
                  single_frames(viewer);
                  end(viewer, controller, admin, server);
                });
    crew();
    events();
    targets();
    refusals();
    if (door_ == Door::tcp) damaged_bytes();
  }
  const SessionRecord& record() const { return record_; }

 private:
  /// Serves while the session lasts.
  void with_server(const std::function<void(net::ServerOptions&)>& change,
                   const std::function<void(net::Server&, const client::Endpoint&)>& session) {
    net::ServerOptions options = session_options();
    change(options);
    WebServer server(renderer_, session_radars(), options);
    try {
      session(server.server(), door_ == Door::tcp ? server.tcp() : server.web());
    } catch (const std::exception& e) {
      ADD_FAILURE() << e.what();
    }
    gate_.open();
  }

  /// A client of a server of its own.
  void alone(const std::string& title, const std::function<void(net::ServerOptions&)>& change,
             const std::function<void(RecordedPeer&)>& session) {
    record_.note("# " + title);
    with_server(change, [&](net::Server&, const client::Endpoint& at) {
      RecordedPeer peer(record_, "client", at, door_);
      session(peer);
    });
  }

  void greet(RecordedPeer& viewer, RecordedPeer& controller, RecordedPeer& admin) {
    viewer.ask(hello, "major: 1 minor: 1 client_name: 'viewer' token: 'viewer-token-0123456789'", welcome);
    controller.ask(hello, "major: 1 minor: 0 client_name: 'hand' token: 'controller-token-0123456789'",
                   welcome);
    admin.ask(hello, "major: 1 token: 'admin-token-0123456789'", welcome);
    viewer.ask(list_radars, "", radar_list);
    viewer.ask(get_radar, kMain, radar_info);
    viewer.ask(get_radar, "radar: 'none'", error);
    viewer.ask(get_status, "", status);
    viewer.ask(heartbeat, "answer_wanted: true", heartbeat);
    viewer.send(heartbeat);
    viewer.send(error, "text: 'I have had enough' number: 5");  // skipped
    viewer.ask(list_radars, "", radar_list);
    viewer.ask(query_ground, "radar: 'main' latitude_deg: [33.01, 33.02] longitude_deg: [-99.5, -99.49]",
               ground_answer);
  }

  void control(RecordedPeer& viewer, RecordedPeer& controller, RecordedPeer& admin) {
    viewer.ask(claim_control, kMain, error);
    controller.ask(set_pose, "radar: 'main' pose { bearing_deg: 1 }", error);
    controller.ask(claim_control, kMain, ack);
    admin.ask(claim_control, kMain, error);
    controller.ask(claim_control, "radar: 'scan' force: true", ack);
    controller.ask(release_control, "radar: 'scan'", ack);
    controller.ask(set_replay, "paused: true seek_s: 3", error);
    controller.ask(set_settings,
                   "radar: 'main' settings { frequency_ghz: 9.5 power_w: 100 gain_db: 30 speckle_seed: 7 "
                   "speckle: GROUND_SPECKLE plates: NEAREST_PLATES range_normalisation: true r_max_m: 5500 }",
                   ack);
    controller.ask(set_settings, "radar: 'main' settings { sector_deg: -5 pixel_rows: 0 }", error);
    controller.ask(set_settings, "radar: 'main' settings { range_bins: 5000 }", error);
    controller.ask(set_pose,
                   "radar: 'main' pose { latitude_deg: 33.001 longitude_deg: -99.501 height_m: 1200 "
                   "height_reference: GROUND bearing_deg: 75 pose_id: 9 }",
                   ack);
    viewer.ask(get_radar, kMain, radar_info);
    controller.ask(set_pose, "radar: 'main' pose { latitude_deg: 95 }", error);
    controller.ask(set_pose, "radar: 'main' pose { height_reference: DATUM height_m: -900 }", error);
    controller.ask(set_pose, "radar: 'main' pose { sim_time_ns: 2000000000 pose_id: 10 }", ack);
    controller.ask(set_pose, "radar: 'main' pose { sim_time_ns: 1000000000 pose_id: 11 }", ack);  // late
    controller.ask(get_radar, kMain, radar_info);
    controller.ask(set_pose,
                   "radar: 'main' pose { latitude_deg: 33.02 height_reference: ELLIPSOID height_m: 1500 "
                   "geoid_undulation_m: -20 pose_id: 12 valid_s: 0.001 }",
                   ack);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    controller.ask(get_radar, kMain, radar_info);  // stale
  }

  void live_frames(RecordedPeer& viewer, RecordedPeer& controller) {
    viewer.ask(subscribe, watch("main"), frame_end);
    viewer.ask(subscribe, watch("main", "iq_encoding: CI16_LE"), frame_end);  // renewed
    viewer.ask(unsubscribe, kMain, ack);
    viewer.ask(unsubscribe, kMain, error);
    controller.ask(set_pose, "radar: 'main' pose { latitude_deg: 33 pose_id: 13 valid_s: 0 }", ack);
    for (const char* choice :
         {"compression: ZSTD planes: [COUNT, STATE]", "iq_encoding: CI16_LE compression: ZSTD planes: IQ",
          "window { first_azimuth: 3 n_azimuth: 10 azimuth_step: 3 first_range: 4 range_step: 5 }",
          "planes: POWER window { first_azimuth: 8 n_range: 7 }"}) {
      viewer.ask(subscribe, watch("main", choice), frame_end);
      viewer.ask(unsubscribe, kMain, ack);
    }
    viewer.ask(subscribe, watch("main", "lossless: true"), error);
    controller.ask(subscribe, watch("main", "lossless: true planes: STATE"), frame_end);
    controller.ask(subscribe, watch("scan"), error);  // one too many
    controller.ask(unsubscribe, kMain, ack);
    viewer.ask(subscribe, "radar: 'main' rate_hz: 0", error);
    viewer.ask(subscribe, watch("main", "planes: STATE window { first_range: 24 n_azimuth: 17 }"), error);
    viewer.ask(subscribe, watch("main", "planes: STATE window { first_range: 20 }"), frame_end);
    controller.ask(set_settings, "radar: 'main' settings { range_bins: 20 }", ack);
    viewer.read(error);  // its window is gone
    viewer.ask(unsubscribe, kMain, ack);
  }

  void aborted_frames(RecordedPeer& viewer, RecordedPeer& controller) {
    gate_.close();
    viewer.ask(subscribe, watch("main", "planes: [POWER, STATE]"), wedge_block, 2);
    gate_.await_somebody();
    viewer.ask(unsubscribe, kMain, ack);
    gate_.open();
    viewer.ask(subscribe, watch("main", "planes: STATE"), frame_end);
    gate_.close();
    viewer.ask(subscribe, watch("main", "planes: STATE"), wedge_block);
    gate_.await_somebody();
    controller.ask(set_state, "radar: 'main' transmit: false", ack);
    viewer.ask(get_radar, kMain, radar_info);
    gate_.open();
    viewer.read(frame_abort);
    controller.ask(set_state, "radar: 'main' transmit: true freeze: true", ack);
    viewer.read(frame_end);
    controller.ask(set_pose, "radar: 'main' pose { bearing_deg: 100 }", ack);
    viewer.ask(subscribe, watch("main", "planes: STATE"), frame_end);  // as before
    viewer.ask(get_radar, kMain, radar_info);
    controller.ask(set_state, "radar: 'main' freeze: false", ack);
    viewer.ask(subscribe, watch("main", "planes: STATE"), frame_end);
    viewer.ask(unsubscribe, kMain, ack);
    // Not to be rendered as it is: the oblique frustum looks down.
    controller.ask(set_settings, "radar: 'main' settings { frustum: OBLIQUE }", ack);
    controller.ask(set_pose, "radar: 'main' pose { " + std::string(kLow) + " }", ack);
    viewer.ask(subscribe, watch("main"), error);
    viewer.ask(get_radar, kMain, radar_info);
    viewer.ask(unsubscribe, kMain, ack);
    controller.ask(set_settings, "radar: 'main' settings { frustum: POLAR }", error);
    controller.ask(set_settings, "radar: 'main' settings { frustum: SYMMETRIC }", ack);
    viewer.ask(subscribe, watch("main"), frame_end);
    viewer.ask(unsubscribe, kMain, ack);
  }

  void single_frames(RecordedPeer& viewer) {
    viewer.ask(render_once, once("frustum: SWEEP"), frame_end);
    viewer.ask(render_once, once("frustum: SYMMETRIC plates: NEAREST_PLATES", "iq_encoding: CI16_LE"),
               frame_end);
    viewer.ask(render_once, once("frustum: SWEEP range_normalisation: true", "compression: ZSTD"), frame_end);
    viewer.ask(render_once,
               once("frustum: SYMMETRIC speckle_seed: 5", "planes: [IQ, COUNT] window { first_azimuth: 9 }"),
               frame_end);
    viewer.ask(render_once, "radar: 'alone'", error);
    viewer.ask(render_once, once("frustum: OBLIQUE", "", kLow), error);
    viewer.ask(
        render_once,
        "settings { azimuth_bins: 1000 } pose { latitude_deg: 33 longitude_deg: -99.5 height_m: 1500 }",
        error);
    gate_.close();
    viewer.ask(render_once, once("frustum: SWEEP", "planes: STATE"), wedge_block);
    viewer.ask(render_once, once("frustum: SWEEP", "planes: STATE"), error);
    gate_.open();
    viewer.read(frame_end);
  }

  void end(RecordedPeer& viewer, RecordedPeer& controller, RecordedPeer& admin, net::Server& server) {
    viewer.ask(subscribe, watch("scan", "planes: [IQ, STATE]"), frame_end);
    viewer.read(wedge_block, 2);  // of the way back
    viewer.ask(unsubscribe, "radar: 'scan'", ack);
    net::PanelChange limit;
    limit.rate_limit_hz = 2.5;
    const net::PanelAnswer answer = server.panel().change(1, limit, kLong);
    EXPECT_EQ(answer.verdict, net::PanelVerdict::done);
    viewer.ask(get_radar, "radar: 'scan'", radar_info);
    admin.ask(claim_control, "radar: 'main' force: true", ack);
    controller.read(error);
    admin.ask(set_state, "radar: 'main' transmit: false", ack);
    // Two watchers of one frame, who see different parts of it.
    viewer.ask(subscribe, watch("main", "planes: [POWER, STATE] compression: ZSTD"), ack);
    controller.ask(
        subscribe,
        watch("main", "planes: [IQ, STATE] window { first_azimuth: 2 n_azimuth: 3 range_step: 4 }"), ack);
    admin.ask(set_state, "radar: 'main' transmit: true", ack);
    viewer.read(frame_end);
    controller.read(frame_end);
    admin.ask(set_state, "radar: 'main' transmit: false", ack);
    admin.ask(release_control, kMain, ack);
    // A frame is counted a little after its end was sent.
    const auto& panel = server.panel();
    while (panel.status(0)->frames < record_.frames_ended(1) ||
           panel.status(1)->frames < record_.frames_ended(2)) {
      server.panel().refresh();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    viewer.ask(get_status, "", status);
    server.stop();
    for (RecordedPeer* peer : {&viewer, &controller, &admin}) peer->read_to_the_end();
  }

  /// What version 1.2 added, on a server of its own.
  void crew() {
    record_.note("# One flies, one operates, and the exercise");
    with_server(
        [](net::ServerOptions&) {},
        [&](net::Server&, const client::Endpoint& at) {
          RecordedPeer viewer(record_, "viewer", at, door_);
          RecordedPeer host(record_, "controller", at, door_);
          RecordedPeer admin(record_, "admin", at, door_);
          viewer.ask(hello, "major: 1 minor: 2 client_name: 'viewer' token: 'viewer-token-0123456789'",
                     welcome);
          host.ask(hello, "major: 1 minor: 2 client_name: 'host' token: 'controller-token-0123456789'",
                   welcome);
          admin.ask(hello, "major: 1 minor: 2 client_name: 'admin' token: 'admin-token-0123456789'", welcome);
          host.ask(claim_control, "radar: 'main' kinds: POSE_CLAIM", ack);
          admin.ask(claim_control, kMain, error);
          admin.ask(claim_control, "radar: 'main' kinds: SETTINGS_CLAIM", ack);
          admin.ask(get_radar, kMain, radar_info);
          host.ask(set_pose, "radar: 'main' pose { heading_deg: 100 bearing_deg: 20 tilt_deg: -2 }", ack);
          admin.ask(set_pose, "radar: 'main' pose { bearing_deg: 30 tilt_deg: -3 }", ack);
          admin.ask(set_pose, "radar: 'main' pose { bearing_deg: 30 height_m: 5 }", error);
          host.ask(set_pose, "radar: 'main' pose { sim_time_ns: 9000000000 time_rate: 10 heading_deg: 110 }",
                   ack);
          host.ask(set_pose,
                   "radar: 'main' pose { sim_time_ns: 1000000000 new_time_line: true valid_s: 600 }", ack);
          host.ask(set_settings, "radar: 'main' settings { power_w: 3 }", error);
          host.ask(get_radar, kMain, radar_info);
          viewer.ask(get_exercise, "", exercise_state);
          viewer.ask(set_exercise, "frozen: true", error);
          host.ask(set_exercise, "frozen: true", error);
          admin.ask(load_exercise, "state { version: 2 scene_hash: 'another' }", error);
          admin.ask(set_exercise, "frozen: true", ack);
          viewer.ask(subscribe, watch("main", "planes: STATE"), frame_end);  // the still
          viewer.ask(get_radar, kMain, radar_info);
          viewer.ask(unsubscribe, kMain, ack);
          admin.ask(set_exercise, "frozen: false", ack);
          admin.ask(reset_exercise, "radar: 'none'", error);
          admin.ask(reset_exercise, kMain, ack);
          host.ask(release_control, kMain, ack);
          viewer.ask(get_radar, kMain, radar_info);
        });
  }

  /// The log of an exercise and its bookmarks, on a server of their own.
  void events() {
    record_.note("# The log of an exercise");
    with_server(
        [](net::ServerOptions&) {},
        [&](net::Server&, const client::Endpoint& at) {
          RecordedPeer viewer(record_, "viewer", at, door_);
          RecordedPeer admin(record_, "admin", at, door_);
          viewer.ask(hello, "major: 1 minor: 2 client_name: 'viewer' token: 'viewer-token-0123456789'",
                     welcome);
          admin.ask(hello, "major: 1 minor: 2 client_name: 'admin' token: 'admin-token-0123456789'", welcome);
          admin.ask(claim_control, kMain, ack);
          admin.ask(set_settings, "radar: 'main' settings { power_w: 3 }", ack);
          viewer.ask(get_events, "with_state: true", exercise_events);
          viewer.ask(add_bookmark, "text: 'mine'", error);
          admin.ask(add_bookmark, "text: ''", error);
          admin.ask(get_events, "after: 2 follow: true", exercise_events);
          admin.ask(add_bookmark, "text: 'here'", ack);
          admin.ask(get_events, "after: 2", exercise_events);
          admin.ask(release_control, kMain, ack);
        });
  }

  /// The targets of a world, on a server of its own.
  void targets() {
    record_.note("# Targets");
    with_server([](net::ServerOptions& options) { options.max_targets = 2; },
                [&](net::Server&, const client::Endpoint& at) {
                  RecordedPeer viewer(record_, "viewer", at, door_);
                  RecordedPeer host(record_, "controller", at, door_);
                  speak_of_targets(viewer, host);
                });
  }

  void refusals() {
    const std::string good = "major: 1 token: 'viewer-token-0123456789'";
    const auto to_the_end = [](MessageType type, const std::string& fields) {
      return [=](RecordedPeer& peer) {
        peer.send(type, fields);
        peer.read_to_the_end();
      };
    };
    const auto as_configured = [](net::ServerOptions&) {};
    alone(
        "a silent server", [](auto& options) { options.heartbeat_s = 0.05; },
        [&](RecordedPeer& peer) {
          peer.ask(hello, good, welcome);
          peer.read(heartbeat);
        });
    alone(
        "a silent client", [](auto& options) { options.idle_timeout_s = 0.2; }, to_the_end(hello, good));
    alone(
        "no Hello", [](auto& options) { options.handshake_timeout_s = 0.1; },
        [](RecordedPeer& peer) { peer.read_to_the_end(); });
    alone("not Hello first", as_configured, to_the_end(list_radars, ""));
    alone("no token", as_configured, to_the_end(hello, "major: 1"));
    alone("another version", as_configured, to_the_end(hello, "major: 2"));
    alone(
        "no place", [](auto& options) { options.max_clients = 0; }, to_the_end(hello, good));
    alone(
        "crowded", [](auto& options) { options.max_clients_per_address = 0; }, to_the_end(hello, good));
  }

  void damaged_bytes() {
    const auto as_configured = [](net::ServerOptions&) {};
    wire::MessageHeader header{.type = hello, .payload_length = 1, .descriptor_length = 1};
    wire::Bytes bytes(wire::kHeaderBytes + 1, std::byte{0xff});  // begins a field and does not end
    const auto refuse = [&](const std::string& title) {
      alone(title, as_configured, [&](RecordedPeer& peer) {
        peer.send_bytes("(bytes)", bytes);
        peer.read_to_the_end();
      });
    };
    const auto head = std::span(bytes).first<wire::kHeaderBytes>();
    wire::encode_header(header, head);
    refuse("a damaged message");
    header.crc = wire::message_crc(head, std::span(bytes).last(1));
    wire::encode_header(header, head);
    refuse("a message that does not parse");
    bytes[4] = std::byte{2};
    refuse("another version in the header");
    header.descriptor_length = 2;
    wire::encode_header(header, head);
    refuse("a length that cannot be");
    bytes[0] = std::byte{'X'};
    refuse("another protocol");
  }

  Gate gate_;
  GatedRenderer renderer_{gate_};
  SessionRecord record_;
  const Door door_;
};

}  // namespace

SessionRecord played_session(Door door) {
  Script script(door);
  script.all();
  return script.record();
}

}  // namespace obliq::test
