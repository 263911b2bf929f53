#pragma once
// Who changed what of an exercise, and when: what stations list, and what recordings keep.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "proto/claim.h"
#include "terrain/base/errors.h"

namespace obliq {
struct PoseSettings;
struct RadarSettings;
}  // namespace obliq

namespace obliq::wire {
class ExerciseEvent;
class ExerciseEvents;
class ExerciseState;
class Pose;
}  // namespace obliq::wire

namespace obliq::net {

struct LiveRadar;

/// Numbers events and keeps the newest. Any part of an exercise may note its own. On the io thread.
class ExerciseLog {
 public:
  /// Of what is kept: other events, oldest first, go at these; bookmarks stay and are refused.
  static constexpr std::size_t kMostEvents = 4096;
  /// Of those, targets that come and go: they push no other event out.
  static constexpr std::size_t kMostTargetEvents = 1024;
  static constexpr std::size_t kMostBytes = std::size_t{4} << 20;
  static constexpr std::size_t kMostBookmarks = 1000;
  /// Of the events in one message, unless one alone has more.
  static constexpr std::size_t kPageBytes = std::size_t{48} << 10;

  ExerciseLog();
  ~ExerciseLog();

  using Listener = std::function<void(const wire::ExerciseEvent&)>;
  /// Called with each event, numbered and dated, when it is noted.
  void on_event(Listener listener) { listener_ = std::move(listener); }

  /// Gives it its number, and where it has none its time.
  void note(wire::ExerciseEvent event);

  // The kinds that there are, with who did it:
  // Claims of a radar, or of the world (null):
  void claimed(const LiveRadar* radar, wire::ClaimSet claims, const std::string& by);
  void released(const LiveRadar* radar, wire::ClaimSet claims, const std::string& by);
  void taken_over(const LiveRadar* radar, wire::ClaimSet claims, const std::string& from,
                  const std::string& by);
  /// Nothing is noted where nothing has changed.
  void set(const LiveRadar& radar, const RadarSettings& before, const std::string& by);
  void aimed(const LiveRadar& radar, const PoseSettings& before, const wire::Pose& asked,
             const std::string& by);
  struct Switches {
    bool transmit = true;
    bool frozen = false;
    double rate_limit_hz = 0;
  };
  static Switches switches_of(const LiveRadar& radar);
  void switched(const LiveRadar& radar, const Switches& before, const std::string& by);
  /// state: of what was reset, as it is now.
  void reset(const std::string& radar, const wire::ExerciseState& state, const std::string& by);
  void loaded(const wire::ExerciseState& state, const std::string& by);
  void froze(bool on, const std::string& by);
  void targets(std::uint32_t come, std::uint32_t gone, const std::string& by);

  /// Writes those behind number `after`, as many as one message takes. False: more follow.
  bool write(std::uint64_t after, wire::ExerciseEvents& events) const;
  std::size_t bookmarks() const { return bookmarks_.size(); }
  /// Of that number, if it is kept.
  const wire::ExerciseEvent* find(std::uint64_t number) const;

 private:
  struct Kept;
  using Events = std::deque<std::unique_ptr<const Kept>>;  ///< in the order of their numbers
  static std::uint64_t number_of(const std::unique_ptr<const Kept>& kept);
  void drop_oldest(Events& kept);
  /// That of the least number above; null: there is none.
  const Kept* first_behind(std::uint64_t number) const;

  Listener listener_;
  Events bookmarks_;
  Events targets_;
  Events others_;
  std::size_t bytes_ = 0;  ///< of others_
  std::uint64_t newest_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace obliq::net
