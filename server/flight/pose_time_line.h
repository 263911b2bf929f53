#pragma once
// Where an antenna is at any time, from poses that a controller sends now and then.
#include <cstdint>
#include <deque>
#include <mutex>

#include "server/radar/settings.h"

namespace obliq {

/// An antenna's pose at one moment.
struct PoseAt {
  PoseSettings pose;  ///< interpolated; sim_time_ns is the moment's, pose_id the newest's at or before it
  std::int64_t received_ns = 0;  ///< arrival of the newest pose that went into it; 0: the scene file's
  bool stale = false;            ///< the newest pose's valid_s have passed since its arrival
  bool timed = false;            ///< its sim time is of the controller's clock
  std::int64_t shown_ns = 0;     ///< when by the server's clock it was so: as late as the poses are shown
};

/// The poses of one radar. A pose without a sim time applies at once, until the next. Poses with one are
/// joined up: linear in space, the shortest arc in bearing, never beyond the newest.
///
/// The controller's clock is only held against the server's monotonic one to know how far it has come. It
/// runs R times as fast, PoseSettings::time_rate of the newest pose. With
/// a_i the arrival of the pose of sim time s_i, over the last kWindow poses: O, the greatest s_i - R a_i,
/// belongs to the least delayed; P is the greatest gap between two sim times, plus the greatest delay behind
/// the least delayed. At the server's time t the antenna is shown at sim time R t + O - P: as late as it must
/// be for the next pose to be there before it is reached. When O or P change, the shown time runs up to a
/// tenth faster or slower until it is right again. A controller's clock must therefore keep its rate within
/// a tenth; of one that does not, the shown time jumps when it is R kJump_ns off. Poses further apart than
/// that are not joined up: the later one applies when it arrives. With another rate a new window begins, and
/// the shown time is right at once.
///
/// Where the poses give no velocity, it is the slope between the two poses around the shown time by their own
/// sim times; past the newest that of the last two; of one pose alone none.
///
/// Late poses, with a sim time before the newest, are counted and dropped; after kMostLate of them in a row
/// the clock has been set back, and a new time line begins. Safe from any thread; a few microseconds a call.
class PoseTimeLine {
 public:
  static constexpr int kWindow = 64;
  static constexpr int kMostLate = 120;
  static constexpr std::int64_t kJump_ns = 2'000'000'000;

  explicit PoseTimeLine(const PoseSettings& initial);

  /// A pose that applies at once. The next one with a sim time begins a new time line.
  void set(const PoseSettings& pose, std::int64_t now_ns);
  /// A pose of the time pose.sim_time_ns, within +-4e18. False: it was late.
  bool add(const PoseSettings& pose, std::int64_t now_ns);
  /// A pose of that time would be late now, and dropped.
  bool is_late(std::int64_t sim_time_ns) const;
  /// The antenna is turned on its platform, from this moment on: bearing and tilt are those of `as`, those of
  /// the poses before follow. Where the platform is, and since when, stays.
  void aim(const PoseSettings& as);
  /// Another controller, or a clock that was set: the next pose begins a new time line.
  void restart();

  /// What the newest pose says of its validity from now on.
  void set_validity(double valid_s);

  PoseAt at(std::int64_t now_ns) const;
  /// As it was sent, with the fields that its sender left out.
  PoseSettings newest() const;
  std::uint64_t late() const;  ///< since construction

 private:
  struct Sent {
    PoseSettings pose;
    std::int64_t received_ns = 0;
  };
  struct Arrival {
    std::int64_t offset_ns = 0;  ///< s_i - R a_i
    std::int64_t gap_ns = 0;     ///< s_i - s_(i-1)
  };

  void begin(const PoseSettings& pose, std::int64_t now_ns);
  void set_rate(double rate, std::int64_t now_ns);
  /// R times the server's time, but for a constant.
  std::int64_t ticks(std::int64_t now_ns) const;
  void follow_clock(std::int64_t gap_ns, bool at_once);
  std::int64_t jump_ns() const;  ///< of sim time

  mutable std::mutex mutex_;  ///< guards everything below
  std::deque<Sent> poses_;    ///< rising sim times; the newest last; never empty
  std::deque<Arrival> arrivals_;
  bool timed_ = false;  ///< the poses are of one clock
  double rate_ = 1;
  std::int64_t rate_since_ns_ = 0;  ///< where ticks and the server's time are the same
  std::int64_t shift_ns_ = 0;       ///< shown sim time - ticks, when there are two poses
  int late_in_a_row_ = 0;
  std::uint64_t late_ = 0;
};

/// The pose a share u in [0, 1] of the way from a to b; at the ends exactly a and b. A velocity where both
/// have one. Positions on the straight line in space (with heights above ground: over the straight line,
/// height linear); of two poses with different height references a until the end.
PoseSettings between(const PoseSettings& a, const PoseSettings& b, double u);

}  // namespace obliq
