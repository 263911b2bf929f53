#pragma once
// How clients steer a renderer that replays: one position, one speed, for all who watch.
#include <functional>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq::wire {
class ExerciseEvent;
class ReplayState;
class SetReplay;
}  // namespace obliq::wire

namespace obliq::rendering {

/// Called from several threads at once; every call is quick.
class ReplayControl {
 public:
  virtual ~ReplayControl() = default;

  /// What is wrong with a request; empty: it holds from now on, for all of its fields.
  virtual std::vector<FieldError> set(const wire::SetReplay& request) = 0;
  virtual void write_state(wire::ReplayState& state) const = 0;
  /// The log of the exercise that was recorded, in its order.
  virtual void each_event(const std::function<void(const wire::ExerciseEvent&)>& call) const = 0;
  /// A bookmark was set at the place where the replay is.
  virtual void keep(const wire::ExerciseEvent& bookmark) = 0;
  /// How many clients watch has changed: time flows while one does. newcomer: one of them has seen nothing
  /// yet; while time stands still it is shown what the others see.
  virtual void watched(bool by_anyone, bool newcomer) = 0;
  /// Whom to call, on any thread, when the state has changed but by the flow of time; empty: nobody.
  virtual void on_change(std::function<void()> call) = 0;
};

}  // namespace obliq::rendering
