#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/net/block.h"
#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
class WedgeBlock;
}  // namespace obliq::wire

namespace obliq::net {

/// Monotonic time in nanoseconds; only differences mean anything.
std::int64_t monotonic_ns();

struct FrameIdentity {
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t request_id = 0;  ///< of a RenderOnce, else 0
  wire::PlaneSet planes = wire::kAllPlanes;
  std::int64_t pose_received_ns = 0;
};

/// Turns one frame into messages. `sequence` counts on across the frames of a stream. For one thread at a
/// time.
class FrameEncoder {
 public:
  FrameEncoder(const FrameIdentity& identity, std::uint64_t& sequence);
  ~FrameEncoder();

  BlockPtr begin(const wire::FrameDescriptor& descriptor, int wedges);
  /// The planes of a wedge, each cut into blocks of at most wire::kMaxPlaneBytes.
  std::vector<BlockPtr> wedge(int wedge_index, const BinBlock& bins);
  BlockPtr end(const wire::FrameSummary& summary, double render_s);
  BlockPtr abort(const std::string& reason);

 private:
  std::shared_ptr<Block> new_block(wire::MessageType type);

  FrameIdentity identity_;
  std::uint64_t& sequence_;
  std::unique_ptr<wire::WedgeBlock> echo_;  ///< the fields that all blocks of the frame share
};

}  // namespace obliq::net
