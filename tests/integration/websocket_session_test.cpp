// The recorded session (session_bytes_test) over a WebSocket: every type of the protocol, every encoding,
// every refusal, with the fields and the plane bytes that TCP has. What a client sends is written, and what
// it gets is read, by protobuf's own JSON.
#include <gtest/gtest.h>

#include "server/scene/embree_tracer.h"
#include "tests/integration/session_script.h"

namespace obliq::test {
namespace {

TEST(WebSocketSession, IsThatOfTcp) {
  if (!has_isa(TracerIsa::avx2)) GTEST_SKIP() << "no session recorded without fused multiply-add";
  const SessionRecord record = played_session(Door::web);
  record.compare(OBLIQ_SOURCE_DIR "/tests/integration/session_bytes.txt", kDamagedBytes);
}

}  // namespace
}  // namespace obliq::test
