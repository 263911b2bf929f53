#pragma once
#include <cstddef>
#include <span>

#include "client/status.h"
#include "proto/message_header.h"
#include "proto/target_record.h"

namespace obliq::wire {
class FrameBegin;
class WedgeBlock;
class TargetBlock;
class FrameEnd;
class FrameAbort;
class ExerciseEvents;
}  // namespace obliq::wire

namespace obliq::client {

/// Receives the frames that arrive, and what else answers no call. A status that is not ok ends the client's
/// receive call with it. Called in the thread that is in a call of the client; no exception may leave it.
class FrameHandler {
 public:
  virtual ~FrameHandler() = default;
  virtual Status on_begin(const wire::MessageHeader&, const wire::FrameBegin&) { return {}; }
  /// plane: the values of the block's rectangle, coded as the block says (wire::plain_values decodes them).
  /// The coding is a possible one, and the length has been checked unless they are compressed.
  virtual Status on_block(const wire::MessageHeader&, const wire::WedgeBlock&, std::span<const std::byte>) {
    return {};
  }
  /// Where targets are, for a client that asked for truth: of a frame, of a pass of each dwell.
  virtual Status on_targets(const wire::MessageHeader&, const wire::TargetBlock&,
                            std::span<const wire::TargetRecord>) {
    return {};
  }
  virtual Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) { return {}; }
  virtual Status on_abort(const wire::MessageHeader&, const wire::FrameAbort&) { return {}; }
  /// What has happened to the exercise meanwhile (Client::get_events with `follow`).
  virtual Status on_events(const wire::ExerciseEvents&) { return {}; }
  /// The connection is gone: of a frame that has begun, no more will come.
  virtual void on_lost() {}
  /// The server refuses a pose of Client::send_pose. A status that is not ok ends the call as well.
  virtual Status on_refused_pose(const Status& /*why*/) { return {}; }
};

/// Whether a message belongs to a frame.
bool is_frame(wire::MessageType type);

/// Parses a message of a frame, wherever it comes from, checks a block's length against its rectangle and
/// hands it to the handler. bad_stream when it does not parse; otherwise what the handler returns. Messages
/// that belong to no frame are skipped.
Status dispatch_frame(const wire::MessageHeader& header, std::span<const std::byte> descriptor,
                      std::span<const std::byte> plane, FrameHandler& to);

/// What to say of a message that does not parse.
Status unreadable(const char* what);

}  // namespace obliq::client
