#include "server/stream/outbox.h"

#include <algorithm>
#include <utility>

namespace obliq::net {

using wire::MessageType;

void Outbox::push_control(wire::Bytes bytes) {
  auto block = std::make_shared<Block>();
  block->bytes = std::move(bytes);
  control_.push_back(std::move(block));
}

const FrameLane* Outbox::lane(std::uint32_t stream_id) const {
  const auto at = std::find_if(lanes_.begin(), lanes_.end(),
                               [&](const FrameLane& lane) { return lane.stream_id() == stream_id; });
  return at == lanes_.end() ? nullptr : &*at;
}
FrameLane* Outbox::find(std::uint32_t stream_id) {
  return const_cast<FrameLane*>(std::as_const(*this).lane(stream_id));
}

void Outbox::open_live_lane(std::uint32_t stream_id, const StreamChoice& choice, LanePolicy policy) {
  lanes_.emplace_back(stream_id, choice, policy, frames_per_lane_);
}

void Outbox::open_once_lane(std::uint32_t stream_id, std::uint64_t request_id, const StreamChoice& choice,
                            ByteCounter counter) {
  lanes_.emplace_back(stream_id, choice, LanePolicy::once, 1).set_request(request_id, std::move(counter));
}

void Outbox::push(const BlockPtr& block, const LiveFramePtr& frame) {
  FrameLane* lane = find(block->stream_id);
  if (lane == nullptr) return;
  const std::size_t others = lane->policy() == LanePolicy::newest_wins ? queued_bytes() - lane->bytes() : 0;
  auto abort = lane->push(block, frame, live_bytes_ - std::min(live_bytes_, others));
  if (abort) push_control(std::move(*abort));
}

void Outbox::give_up(std::uint32_t stream_id, std::uint64_t frame_id, const std::string& reason) {
  FrameLane* lane = find(stream_id);
  if (lane == nullptr) return;
  auto abort = lane->give_up(frame_id, reason);
  if (abort) push_control(std::move(*abort));
}

void Outbox::close_lane(std::uint32_t stream_id, const std::string& reason) {
  FrameLane* lane = find(stream_id);
  if (lane == nullptr) return;
  // Only a frame that the client has heard of is worth a word.
  const std::uint64_t dropped = lane->dropped();
  while (lane->held() > 0) give_up(stream_id, lane->held(0).frame_id, reason);
  dropped_by_closed_ += dropped;
  lanes_.erase(lanes_.begin() + (lane - lanes_.data()));
}

void Outbox::close_all_lanes(const std::string& reason) {
  while (!lanes_.empty()) close_lane(lanes_.back().stream_id(), reason);
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
    BlockPtr block = lanes_[at].pop();
    if (!block) continue;
    next_lane_ = at + 1;
    const bool last = block->type == MessageType::frame_end || block->type == MessageType::frame_abort;
    if (last && lanes_[at].policy() == LanePolicy::once) {
      lanes_.erase(lanes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    return block;
  }
  return nullptr;
}

std::size_t Outbox::queued_messages() const {
  std::size_t n = control_.size();
  for (const FrameLane& lane : lanes_) n += lane.blocks();
  return n;
}

void Outbox::clear() {
  control_.clear();
  for (FrameLane& lane : lanes_) {
    dropped_by_closed_ += lane.dropped();
    lane.clear();
  }
  lanes_.clear();
}

std::size_t Outbox::queued_bytes() const {
  std::size_t bytes = 0;
  for (const FrameLane& lane : lanes_) bytes += lane.bytes();
  return bytes;
}

std::uint64_t Outbox::frames_dropped() const {
  std::uint64_t dropped = dropped_by_closed_;
  for (const FrameLane& lane : lanes_) dropped += lane.dropped();
  return dropped;
}

}  // namespace obliq::net
