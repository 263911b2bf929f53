#include "server/rendering/frame_cache.h"

#include <algorithm>
#include <utility>

#include "server/radar/beam/sharp_wedge.h"
#include "server/radar/receiver/receiver.h"
#include "terrain/base/asking.h"

namespace obliq::rendering {
namespace {

/// In units of ask(): a copy, the receiver, delivery.
constexpr std::int64_t kRepeatABin = 8;

std::size_t bytes_of(const BinBlock& bins) {
  return bins.iq.size() * sizeof bins.iq[0] + bins.power_w.size() * sizeof bins.power_w[0] +
         bins.count.size() * sizeof bins.count[0] + bins.state.size() * sizeof bins.state[0] +
         bins.look.size() * sizeof bins.look[0] +
         bins.labels.material.size() * std::size_t{BinBlock::kLabelBytesABin};
}

/// Wedges of azimuth bins that were rendered in one go.
struct Part {
  AzimuthRange azimuths;
  SharpPlanes planes;
  std::vector<Wedge> wedges;
  std::vector<std::uint32_t> seen;  // buildings
  std::size_t bytes = 0;
};

}  // namespace

/// What one radar's frames from one place have in common.
class FrameCache::Place {
 public:
  Place(const SettingsPtr& settings, const PoseSettings& pose, std::uint64_t generation,
        std::shared_ptr<Budget> budget)
      : settings_(settings), pose_(pose), generation_(generation), budget_(std::move(budget)) {}
  ~Place() {
    for (const auto& part : parts_) budget_->used -= part->bytes;
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// The radar has other settings or has gone, or the scene has changed.
  bool is_over(std::uint64_t generation) const { return settings_.expired() || generation_ != generation; }
  bool is_of(const SettingsPtr& settings) const { return settings_.lock() == settings; }
  const PoseSettings& pose() const { return pose_; }
  bool is_at(const PoseSettings& pose) const {
    const SettingsPtr settings = settings_.lock();
    return settings != nullptr && same_antenna(settings->settings, pose_, pose);
  }

  /// The frame kept, with another number and date; null when there is none.
  std::unique_ptr<PlannedFrame> again(const PoseSettings& pose) const {
    const auto frame = planned();
    return frame ? frame->again(pose) : nullptr;
  }
  void keep(std::shared_ptr<const PlannedFrame> frame) {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
  }

  std::shared_ptr<const Part> find(AzimuthRange azimuths, const SharpPlanes& planes) const {
    const std::lock_guard lock(mutex_);
    for (const auto& part : parts_)
      if (part->azimuths.first == azimuths.first && part->azimuths.count == azimuths.count &&
          part->planes.hold(planes))
        return part;
    return nullptr;
  }

  void keep(std::shared_ptr<const Part> part) {
    if (find(part->azimuths, part->planes)) return;
    const std::lock_guard lock(mutex_);
    if ((budget_->used += part->bytes) <= budget_->most) {
      parts_.push_back(std::move(part));
    } else {
      budget_->used -= part->bytes;
    }
  }

 private:
  std::shared_ptr<const PlannedFrame> planned() const {
    const std::lock_guard lock(mutex_);
    return frame_;
  }

  std::weak_ptr<const SettingsSnapshot> settings_;
  PoseSettings pose_;
  std::uint64_t generation_;
  std::shared_ptr<Budget> budget_;
  mutable std::mutex mutex_;  ///< guards the rest
  std::shared_ptr<const PlannedFrame> frame_;
  std::vector<std::shared_ptr<const Part>> parts_;
};

/// A frame from a place where there was one before.
class FrameCache::Frame : public PlannedFrame {
 public:
  Frame(std::shared_ptr<const PlannedFrame> frame, std::shared_ptr<Place> place, SettingsPtr settings)
      : frame_(std::move(frame)), place_(std::move(place)), settings_(std::move(settings)) {}

  const PlannedFrame& frame() const { return *frame_; }

  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    frame_->describe(radar, descriptor);
  }
  void summarise(const FrameStats& stats, wire::FrameSummary& summary) const override {
    frame_->summarise(stats, summary);
  }

  AirView air() const override { return frame_->air(); }
  std::vector<wire::TargetRecord> truth(AzimuthRange azimuths, const RenderOptions& options,
                                        double noise_power_w) const override {
    return frame_->truth(azimuths, options, noise_power_w);
  }

