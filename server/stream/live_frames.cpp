#include "server/stream/live_frames.h"

#include <algorithm>
#include <utility>

namespace obliq::stream {

LiveFrame::LiveFrame(std::shared_ptr<LiveFrames> owner, std::uint64_t frame_id,
                     std::vector<std::uint64_t> takers)
    : id(frame_id), owner_(std::move(owner)), takers_(std::move(takers)) {
  std::sort(takers_.begin(), takers_.end());
  ++owner_->live_;
}

LiveFrame::~LiveFrame() { owner_->freed(); }

bool LiveFrame::is_for(std::uint64_t watch_id) const {
  return std::binary_search(takers_.begin(), takers_.end(), watch_id);
}

LiveFramePtr LiveFrames::open(std::uint64_t frame_id, std::vector<std::uint64_t> takers) {
  return std::make_shared<const LiveFrame>(shared_from_this(), frame_id, std::move(takers));
}

void LiveFrames::freed() {
  --live_;
  const std::lock_guard lock(mutex_);
  if (on_freed_) on_freed_();
}

void LiveFrames::forget_listener() {
  const std::lock_guard lock(mutex_);
  on_freed_ = nullptr;
}

}  // namespace obliq::stream
