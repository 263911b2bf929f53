#include "server/stream/frame_queue.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::stream {

using wire::MessageType;

FrameQueue::FrameQueue(std::uint32_t stream_id, StreamChoice choice, QueuePolicy policy, int most_frames)
    : stream_id_(stream_id),
      choice_(std::move(choice)),
      policy_(policy),
      most_frames_(static_cast<std::size_t>(most_frames)) {}

void FrameQueue::set_request(std::uint64_t request_id, ByteCounter counter) {
  request_id_ = request_id;
  counter_ = std::move(counter);
}

bool FrameQueue::wants(const Block& block) const {
  switch (block.type) {
    case MessageType::frame_begin:
      return block.format.window == choice_.format.window && (choice_.planes & ~block.planes) == 0;
    case MessageType::wedge_block: {
      if (!(choice_.planes & block.planes)) return false;
      // A block is of one plane.
      return block.format ==
             choice_.format.of_plane(static_cast<wire::Plane>(std::countr_zero(block.planes)));
    }
    case MessageType::target_block:
      return choice_.truth;
    default:
      return true;
  }
}

BlockPtr FrameQueue::push(const BlockPtr& block, const LiveFramePtr& frame, std::size_t most_bytes) {
  if (!wants(*block)) return nullptr;
  if (block->type == MessageType::frame_begin) {
    begin_frame(block, frame);
    return nullptr;
  }
  const auto at = std::find_if(frames_.begin(), frames_.end(),
                               [&](const QueuedFrame& queued) { return queued.id == block->frame_id; });
  if (at == frames_.end()) return nullptr;
  const bool newest_wins = policy_ == QueuePolicy::newest_wins;
  if (block->type == MessageType::wedge_block || block->type == MessageType::target_block) {
    if (newest_wins && bytes_ + block->memory() > most_bytes)
      return give_up(at, "the client reads too slowly");
  } else {
    at->complete = true;
    // Drop the FrameAbort of a frame whose FrameBegin was never sent.
    if (policy_ != QueuePolicy::once && block->type == MessageType::frame_abort && !at->begun) {
      drop(at);
      return nullptr;
    }
  }
  enqueue(*at, block);
  return nullptr;
}

void FrameQueue::begin_frame(const BlockPtr& block, const LiveFramePtr& frame) {
  if (policy_ == QueuePolicy::newest_wins && frames_.size() >= most_frames_) {
    const auto waiting =
        std::find_if(frames_.begin(), frames_.end(), [](const QueuedFrame& queued) { return !queued.begun; });
    ++dropped_;
    ++skipped_;
    if (waiting == frames_.end()) return;
    drop(waiting);
  }
  QueuedFrame& queued = frames_.emplace_back();
  queued.id = block->frame_id;
  queued.alive = frame;
  queued.since = Clock::now();
  if (frames_.size() == 1) last_progress_ = queued.since;
  enqueue(queued, block);
}

void FrameQueue::enqueue(QueuedFrame& frame, const BlockPtr& block) {
  frame.blocks.push_back(block);
  bytes_ += block->memory();
}

void FrameQueue::release(const Block& block) {
  bytes_ -= block.memory();
  if (counter_) *counter_ -= block.memory();
}

void FrameQueue::drop(Frames::iterator at) {
  for (const BlockPtr& block : at->blocks) release(*block);
  frames_.erase(at);
}

BlockPtr FrameQueue::give_up(Frames::iterator at, const std::string& reason) {
  ++dropped_;
  BlockPtr abort;
  if (at->begun) {
    wire::FrameAbort message;
    message.set_frame_id(at->id);
    message.set_request_id(request_id_);
    message.set_reason(reason);
    // The encoder numbers a frame's last message after all its blocks, so this number is free for this
    // client.
    abort = block_for_one(MessageType::frame_abort, {stream_id_, at->last_sequence + 1, wire::utc_now_ns()},
                          message, choice_.as_json);
  } else {
    ++skipped_;
  }
  drop(at);
  return abort;
}

BlockPtr FrameQueue::give_up(std::uint64_t frame_id, const std::string& reason) {
  const auto at = std::find_if(frames_.begin(), frames_.end(),
                               [&](const QueuedFrame& queued) { return queued.id == frame_id; });
  return at == frames_.end() ? nullptr : give_up(at, reason);
}

FrameQueue::Held FrameQueue::held(std::size_t index) const {
  const QueuedFrame& frame = frames_[index];
  return {frame.id, frame.begun, frame.since};
}

BlockPtr FrameQueue::pop() {
  if (frames_.empty() || frames_.front().blocks.empty()) return nullptr;
  QueuedFrame& frame = frames_.front();
  BlockPtr block = std::move(frame.blocks.front());
  frame.blocks.pop_front();
  frame.begun = true;
  frame.last_sequence = block->sequence;
  last_progress_ = Clock::now();
  release(*block);
  if (frame.complete && frame.blocks.empty()) frames_.pop_front();
  if (block->type == MessageType::frame_begin && skipped_ > 0) block = with_skipped(block);
  return block;
}

// The one message that differs from client to client.
BlockPtr FrameQueue::with_skipped(const BlockPtr& shared) {
  wire::MessageView view;
  wire::FrameBegin message;
  if (wire::decode_message(shared->bytes, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok ||
      !wire::parse_descriptor(view.descriptor, message)) {
    return shared;  // not one of our encoder's
  }
  message.set_frames_skipped(message.frames_skipped() + std::exchange(skipped_, 0));
  return block_for_one(shared->type, {shared->stream_id, shared->sequence, view.header.utc_ns}, message,
                       choice_.as_json);
}

std::size_t FrameQueue::blocks() const {
  std::size_t n = 0;
  for (const QueuedFrame& frame : frames_) n += frame.blocks.size();
  return n;
}

void FrameQueue::clear() {
  while (!frames_.empty()) drop(frames_.begin());
}

}  // namespace obliq::stream
