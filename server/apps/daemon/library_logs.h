#pragma once

namespace obliq {

/// What libraries would write on stderr by themselves goes to the log: protobuf says there what is wrong with
/// a peer's bytes, as often as the peer likes.
void take_over_library_logs();

}  // namespace obliq
