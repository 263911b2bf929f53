#pragma once
#include <cstdint>

namespace obliq::wire {

/// Stable numbers of the Error message; the text may change, the number may not. Those below 100 end the
/// connection.
enum class ErrorNumber : std::uint32_t {
  none = 0,
  bad_magic = 1,               ///< the bytes are not an obliq stream
  version_mismatch = 2,        ///< another major version
  bad_length = 3,              ///< header, protobuf or payload length out of limits
  bad_crc = 4,                 ///< damaged on the way
  bad_message = 5,             ///< the protobuf part does not parse
  handshake_expected = 6,      ///< the first message was not Hello
  timed_out = 7,               ///< no Hello, or the rest of a message, in time
  too_many_clients = 8,        ///< the server's limit is reached
  server_stopping = 9,         ///< the server is going down in good order
  reads_too_slowly = 10,       ///< nothing was read for longer than the server waits
  token_refused = 11,          ///< no token, or one that the server does not know
  tls_required = 12,           ///< the port speaks TLS only; comes without it
  idle = 13,                   ///< nothing came for longer than the server waits
  too_many_from_address = 14,  ///< limit `max_clients_per_address`
  invalid_value = 100,         ///< see the list of fields
  unknown_radar = 101,
  controlled_by_other = 102,     ///< another client holds control; the text names it
  not_in_control = 103,          ///< claim control first
  too_many_renders = 104,        ///< limit `max_renders_queued`
  too_many_subscriptions = 105,  ///< limit `max_subscriptions`
  render_failed = 106,           ///< the frame could not be rendered
  not_subscribed = 107,
  role_too_low = 108,          ///< the text names the role needed
  over_limit = 109,            ///< the text names the limit
  window_outside_frame = 110,  ///< new settings of the radar leave no bin of a subscription's window
  replay_only = 125,           ///< the server replays a recording: nothing can be changed or rendered
  not_a_replay = 126,          ///< SetReplay to a server whose radars are live
};

}  // namespace obliq::wire
