// The bytes of a session, message by message, recorded in session_bytes.txt: every type of the protocol, the
// encodings, a scan, aborted frames, refusals. A change of the code that should not move them does not. One
// that should is recorded anew, and CHANGES.md says so:
//
//   cmake --build --preset release --target generated
//
// Clients take turns: each reads all that the server has to say before the next one speaks, and live radars
// give one frame and then rest. Not in it, as they would depend on the time: dwells missed, frames skipped or
// shed, clients that read too slowly; and TLS. The bits of the frames hold where those of frame_sums_test do.
// The recorded session (session_bytes_test) over a WebSocket: every type of the protocol, every encoding,
// every refusal, with the fields and the plane bytes that TCP has. What a client sends is written, and what
// it gets is read, by protobuf's own JSON.
#include <gtest/gtest.h>

#include <cstdlib>

#include "server/scene/embree_tracer.h"
#include "tests/integration/session/session_script.h"

namespace obliq::test::session_bytes_test {
namespace {

TEST(SessionBytes, AreThoseRecorded) {
  if (!has_isa(TracerIsa::avx2)) GTEST_SKIP() << "no session recorded without fused multiply-add";
  const SessionRecord record = played_session(Door::tcp);
  for (unsigned number = 0; number < 65536; ++number) {
    const auto type = static_cast<wire::MessageType>(number);
    const TypeFacts facts = facts_of(type);
    EXPECT_EQ(record.was_sent(type), facts.by_client) << facts.name;
    EXPECT_EQ(record.was_received(type), facts.by_server) << facts.name;
  }
  if (const char* target = std::getenv("OBLIQ_WRITE_SESSION_BYTES")) return record.write(target);
  record.compare(OBLIQ_SOURCE_DIR "/tests/integration/session/session_bytes.txt");
}

TEST(WebSocketSession, IsThatOfTcp) {
  if (!has_isa(TracerIsa::avx2)) GTEST_SKIP() << "no session recorded without fused multiply-add";
  const SessionRecord record = played_session(Door::web);
  record.compare(OBLIQ_SOURCE_DIR "/tests/integration/session/session_bytes.txt", kDamagedBytes);
}

}  // namespace
}  // namespace obliq::test::session_bytes_test
