#pragma once
#include "tests/integration/session/session_peer.h"
#include "tests/integration/session/session_record.h"

namespace obliq::test {

/// Plays the session through one door. Damaged bytes are its last part, and only TCP has them: a WebSocket's
/// message is whole or is none.
SessionRecord played_session(Door door);

/// The title of that part in the record.
constexpr const char* kDamagedBytes = "# a damaged message";

}  // namespace obliq::test
