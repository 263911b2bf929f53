#include "server/stream/outbox.h"

#include <algorithm>
#include <utility>

namespace obliq::stream {

using wire::MessageType;

void Outbox::push_control(BlockPtr message) { control_.push_back(std::move(message)); }

const FrameQueue* Outbox::queue(std::uint32_t stream_id) const {
  const auto at = std::find_if(queues_.begin(), queues_.end(),
                               [&](const FrameQueue& queue) { return queue.stream_id() == stream_id; });
  return at == queues_.end() ? nullptr : &*at;
}
FrameQueue* Outbox::find(std::uint32_t stream_id) {
  return const_cast<FrameQueue*>(std::as_const(*this).queue(stream_id));
}

void Outbox::open_live_queue(std::uint32_t stream_id, const StreamChoice& choice, QueuePolicy policy) {
  queues_.emplace_back(stream_id, choice, policy, frames_per_queue_);
}

void Outbox::open_once_queue(std::uint32_t stream_id, std::uint64_t request_id, const StreamChoice& choice,
                             ByteCounter counter) {
  queues_.emplace_back(stream_id, choice, QueuePolicy::once, 1).set_request(request_id, std::move(counter));
}

void Outbox::push(const BlockPtr& block, const LiveFramePtr& frame) {
  FrameQueue* queue = find(block->stream_id);
  if (queue == nullptr) return;
  const std::size_t others =
      queue->policy() == QueuePolicy::newest_wins ? queued_bytes() - queue->bytes() : 0;
  auto abort = queue->push(block, frame, live_bytes_ - std::min(live_bytes_, others));
  if (abort) push_control(std::move(abort));
}

void Outbox::give_up(std::uint32_t stream_id, std::uint64_t frame_id, const std::string& reason) {
  FrameQueue* queue = find(stream_id);
  if (queue == nullptr) return;
  auto abort = queue->give_up(frame_id, reason);
  if (abort) push_control(std::move(abort));
}

void Outbox::close_queue(std::uint32_t stream_id, const std::string& reason) {
  FrameQueue* queue = find(stream_id);
  if (queue == nullptr) return;
  // A frame whose FrameBegin was never sent does not count as dropped.
  const std::uint64_t dropped = queue->dropped();
  while (queue->held() > 0) give_up(stream_id, queue->held(0).frame_id, reason);
  dropped_by_closed_ += dropped;
  queues_.erase(queues_.begin() + (queue - queues_.data()));
}

void Outbox::close_all_queues(const std::string& reason) {
  while (!queues_.empty()) close_queue(queues_.back().stream_id(), reason);
}

BlockPtr Outbox::pop() {
  if (!control_.empty()) {
    BlockPtr block = std::move(control_.front());
    control_.pop_front();
    return block;
  }
  // One block from each queue in turn, so that a large frame does not keep the others waiting; but of the
  // frames that were asked for once, the oldest alone: they come one after the other.
  const auto oldest_once = std::ranges::find(queues_, QueuePolicy::once, &FrameQueue::policy);
  for (std::size_t i = 0; i < queues_.size(); ++i) {
    const std::size_t at = (next_queue_ + i) % queues_.size();
    if (queues_[at].policy() == QueuePolicy::once && &queues_[at] != &*oldest_once) continue;
    BlockPtr block = queues_[at].pop();
    if (!block) continue;
    next_queue_ = at + 1;
    const bool last = block->type == MessageType::frame_end || block->type == MessageType::frame_abort;
    if (last && queues_[at].policy() == QueuePolicy::once)
      queues_.erase(queues_.begin() + static_cast<std::ptrdiff_t>(at));
    return block;
  }
  return nullptr;
}

std::size_t Outbox::queued_messages() const {
  std::size_t n = control_.size();
  for (const FrameQueue& queue : queues_) n += queue.blocks();
  return n;
}

void Outbox::clear() {
  control_.clear();
  for (FrameQueue& queue : queues_) {
    dropped_by_closed_ += queue.dropped();
    queue.clear();
  }
  queues_.clear();
}

std::size_t Outbox::queued_bytes() const {
  std::size_t bytes = 0;
  for (const FrameQueue& queue : queues_) bytes += queue.bytes();
  return bytes;
}

std::uint64_t Outbox::frames_dropped() const {
  std::uint64_t dropped = dropped_by_closed_;
  for (const FrameQueue& queue : queues_) dropped += queue.dropped();
  return dropped;
}

}  // namespace obliq::stream
