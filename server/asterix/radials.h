#pragma once
// The video of a radar as radials, in the order in which an antenna would see them.
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "client/frame_assembler.h"

namespace obliq::asterix {

/// Azimuth bins that became known together: all of a frame, a dwell of a pass.
struct RadialGroup {
  const wire::FrameDescriptor* frame = nullptr;
  struct Row {
    std::uint32_t azimuth = 0;
    std::vector<std::uint16_t> levels;  ///< [range_bins]
  };
  std::vector<Row> rows;  ///< of a frame with rising azimuth, of a pass in the order of the beam
  int bits = 8;           ///< of a level
  /// When the beam was there; none: not scanning.
  std::optional<std::int64_t> beam_utc_ns;
  /// How long the beam takes for them; 0: not scanning.
  double beam_s = 0;
};

/// Checks the frames of a subscription to VIDEO as its base does, and hands radials out. For one thread at a
/// time: that of the client whose handler it is.
class Radials : public client::FrameAssembler {
 public:
  struct Listener {
    /// A frame has begun; what it says holds from now on. A failure ends the client's receive call.
    std::function<client::Status(const wire::FrameDescriptor&)> on_begin;
    std::function<void(const RadialGroup&)> on_radials;
  };
  explicit Radials(Listener listener);
  ~Radials() override;

  client::Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override;
  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte> values) override;
  client::Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override;
  client::Status on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) override;
  void on_lost() override;

  std::uint64_t whole_frames() const { return whole_frames_; }

 private:
  struct Pass {
    bool clockwise = true;
    double rate_deg_s = 0;
  };
  void keep(const wire::WedgeBlock& block, std::span<const std::byte> values);
  void hand_out_rows(std::optional<std::int64_t> beam_utc_ns);
  void forget();

  Listener listener_;
  std::optional<Pass> pass_;                                  ///< of a scanning antenna
  std::map<std::uint32_t, std::vector<std::uint16_t>> rows_;  ///< levels that have come, by azimuth bin
  int bits_ = 8;
  std::vector<std::byte> decoded_;
  std::uint64_t whole_frames_ = 0;
};

}  // namespace obliq::asterix
