#pragma once
#include "tests/integration/session/session_peer.h"

namespace obliq::test {

/// Who may set targets and who may know of them, and what frames say of them.
void speak_of_targets(RecordedPeer& viewer, RecordedPeer& host);

}  // namespace obliq::test
