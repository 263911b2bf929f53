#pragma once
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "server/rendering/frame_renderer.h"

namespace obliq::rendering {

/// Renders nothing twice: while settings, antenna and scene of a radar stay the same, plan and wedges of the
/// frame before are reused, bit for bit. So an antenna that stands still, or scans from one place, costs next
/// to nothing. Nothing is kept of the first frame at a place, so that a flight takes no memory.
class FrameCache : public FrameRenderer {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{128} << 20;

  /// `most_bytes`: of all that is kept; frames beyond are rendered anew.
  explicit FrameCache(const FrameRenderer& renderer, std::size_t most_bytes = kMostBytes);
  ~FrameCache() override;

  std::vector<FieldError> place(const PoseSettings& pose) const override { return renderer_.place(pose); }
  std::vector<FieldError> scene_faults(const RadarSettings& settings) const override {
    return renderer_.scene_faults(settings);
  }
  std::vector<FieldError> faults(const RadarSettings& settings, const PoseSettings& pose) const override {
    return renderer_.faults(settings, pose);
  }
  std::uint64_t generation() const override { return renderer_.generation(); }
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;
  Plan plan_again(const PlannedFrame& frame, const SettingsPtr& settings,
                  const PoseSettings& pose) const override;
  std::string scene_hash() const override { return renderer_.scene_hash(); }
  std::string fixed() const override { return renderer_.fixed(); }
  wire::PlaneSet planes() const override { return renderer_.planes(); }

  /// Drops all that is kept, and the scene that it was planned in. From any thread.
  void forget();

  /// Bytes of bins that are kept.
  std::size_t kept_bytes() const { return budget_->used; }

 private:
  struct Budget {
    std::atomic<std::size_t> used = 0;
    std::size_t most = 0;
  };
  class Place;
  class Frame;
  std::shared_ptr<Place> find(const SettingsPtr& settings, const PoseSettings& pose,
                              std::uint64_t generation) const;

  const FrameRenderer& renderer_;
  std::shared_ptr<Budget> budget_;
  mutable std::mutex mutex_;  ///< guards places_
  mutable std::vector<std::shared_ptr<Place>> places_;
};

}  // namespace obliq::rendering
