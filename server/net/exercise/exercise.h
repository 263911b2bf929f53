#pragma once
// The exercise: all that an instructor saves, loads, resets and stops at once.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq::wire {
class ExerciseState;
}

namespace obliq::net {

class Room;

/// Of ExerciseState.version.
constexpr unsigned kExerciseVersion = 1;

/// One kind of what an exercise is made of. What it changes by itself it notes in the room's ExerciseLog.
class ExercisePart {
 public:
  virtual ~ExercisePart() = default;
  virtual void write(wire::ExerciseState& state) const = 0;
  /// Why the part cannot be as the state says; nothing: take() will do it. Fields begin with the part's own.
  virtual std::vector<FieldError> faults(const wire::ExerciseState& state) = 0;
  virtual void take(const wire::ExerciseState& state, const std::string& by) = 0;
  /// Back to how it was at the start. name: of one alone; empty: all.
  virtual void reset(const std::string& name, const std::string& by) = 0;
  virtual void freeze(bool on) = 0;
};

/// The state of the thing of that name; null: there is none.
template <class States, class NameOf>
auto state_of(const std::string& name, const States& states, NameOf name_of) {
  const auto at = std::ranges::find(states, name, name_of);
  return at == states.end() ? nullptr : &*at;
}

/// What is wrong with the states of all things of one kind, of which each must be there once. name_of: of a
/// state; faults_of: of a thing as its state has it.
template <class Things, class States, class NameOf, class FaultsOf>
std::vector<FieldError> faults_of_each(const std::string& kind, const Things& things, const States& states,
                                       NameOf name_of, FaultsOf faults_of) {
  std::vector<FieldError> errors;
  const std::string kinds = kind + "s";
  if (static_cast<std::size_t>(states.size()) != things.size())
    errors.push_back({kinds, std::to_string(states.size()) + " " + kinds,
                      std::to_string(things.size()) + ", each of the server's once"});
  for (const auto& thing : things) {
    const auto* its = state_of(thing.name, states, name_of);
    if (its == nullptr) {
      errors.push_back({kinds, "nothing of " + thing.name, "a state of each " + kind + " that is served"});
      continue;
    }
    for (FieldError& error : faults_of(thing, *its)) {
      error.field = kind + " " + thing.name + ": " + error.field;
      errors.push_back(std::move(error));
    }
  }
  return errors;
}

/// On the io thread.
class Exercise {
 public:
  /// The room must outlive this.
  explicit Exercise(Room& room);
  /// What joins is saved, loaded, reset and stopped with the rest, in this order.
  void join(std::unique_ptr<ExercisePart> part) { parts_.push_back(std::move(part)); }

  /// With the targets: only for clients that may know where they are.
  void write(wire::ExerciseState& state) const;
  /// Without them.
  wire::ExerciseState for_all() const;
  /// All of it or nothing. Returns why nothing.
  std::vector<FieldError> load(const wire::ExerciseState& state, const std::string& by);
  void reset(const std::string& name, const std::string& by);
  void freeze(bool on, const std::string& by);
  bool is_frozen() const { return frozen_; }

 private:
  static void hide_targets(wire::ExerciseState& state);

  Room& room_;
  std::vector<std::unique_ptr<ExercisePart>> parts_;
  bool frozen_ = false;
};

}  // namespace obliq::net
