#pragma once
#include <cstdint>

namespace obliq::wire {

/// The `type` field of the header. PROTOCOL.md says who sends which and what answers it. A receiver skips
/// the numbers it does not know. Numbers are never reused; ADD_A_MESSAGE.md says which are free.
enum class MessageType : std::uint16_t {
  hello = 1,
  welcome = 2,
  ack = 3,
  error = 4,
  heartbeat = 5,

  list_radars = 16,
  radar_list = 17,
  get_radar = 18,
  radar_info = 19,
  claim_control = 20,
  release_control = 21,
  set_settings = 22,
  set_pose = 23,
  subscribe = 24,
  unsubscribe = 25,
  render_once = 26,
  get_status = 27,
  status = 28,
  set_state = 29,
  query_ground = 30,
  ground_answer = 31,
  set_replay = 32,
  replay_state = 33,
  set_targets = 34,
  get_targets = 35,
  target_list = 36,

  reset_exercise = 37,
  get_exercise = 38,
  exercise_state = 39,
  load_exercise = 40,
  set_exercise = 41,
  get_events = 42,
  exercise_events = 43,
  add_bookmark = 44,

  frame_begin = 48,
  wedge_block = 49,
  frame_end = 50,
  frame_abort = 51,
  target_block = 52,
};

}  // namespace obliq::wire
