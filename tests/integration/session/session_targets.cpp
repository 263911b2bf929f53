#include "tests/integration/session/session_targets.h"

#include "tests/integration/session/session_words.h"

namespace obliq::test {

using enum wire::MessageType;

void speak_of_targets(RecordedPeer& viewer, RecordedPeer& host) {
  viewer.ask(hello, "major: 1 minor: 2 client_name: 'viewer' token: 'viewer-token-0123456789'", welcome);
  host.ask(hello, "major: 1 minor: 2 client_name: 'host' token: 'controller-token-0123456789'", welcome);
  const std::string first =
      "id: 7 name: 'first' latitude_deg: 33.03 longitude_deg: -99.5 velocity_north_m_s: 20 "
      "sim_time_ns: 0 rcs_dbsm: 40 swerling: 0 top_m: 4";
  viewer.ask(set_targets, "clear: true", error);
  viewer.ask(get_targets, "", error);
  host.ask(set_targets, "targets { " + first + " }", error);  // not claimed
  host.ask(claim_control, "kinds: TARGETS_CLAIM", ack);
  host.ask(claim_control, "radar: 'main' kinds: TARGETS_CLAIM", error);
  host.ask(set_targets, "targets { " + first + " }", ack);
  host.ask(set_targets, "targets { id: 8 swerling: 5 latitude_deg: 33 } targets { id: 0 }", error);
  host.ask(set_targets,
           "targets { id: 8 latitude_deg: 33.02 longitude_deg: -99.51 sim_time_ns: 0 route { "
           "latitude_deg: [33.03, 33.04] longitude_deg: [-99.5, -99.51] speed_m_s: 12 loops: true } }",
           ack);
  host.ask(set_targets, "targets { id: 9 latitude_deg: 33 longitude_deg: -99 }", error);  // too many
  host.ask(set_targets, "targets { id: 7 sim_time_ns: -5 }", ack);                        // late
  host.ask(get_targets, "", target_list);
  host.ask(get_targets, "after: 7", target_list);
  viewer.ask(render_once, once("frustum: SWEEP", "planes: POWER live_targets: true truth: true"), error);
  const std::string seen =
      once("frustum: SWEEP", "planes: [IQ, POWER] live_targets: true", "height_m: 1500 sim_time_ns: 0");
  viewer.ask(render_once, seen, frame_end);
  host.ask(render_once, seen + " truth: true", frame_end);
  viewer.ask(render_once,
             once("frustum: SWEEP",
                  "planes: POWER truth: true targets { id: 3 latitude_deg: 33.03 "
                  "longitude_deg: -99.5 rcs_dbsm: 20 }"),
             frame_end);
  viewer.ask(subscribe, watch("main", "planes: POWER truth: true"), error);
  // One that stands: the radar's pose has no clock, and others would move by the server's.
  host.ask(set_targets,
           "clear: true targets { id: 8 latitude_deg: 33.02 longitude_deg: -99.49 sim_time_ns: 0 }", ack);
  host.ask(subscribe, watch("main", "planes: POWER truth: true"), frame_end);
  host.ask(unsubscribe, kMain, ack);
  host.ask(set_targets, "gone: 9 more: true", ack);
  host.ask(set_targets, "gone: 8", ack);
  host.ask(get_targets, "", target_list);
  host.ask(release_control, "kinds: TARGETS_CLAIM", ack);
}

}  // namespace obliq::test
