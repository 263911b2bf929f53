#include "server/stream/spare_memory.h"

#include <algorithm>
#include <utility>

namespace obliq::stream {

wire::Bytes SpareMemory::take(std::size_t bytes) {
  if (bytes < kLeastBytes) return {};
  const std::lock_guard lock(mutex_);
  const auto at = std::find_if(spare_.rbegin(), spare_.rend(), [&](const wire::Bytes& memory) {
    return memory.capacity() >= bytes && memory.capacity() - bytes <= bytes / 4;
  });
  if (at == spare_.rend()) return {};
  wire::Bytes memory = std::move(*at);
  bytes_ -= memory.capacity();
  spare_.erase(std::next(at).base());
  return memory;
}

void SpareMemory::give(wire::Bytes&& memory) {
  if (memory.capacity() < kLeastBytes || memory.capacity() > kMostBytes) return;
  std::deque<wire::Bytes> old;  // freed without the lock
  const std::lock_guard lock(mutex_);
  if (!keeps_) return;
  bytes_ += memory.capacity();
  spare_.push_back(std::move(memory));
  while (bytes_ > kMostBytes) {
    bytes_ -= spare_.front().capacity();
    old.push_back(std::move(spare_.front()));
    spare_.pop_front();
  }
}

void SpareMemory::keep(bool on) {
  std::deque<wire::Bytes> old;
  const std::lock_guard lock(mutex_);
  keeps_ = on;
  if (on) return;
  old.swap(spare_);
  bytes_ = 0;
}

std::size_t SpareMemory::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace obliq::stream