  std::optional<RenderedTrain> render_train(const TrainLook& look,
                                            const RenderOptions& options) const override {
    return frame_->render_train(look, options);
  }

  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    const SharpPlanes planes{options.iq, wants_look(options, settings_->settings), options.states,
                             options.labels ? LabelParts::all : LabelParts::none};
    if (const auto part = place_->find(azimuths, planes)) return repeat(*part, azimuths, options);
    const auto frame = frame_->again(place_->pose());  // knows what this part alone has seen
    if (!frame) return frame_->render(azimuths, options);
    const auto targets = frame_->targets(azimuths, options);
    const auto fresh = std::make_shared<Part>();
    fresh->azimuths = azimuths;
    fresh->planes = planes;
    // What is kept are the echoes of the ground: targets move, and the receiver makes something else of them
    // in each frame.
    RenderOptions with_copy = options;
    with_copy.receiver = nullptr;
    with_copy.targets = nullptr;
    with_copy.target_ids = false;
    with_copy.on_wedge = [&](Wedge&& wedge) {
      fresh->bytes += bytes_of(wedge.bins);
      fresh->wedges.push_back(wedge);
      give(std::move(wedge), options, targets.get());
    };
    if (!frame->render(azimuths, with_copy)) return false;
    fresh->seen = frame->seen();
    frame_->see_again(fresh->seen);
    place_->keep(fresh);
    return true;
  }

 private:
  bool repeat(const Part& part, AzimuthRange azimuths, const RenderOptions& options) const {
    const auto targets = frame_->targets(azimuths, options);
    for (const Wedge& wedge : part.wedges) {
      if (options.stop.stop_requested()) return false;
      give(Wedge(wedge), options, targets.get());
      ask(kRepeatABin * static_cast<std::int64_t>(wedge.bins.state.size()));
    }
    frame_->see_again(part.seen);
    return true;
  }

  static void give(Wedge&& wedge, const RenderOptions& options, const TargetEchoes* targets) {
    add_targets(targets, wedge.bins, options.iq, options.target_ids);
    if (options.receiver)
      options.receiver->receive(wedge.bins, {options.iq, options.video8, options.video16});
    if (options.on_wedge) options.on_wedge(std::move(wedge));
  }

  std::shared_ptr<const PlannedFrame> frame_;
  std::shared_ptr<Place> place_;
  SettingsPtr settings_;
};

FrameCache::FrameCache(const FrameRenderer& renderer, std::size_t most_bytes)
    : renderer_(renderer), budget_(std::make_shared<Budget>()) {
  budget_->most = most_bytes;
}

FrameCache::~FrameCache() = default;

FrameRenderer::Plan FrameCache::plan(const SettingsPtr& settings, const PoseSettings& pose) const {
  // Each frame is another draw.
  if (resolved_speckle(settings->settings) == SpeckleKind::independent) return renderer_.plan(settings, pose);
  const std::uint64_t generation = renderer_.generation();
  if (const auto place = find(settings, pose, generation))
    if (auto again = place->again(pose))
      return {std::make_unique<Frame>(std::move(again), place, settings), {}, {}};
  Plan plan = renderer_.plan(settings, pose);
  // Another scene may have come while the frame was planned.
  if (!plan.frame || plan.settings || renderer_.generation() != generation) return plan;
  const auto place = find(settings, pose, generation);
  if (!place) {
    const std::lock_guard lock(mutex_);
    places_.push_back(std::make_shared<Place>(settings, pose, generation, budget_));
    return plan;
  }
  std::shared_ptr<const PlannedFrame> frame = std::move(plan.frame);
  place->keep(frame);
  plan.frame = std::make_unique<Frame>(std::move(frame), place, settings);
  return plan;
}

FrameRenderer::Plan FrameCache::plan_again(const PlannedFrame& frame, const SettingsPtr& settings,
                                           const PoseSettings& pose) const {
  const auto* ours = dynamic_cast<const Frame*>(&frame);
  // In the scene of the frame before, even if a newer one has come: nothing of it is kept or repeated.
  return renderer_.plan_again(ours ? ours->frame() : frame, settings, pose);
}

void FrameCache::forget() {
  const std::lock_guard lock(mutex_);
  places_.clear();
}

/// The place of a radar that has not moved; places that radars have left are forgotten.
std::shared_ptr<FrameCache::Place> FrameCache::find(const SettingsPtr& settings, const PoseSettings& pose,
                                                    std::uint64_t generation) const {
  const std::lock_guard lock(mutex_);
  std::erase_if(places_, [&](const auto& place) {
    return place->is_over(generation) || (place->is_of(settings) && !place->is_at(pose));
  });
  const auto place = std::ranges::find_if(places_, [&](const auto& p) { return p->is_of(settings); });
  return place == places_.end() ? nullptr : *place;
}

}  // namespace obliq::rendering
