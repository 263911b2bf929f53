#pragma once
// Include proto/obliq.pb.h before.
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "proto/limits.h"
#include "proto/message_codec.h"
#include "server/rendering/render_thread.h"

namespace obliq::test {

/// What the render thread says, decoded.
class Listener : public rendering::RenderEvents {
 public:
  void on_live_blocks(std::size_t, const stream::LiveFramePtr&,
                      std::vector<stream::BlockPtr> blocks) override {
    const std::lock_guard lock(mutex_);
    for (const stream::BlockPtr& block : blocks) take(*block);
    changed_.notify_all();
  }
  void on_live_rendered(std::size_t, const rendering::RenderedFrame& frame) override {
    const std::lock_guard lock(mutex_);
    missed += frame.dwells_missed;
  }
  void on_live_held_up(std::size_t, double) override {}
  void on_finished() override {}
  void on_live_fault(std::size_t, const std::shared_ptr<const rendering::LiveView>&,
                     const std::vector<FieldError>& errors) override {
    const std::lock_guard lock(mutex_);
    faults.push_back(errors.front().field);
    changed_.notify_all();
  }
  void on_request_block(const rendering::FrameRequestPtr&, const stream::BlockPtr&) override {}
  void on_request_rendered(const rendering::RenderedRequest&) override {}
  void on_appraised(const rendering::AppraisalPtr&, const std::vector<FieldError>&) override {}
  void on_request_fault(const rendering::FrameRequestPtr&, const std::vector<FieldError>&) override {}

  template <typename Condition>
  ::testing::AssertionResult wait(Condition condition) {
    std::unique_lock lock(mutex_);
    for (int i = 0; i < 6000; ++i)
      if (changed_.wait_for(lock, std::chrono::milliseconds(10), condition))
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << "not within a minute; " << wedges.size() << " wedges, " << ends.size() << " ends";
  }

  std::vector<wire::FrameBegin> begins;
  std::vector<wire::WedgeBlock> wedges;
  std::vector<wire::Bytes> values;  ///< of each wedge
  std::vector<wire::FrameEnd> ends;
  std::vector<wire::FrameAbort> aborts;
  std::vector<std::string> faults;
  std::uint64_t missed = 0;

 private:
  void take(const stream::Block& block) {
    wire::MessageView view;
    ASSERT_EQ(wire::decode_message(block.bytes, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
    const auto parse = [&](auto& list) {
      ASSERT_TRUE(wire::parse_descriptor(view.descriptor, list.emplace_back()));
    };
    if (block.type == wire::MessageType::frame_begin) parse(begins);
    if (block.type == wire::MessageType::wedge_block) {
      parse(wedges);
      values.emplace_back(view.plane.begin(), view.plane.end());
    }
    if (block.type == wire::MessageType::frame_end) parse(ends);
    if (block.type == wire::MessageType::frame_abort) parse(aborts);
  }
  std::mutex mutex_;
  std::condition_variable changed_;
};

/// A renderer that tells when a scan has its start, so that a test's clock may go on: the first dwell asks
/// for the generation after it has looked at the clock.
template <typename Renderer>
class ScanWatch : public Renderer {
 public:
  using Renderer::Renderer;
  std::uint64_t generation() const override {
    scan_has_begun = true;
    return Renderer::generation();
  }
  mutable std::atomic<bool> scan_has_begun = false;
};

}  // namespace obliq::test
