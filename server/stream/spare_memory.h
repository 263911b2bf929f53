#pragma once
#include <cstddef>
#include <deque>
#include <mutex>

#include "proto/message_codec.h"

namespace obliq::stream {

/// Memory of blocks that have gone, for those to come: blocks of a frame are as long as those of the frame
/// before, and the system's fresh pages cost more than what is written into them. From any thread.
class SpareMemory {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;
  static constexpr std::size_t kLeastBytes = std::size_t{16} << 10;  ///< smaller ones cost malloc nothing

  /// Room for `bytes`, where some of about this length is spare; else empty.
  wire::Bytes take(std::size_t bytes);
  void give(wire::Bytes&& memory);
  /// Whether more of it is to come, and be kept; what is spare goes back to the system where not.
  void keep(bool on);
  std::size_t bytes() const;

 private:
  mutable std::mutex mutex_;
  bool keeps_ = true;
  std::deque<wire::Bytes> spare_;  ///< the newest at the end
  std::size_t bytes_ = 0;
};

}  // namespace obliq::stream
