#pragma once
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/frame_dispatch.h"
#include "proto/bin_window.h"
#include "proto/plane.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
class Pose;
}  // namespace obliq::wire

namespace obliq::client {

/// A train of pulses: what the receiver gave out, pulse by pulse.
struct AssembledTrain {
  int first_azimuth = 0;  ///< of the whole frame's bins, that it was sent along
  int n_azimuth = 0;
  int n_pulses = 0;
  int n_range = 0;
  std::vector<double> period_ns;           ///< intervals from pulse to pulse, round and round
  double boresight_start_deg = 0;          ///< at pulse 0, clockwise from the antenna's true north
  double boresight_rate_deg_s = 0;         ///< clockwise
  std::shared_ptr<const wire::Pose> pose;  ///< at the middle of the train
  std::vector<std::complex<float>> iq;     ///< [n_pulses][n_range], descriptor.unit
};

/// A frame, or the window of it that was asked for (descriptor.window). Planes are [n_azimuth][n_range], the
/// bins of the window; those not asked for are empty.
struct AssembledFrame {
  AssembledFrame();
  ~AssembledFrame();
  AssembledFrame(AssembledFrame&&) noexcept;
  AssembledFrame& operator=(AssembledFrame&&) noexcept;

  std::uint64_t request_id = 0;
  std::uint64_t frames_skipped = 0;  ///< between this frame and the one before it
  int n_azimuth = 0;
  int n_range = 0;
  double render_s = 0;  ///< how long the server took
  std::unique_ptr<wire::FrameDescriptor> descriptor;
  std::unique_ptr<wire::FrameSummary> summary;
  /// First azimuth bin and number of bins of what a scanning antenna missed: 0 and "not sampled" here, and
  /// labels of nothing.
  std::vector<std::pair<int, int>> missed;
  std::vector<std::complex<float>> iq;  ///< descriptor.unit
  std::vector<double> power_w;
  std::vector<std::uint32_t> count;
  std::vector<std::uint8_t> state;
  std::vector<std::uint16_t> video;    ///< levels of video_bits
  std::vector<std::uint8_t> material;  ///< labels: an index of descriptor.materials; 255: none
  std::vector<float> building;         ///< share of the mean power that buildings give
  std::vector<float> height_m;         ///< above the datum, weighed by power; NaN: no power
  std::vector<std::uint8_t> returns;   ///< separate stretches of visible surface in the bin
  /// Where targets are, where truth was asked for. Of a pass in the order of its dwells.
  std::vector<wire::TargetRecord> targets;
  std::vector<AssembledTrain> trains;  ///< of a radar that gives out its pulses; of a pass one a dwell
  std::vector<std::uint32_t> target;   ///< the strongest in the bin: the last 32 bits of its id; 0: none
  int video_bits = 8;                  ///< of what was sent; without video means nothing
};

/// Puts the blocks of one stream together, one frame after the other, decodes them, and checks that every bin
/// of every plane arrives exactly once. Frames of other streams are ignored while one is being received.
/// Planes are allocated when a part of their values has arrived: memory follows what comes, not what is
/// claimed. For one thread at a time: that of the client whose handler it is.
class FrameAssembler : public FrameHandler {
 public:
  enum class State { idle, receiving, complete, aborted };

  /// max_bytes: a frame whose planes need more is refused.
  explicit FrameAssembler(wire::PlaneSet planes = wire::kAllPlanes,
                          std::uint64_t max_bytes = std::uint64_t{8} << 30);
  ~FrameAssembler() override;

  Status on_begin(const wire::MessageHeader&, const wire::FrameBegin&) override;
  Status on_block(const wire::MessageHeader&, const wire::WedgeBlock&, std::span<const std::byte>) override;
  Status on_targets(const wire::MessageHeader&, const wire::TargetBlock&,
                    std::span<const wire::TargetRecord>) override;
  Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override;
  Status on_abort(const wire::MessageHeader&, const wire::FrameAbort&) override;
  void on_lost() override;

  State state() const { return state_; }
  const std::string& abort_reason() const { return abort_reason_; }
  /// How much of the frame has arrived, 0 to 1.
  double fraction() const;
  /// Its planes may be empty until it is complete.
  const AssembledFrame& frame() const { return frame_; }
  /// Moves the complete frame out; the assembler is idle again.
  AssembledFrame take();

 private:
  bool is_current(const wire::MessageHeader& header, std::uint64_t frame_id) const;
  Status expect(std::uint64_t n_azimuth, std::uint64_t n_range);
  bool has_arrived(std::uint64_t part) const;
  Status no_memory() const;
  Status add_pulses(const wire::WedgeBlock& block, std::span<const std::byte> values);
  void allocate();
  void keep(wire::Plane plane, const wire::Rectangle& place, std::span<const std::byte> values);
  std::optional<wire::Rectangle> place_of(const wire::WedgeBlock& block) const;
  std::byte* plane_data(wire::Plane plane);
  std::optional<std::uint64_t> values_missed(const wire::FrameEnd& end);

  wire::PlaneSet planes_;
  std::uint64_t max_bytes_;
  State state_ = State::idle;
  std::uint32_t stream_id_ = 0;
  std::uint64_t frame_id_ = 0;
  std::string abort_reason_;
  AssembledFrame frame_;
  wire::Window window_;  ///< of the frame, cut to it
  /// Values that came before the planes were allocated.
  struct Early {
    wire::Plane plane;
    wire::Rectangle place;
    std::vector<std::byte> values;
  };
  std::vector<Early> early_;
  bool allocated_ = false;
  std::uint64_t bytes_received_ = 0;  ///< over all planes
  std::uint64_t bytes_expected_ = 0;
  std::vector<std::byte> scratch_;                    ///< for decoding
  std::vector<std::uint16_t> video_;                  ///< values of a block of 8 bits
  std::vector<std::uint32_t> filled_[wire::kPlanes];  ///< [n_azimuth], range bins that have arrived
  std::uint64_t bins_received_ = 0;                   ///< over all planes
  std::uint64_t bins_expected_ = 0;
};

}  // namespace obliq::client
