#include "server/net/outbox.h"

#include <algorithm>
#include <utility>

#include "proto/obliq.pb.h"

namespace obliq::net {

using wire::MessageType;

void Outbox::push_control(wire::Bytes bytes) {
  auto block = std::make_shared<Block>();
  block->bytes = std::move(bytes);
  control_.push_back(std::move(block));
}

const Outbox::Lane* Outbox::find(std::uint32_t stream_id) const {
  const auto at = std::find_if(lanes_.begin(), lanes_.end(),
                               [&](const Lane& lane) { return lane.stream_id == stream_id; });
  return at == lanes_.end() ? nullptr : &*at;
}
Outbox::Lane* Outbox::find(std::uint32_t stream_id) {
  return const_cast<Lane*>(std::as_const(*this).find(stream_id));
}

void Outbox::open_live_lane(std::uint32_t stream_id, wire::PlaneSet planes) {
  Lane& lane = lanes_.emplace_back();
  lane.stream_id = stream_id;
  lane.planes = planes;
}

void Outbox::open_once_lane(std::uint32_t stream_id, std::uint64_t request_id, ByteCounter counter) {
  Lane& lane = lanes_.emplace_back();
  lane.stream_id = stream_id;
  lane.live = false;
  lane.request_id = request_id;
  lane.counter = std::move(counter);
}

void Outbox::push(const BlockPtr& block) {
  Lane* lane = find(block->stream_id);
  if (lane == nullptr) return;
  if (block->type == MessageType::frame_begin) return begin_frame(*lane, block);
  const auto frame = std::find_if(lane->frames.begin(), lane->frames.end(), [&](const QueuedFrame& queued) {
    return queued.frame_id == block->frame_id;
  });
  if (frame == lane->frames.end()) return;
  const auto index = static_cast<std::size_t>(frame - lane->frames.begin());
  if (block->type == MessageType::wedge_block) {
    if (!(lane->planes & block->planes)) return;
    if (lane->live && bytes_ + block->bytes.size() > live_bytes_) {
      ++frames_dropped_;
      if (frame->begun) return abort(*lane, index, "the client reads too slowly");
      return drop(*lane, index);
    }
  } else {
    frame->complete = true;
    // Nobody need hear of the end of a frame that he has not heard of.
    if (lane->live && block->type == MessageType::frame_abort && !frame->begun) return drop(*lane, index);
  }
  enqueue(*frame, block);
}

void Outbox::begin_frame(Lane& lane, const BlockPtr& block) {
  if (lane.live) {
    if (lane.planes & ~block->planes) return;
    if (lane.frames.size() >= static_cast<std::size_t>(frames_per_lane_)) {
      ++frames_dropped_;
      const auto waiting = std::find_if(lane.frames.begin(), lane.frames.end(),
                                        [](const QueuedFrame& frame) { return !frame.begun; });
      if (waiting == lane.frames.end()) return;
      drop(lane, static_cast<std::size_t>(waiting - lane.frames.begin()));
    }
  }
  lane.frames.emplace_back();
  lane.frames.back().frame_id = block->frame_id;
  enqueue(lane.frames.back(), block);
}

void Outbox::enqueue(QueuedFrame& frame, const BlockPtr& block) {
  frame.blocks.push_back(block);
  bytes_ += block->bytes.size();
}

void Outbox::release(Lane& lane, const Block& block) {
  bytes_ -= block.bytes.size();
  if (lane.counter) *lane.counter -= block.bytes.size();
}

void Outbox::drop(Lane& lane, std::size_t index) {
  const auto at = lane.frames.begin() + static_cast<std::ptrdiff_t>(index);
  for (const BlockPtr& block : at->blocks) release(lane, *block);
  lane.frames.erase(at);
}

void Outbox::abort(Lane& lane, std::size_t index, const std::string& reason) {
  const QueuedFrame& frame = lane.frames[index];
  wire::FrameAbort message;
  message.set_frame_id(frame.frame_id);
  message.set_request_id(lane.request_id);
  message.set_reason(reason);
  // The encoder numbers a frame's last message after all its blocks, so this number is free for this client.
  const wire::Addressing addressing{lane.stream_id, frame.last_sequence + 1, wire::utc_now_ns()};
  push_control(wire::encode_message(MessageType::frame_abort, addressing, message));
  drop(lane, index);
}

void Outbox::close_lane(std::uint32_t stream_id, const std::string& reason) {
  Lane* lane = find(stream_id);
  if (lane == nullptr) return;
  while (!lane->frames.empty()) {
    if (lane->frames.front().begun) {
      abort(*lane, 0, reason);
    } else {
      drop(*lane, 0);
    }
  }
  lanes_.erase(lanes_.begin() + (lane - lanes_.data()));
}

void Outbox::close_all_lanes(const std::string& reason) {
  while (!lanes_.empty()) close_lane(lanes_.back().stream_id, reason);
}

BlockPtr Outbox::pop_lane(Lane& lane) {
  if (lane.frames.empty() || lane.frames.front().blocks.empty()) return nullptr;
  QueuedFrame& frame = lane.frames.front();
  BlockPtr block = std::move(frame.blocks.front());
  frame.blocks.pop_front();
  frame.begun = true;
  frame.last_sequence = block->sequence;
  release(lane, *block);
  if (frame.complete && frame.blocks.empty()) lane.frames.pop_front();
  return block;
}

BlockPtr Outbox::pop() {
  if (!control_.empty()) {
    BlockPtr block = std::move(control_.front());
    control_.pop_front();
    return block;
  }
  // One block from each lane in turn, so that a large frame does not keep the others waiting.
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    const std::size_t at = (next_lane_ + i) % lanes_.size();
    BlockPtr block = pop_lane(lanes_[at]);
    if (!block) continue;
    next_lane_ = at + 1;
    const bool last = block->type == MessageType::frame_end || block->type == MessageType::frame_abort;
    if (last && !lanes_[at].live) lanes_.erase(lanes_.begin() + static_cast<std::ptrdiff_t>(at));
    return block;
  }
  return nullptr;
}

std::size_t Outbox::queued_messages() const {
  std::size_t n = control_.size();
  for (const Lane& lane : lanes_) {
    for (const QueuedFrame& frame : lane.frames) n += frame.blocks.size();
  }
  return n;
}

void Outbox::clear() {
  control_.clear();
  for (Lane& lane : lanes_) {
    while (!lane.frames.empty()) drop(lane, 0);
  }
  lanes_.clear();
}

}  // namespace obliq::net
