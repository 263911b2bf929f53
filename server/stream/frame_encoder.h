#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "proto/target_record.h"
#include "server/radar/pulse_train.h"
#include "server/radar/render.h"
#include "server/stream/live_frames.h"

namespace obliq::wire {
class FrameBegin;
class FrameDescriptor;
class FrameSummary;
class Pose;
class ScanPass;
class WedgeBlock;
}  // namespace obliq::wire

namespace obliq::stream {

/// Monotonic time in nanoseconds; only differences mean anything.
std::int64_t monotonic_ns();

struct FrameIdentity {
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t request_id = 0;         ///< of a RenderOnce, else 0
  std::vector<StreamChoice> choices{};  ///< of those the frame is for; none: one of the default
  std::int64_t pose_received_ns = 0;
  std::uint64_t frames_skipped = 0;  ///< that should have been rendered since the last
  double waited_s = 0;               ///< from its date to its begin
  std::shared_ptr<BlockMeter> meter{};
};

/// Turns one frame into messages: each plane once in every format that a client asked for, its descriptor as
/// JSON too where a browser did. `sequence` counts on across the frames of a stream. For one thread at a
/// time.
class FrameEncoder {
 public:
  FrameEncoder(FrameIdentity identity, std::uint64_t& sequence);
  ~FrameEncoder();

  /// Before begin(): the frame is a pass of a scanning antenna.
  void set_scan(const wire::ScanPass& scan);
  /// The wedges that follow are of a dwell with a pose of its own.
  void set_dwell(const wire::Pose& pose, std::int64_t pose_received_ns, bool pose_stale,
                 std::int64_t beam_ns);

  /// One FrameBegin for each window.
  std::vector<BlockPtr> begin(const wire::FrameDescriptor& descriptor);
  /// The planes of a wedge, each cut into blocks of at most wire::kMaxPlaneBytes.
  std::vector<BlockPtr> wedge(int wedge_index, const BinBlock& bins);
  /// A train of pulses, cut likewise.
  std::vector<BlockPtr> train(const PulseTrain& train);
  /// Where targets are, of all azimuths or of a dwell's; at most wire::kMaxTargetRecords.
  BlockPtr targets(const AzimuthRange& azimuths, std::span<const wire::TargetRecord> records);
  /// missed: azimuth bins of a pass that were not rendered.
  BlockPtr end(const wire::FrameSummary& summary, double render_s,
               const std::vector<AzimuthRange>& missed = {});
  BlockPtr abort(const std::string& reason);

 private:
  /// A plane in a format.
  struct Product {
    wire::Plane plane{};
    BlockFormat format;
    wire::Window window;   ///< cut to the frame
    bool as_json = false;  ///< too
  };

  std::shared_ptr<Block> new_block(wire::MessageType type);
  BlockPtr finish(std::shared_ptr<Block> block, bool as_json, const google::protobuf::Message& message,
                  std::span<const std::byte> values = {});
  /// Rows of values: every step-th from the first on.
  struct Source {
    std::span<const std::byte> values;
    std::size_t first_row;
    std::uint32_t step;
    std::uint32_t n_rows;
    std::size_t row_values;
  };
  /// Says in a block's message which of a source's rows it holds.
  using PlaceRows = std::function<void(std::uint32_t first, std::uint32_t n)>;
  void make(const Product& product, const Source& source, wire::WedgeBlock& message,
            std::vector<BlockPtr>& blocks, const PlaceRows& place);

  FrameIdentity identity_;
  std::uint64_t& sequence_;
  bool as_json_ = false;                    ///< for some client
  std::vector<Product> products_;           ///< known from begin() on
  std::unique_ptr<wire::ScanPass> scan_;    ///< null: all of the sector at once
  std::unique_ptr<wire::WedgeBlock> echo_;  ///< the fields that all blocks of the frame share
  double iq_step_ = 0;                      ///< the descriptor's adc_step
  std::vector<std::byte> picked_;           ///< buffers that go from wedge to wedge
  std::vector<std::byte> coded_;
};

}  // namespace obliq::stream
