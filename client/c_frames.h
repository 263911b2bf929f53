#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

#include "client/frame_assembler.h"

namespace obliq::client {

/// Frames of several streams at a time, each with the planes that were asked for: for c.cpp.
class FramesOfStreams : public FrameHandler {
 public:
  std::map<std::uint64_t, wire::PlaneSet> of_request;  ///< of single frames
  std::deque<AssembledFrame> whole;                    ///< of a subscription the newest alone
  std::string aborted;                                 ///< why a single frame does not come

  /// Of a subscription, which takes the place of the radar's one before.
  void watch(const std::string& radar, wire::PlaneSet planes);
  void unwatch(const std::string& radar) { of_radar_.erase(radar); }

  Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override;
  Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                  std::span<const std::byte> values) override;
  Status on_targets(const wire::MessageHeader& header, const wire::TargetBlock& block,
                    std::span<const wire::TargetRecord> records) override;
  Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override;
  Status on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) override;
  void on_lost() override { streams_.clear(); }

 private:
  struct Stream {
    wire::PlaneSet planes = 0;
    std::unique_ptr<FrameAssembler> frames;
  };
  std::map<std::string, wire::PlaneSet> of_radar_;  ///< planes of subscriptions
  std::map<std::uint32_t, Stream> streams_;
};

}  // namespace obliq::client
