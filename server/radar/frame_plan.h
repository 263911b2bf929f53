#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/radar/beam/echo_plan.h"
#include "server/radar/scene_plan.h"

namespace obliq {

class FramePlan;

/// The geometry of a frame, worked out once for all its wedges. `plan` is null when `errors` is not empty.
struct PlanResult {
  std::shared_ptr<const FramePlan> plan;
  std::vector<FieldError> errors;
};
PlanResult plan_frame(std::shared_ptr<const Scene> scene, const SettingsPtr& settings, const Pose& pose);

/// Why beam and pulse do not go with this sector or pose: what plan_frame() would say of them, without a
/// plan.
std::vector<FieldError> beam_faults(std::shared_ptr<const Scene> scene, const RadarSettings& settings,
                                    const Pose& pose);
/// The same where settings and pose say it themselves; nothing: the antenna's height above the ground
/// decides.
std::optional<std::vector<FieldError>> known_beam_faults(const RadarSettings& settings,
                                                         const PoseSettings& pose);

/// What a display gets: bins, and how they are made of what is looked at. Immutable.
class FramePlan {
 public:
  /// The same for another frame, with another number and date of the same antenna, and no building seen yet.
  std::shared_ptr<FramePlan> again(const PoseSettings& pose) const;

  const RadarSettings& settings() const { return snapshot_.settings; }
  std::uint64_t settings_version() const { return snapshot_.version; }
  const Pose& pose() const { return pose_; }
  const Sector& sector() const { return sector_; }
  const BinGrid& bins() const { return bins_; }
  /// What is looked at; behind a beam or a pulse a wider sector and a longer swath, and where bins are wide
  /// narrower ones.
  const ScenePlan& looks_at() const { return *looks_at_; }
  const Scene& scene() const { return looks_at_->scene(); }
  /// How the bins follow from sharp ones by the sums over beam and pulse; null: they are those.
  const EchoPlan* sum() const { return sum_.get(); }
  /// How much of labels is worked out, where they are wanted and where not.
  LabelParts label_parts(bool wanted) const {
    if (wanted) return LabelParts::all;
    const bool materials = sum_ && sum_->doppler && sum_->doppler->needs_materials();
    return materials ? LabelParts::materials : LabelParts::none;
  }
  /// Bins of looks_at() that each sharp one is added up from (server/radar/narrow_bins.h).
  int narrow_bins() const { return narrow_bins_; }

 private:
  friend PlanResult plan_frame(std::shared_ptr<const Scene>, const SettingsPtr&, const Pose&);
  FramePlan(const SettingsSnapshot& snapshot, const Pose& pose);

  SettingsSnapshot snapshot_;  // a copy, so that a plan which is kept does not keep a radar's settings alive
  Pose pose_;
  Sector sector_;
  BinGrid bins_;
  std::shared_ptr<const ScenePlan> looks_at_;
  std::shared_ptr<const EchoPlan> sum_;
  int narrow_bins_ = 1;
};

}  // namespace obliq
