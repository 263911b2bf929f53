#include "server/flight/pose_time_line.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>

#include "terrain/base/units.h"
#include "terrain/frames.h"

namespace obliq {
namespace {

constexpr std::int64_t kSlew = 10;  ///< the shown time gains or loses at most a 10th

constexpr std::size_t kMostPoses = 4096;

Geodetic place_of(const PoseSettings& pose, double height_m) {
  return {pose.latitude_deg * kDegree_rad, pose.longitude_deg * kDegree_rad, height_m};
}

/// A share of the way along the shortest arc; at rest a stays as it is, whatever turns it counts.
double arc(double a_deg, double b_deg, double u) {
  const double turn_deg = std::remainder(b_deg - a_deg, 360.0);
  return turn_deg == 0 ? a_deg : std::remainder(a_deg + u * turn_deg, 360.0);
}

/// Of the antenna on the way from a to b, along the north, east and up of `at`; none where it is not one
/// flight: heights of two kinds, or faster than anything flies.
void take_slope(const PoseSettings& a, const PoseSettings& b, PoseSettings& at) {
  const double gap_s = static_cast<double>(b.sim_time_ns - a.sim_time_ns) * 1e-9;
  if (a.height_reference != b.height_reference || !(gap_s > 0)) return;
  const bool over_ground = a.height_reference == HeightReference::ground;
  const WorldFrame frame(at.latitude_deg * kDegree_rad, at.longitude_deg * kDegree_rad, 1);
  glm::dvec3 way_m = frame.world_from_geodetic(place_of(b, over_ground ? 0 : b.height_m)).m -
                     frame.world_from_geodetic(place_of(a, over_ground ? 0 : a.height_m)).m;
  if (over_ground) way_m.y = b.height_m - a.height_m;
  const glm::dvec3 velocity_m_s = way_m / gap_s;
  if (!glm::all(glm::lessThanEqual(glm::abs(velocity_m_s), glm::dvec3(kMostSpeed_m_s)))) return;
  at.velocity_east_m_s = velocity_m_s.x;
  at.velocity_up_m_s = velocity_m_s.y;
  at.velocity_north_m_s = velocity_m_s.z;
}

std::optional<double> part(const std::optional<double>& a, const std::optional<double>& b, double u) {
  return a.value_or(0) + u * (b.value_or(0) - a.value_or(0));
}

bool same_place(const PoseSettings& a, const PoseSettings& b) {
  return a.latitude_deg == b.latitude_deg && a.longitude_deg == b.longitude_deg && a.height_m == b.height_m;
}

}  // namespace

PoseSettings between(const PoseSettings& a, const PoseSettings& b, double u) {
  if (!(u > 0)) return a;
  if (u >= 1) return b;
  PoseSettings p = a;
  p.bearing_deg = arc(a.bearing_deg, b.bearing_deg, u);
  p.heading_deg = arc(a.heading_deg, b.heading_deg, u);
  p.tilt_deg = a.tilt_deg + u * (b.tilt_deg - a.tilt_deg);
  p.roll_deg = a.roll_deg + u * (b.roll_deg - a.roll_deg);
  p.pitch_deg = a.pitch_deg + u * (b.pitch_deg - a.pitch_deg);
  if (a.has_velocity() && b.has_velocity()) {
    p.velocity_north_m_s = part(a.velocity_north_m_s, b.velocity_north_m_s, u);
    p.velocity_east_m_s = part(a.velocity_east_m_s, b.velocity_east_m_s, u);
    p.velocity_up_m_s = part(a.velocity_up_m_s, b.velocity_up_m_s, u);
  } else {
    p.clear_velocity();
  }
  if (a.height_reference != b.height_reference || same_place(a, b)) return p;
  const bool over_ground = a.height_reference == HeightReference::ground;
  // Straight in the tangent frame of a. The scene's world frame bends space by its lift: over the 600 m of
  // two seconds at 300 m/s the two lines part by 2 mm.
  const WorldFrame frame(a.latitude_deg * kDegree_rad, a.longitude_deg * kDegree_rad, 1);
  const glm::dvec3 from = frame.world_from_geodetic(place_of(a, over_ground ? 0 : a.height_m)).m;
  const glm::dvec3 to = frame.world_from_geodetic(place_of(b, over_ground ? 0 : b.height_m)).m;
  const Geodetic there = frame.geodetic_from_world({from + u * (to - from)});
  p.latitude_deg = there.latitude_rad / kDegree_rad;
  p.longitude_deg = there.longitude_rad / kDegree_rad;
  p.height_m = over_ground ? a.height_m + u * (b.height_m - a.height_m) : there.height_m;
  p.geoid_undulation_m = a.geoid_undulation_m + u * (b.geoid_undulation_m - a.geoid_undulation_m);
  return p;
}

PoseTimeLine::PoseTimeLine(const PoseSettings& initial) : poses_{{initial, 0}} {}

void PoseTimeLine::set_rate(double rate, std::int64_t now_ns) {
  rate_ = rate;
  rate_since_ns_ = now_ns;
  arrivals_.clear();
}

std::int64_t PoseTimeLine::ticks(std::int64_t now_ns) const {
  if (rate_ == 1) return now_ns;
  return std::llround(rate_ * static_cast<double>(now_ns - rate_since_ns_)) + rate_since_ns_;
}

std::int64_t PoseTimeLine::jump_ns() const { return std::llround(rate_ * static_cast<double>(kJump_ns)); }

void PoseTimeLine::begin(const PoseSettings& pose, std::int64_t now_ns) {
  set_rate(pose.time_rate, now_ns);
  poses_.assign(1, {pose, now_ns});
  arrivals_.assign(1, {pose.sim_time_ns - ticks(now_ns), 0});
  late_in_a_row_ = 0;
}

void PoseTimeLine::set(const PoseSettings& pose, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  begin(pose, now_ns);
  timed_ = false;
}

void PoseTimeLine::aim(const PoseSettings& as) {
  const std::lock_guard lock(mutex_);
  PoseSettings& newest = poses_.back().pose;
  const double turn_deg = as.bearing_deg - newest.bearing_deg;
  for (auto& [pose, received_ns] : poses_) {
    if (turn_deg != 0) pose.bearing_deg = std::remainder(pose.bearing_deg + turn_deg, 360.0);
    pose.tilt_deg = as.tilt_deg;
    pose.tilt_auto = as.tilt_auto;
  }
  newest.bearing_deg = as.bearing_deg;  // to the bit
  newest.heading_deg = as.heading_deg;
}

void PoseTimeLine::restart() {
  const std::lock_guard lock(mutex_);
  timed_ = false;
}

bool PoseTimeLine::is_late(std::int64_t sim_time_ns) const {
  const std::lock_guard lock(mutex_);
  return timed_ && sim_time_ns < poses_.back().pose.sim_time_ns && late_in_a_row_ + 1 < kMostLate;
}

bool PoseTimeLine::add(const PoseSettings& pose, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  if (!timed_) {
    begin(pose, now_ns);
    timed_ = true;
    return true;
  }
  const std::int64_t gap_ns = pose.sim_time_ns - poses_.back().pose.sim_time_ns;
  if (gap_ns < 0) {
    ++late_;
    if (++late_in_a_row_ < kMostLate) return false;
    begin(pose, now_ns);
    return true;
  }
  late_in_a_row_ = 0;
  if (gap_ns == 0) {  // the clock stands still, or an earlier word is mended
    poses_.back() = {pose, now_ns};
    return true;
  }
  const bool new_rate = pose.time_rate != rate_;
  if (new_rate) set_rate(pose.time_rate, now_ns);
  // The gap before a new rate is of the old one.
  const std::int64_t gap_to_come_ns = new_rate ? ticks(now_ns) - ticks(poses_.back().received_ns) : gap_ns;
  if (gap_ns > jump_ns()) {
    begin(pose, now_ns);
    return true;
  }
  poses_.push_back({pose, now_ns});
  arrivals_.push_back({pose.sim_time_ns - ticks(now_ns), gap_to_come_ns});
  if (arrivals_.size() > kWindow) arrivals_.pop_front();
  follow_clock(gap_ns, new_rate || poses_.size() == 2);
  const std::int64_t shown_ns = ticks(now_ns) + shift_ns_;
  while (poses_.size() > 2 &&
         (poses_[1].pose.sim_time_ns < shown_ns - jump_ns() || poses_.size() > kMostPoses))
    poses_.pop_front();
  return true;
}

void PoseTimeLine::follow_clock(std::int64_t gap_ns, bool at_once) {
  const auto [least, most] = std::ranges::minmax(arrivals_, {}, &Arrival::offset_ns);
  const std::int64_t greatest_gap_ns = std::ranges::max(arrivals_, {}, &Arrival::gap_ns).gap_ns;
  const std::int64_t behind_ns = std::min(greatest_gap_ns + (most.offset_ns - least.offset_ns), jump_ns());
  const std::int64_t wanted_ns = most.offset_ns - behind_ns;
  const std::int64_t off_ns = wanted_ns - shift_ns_;
  if (at_once || std::abs(off_ns) > jump_ns()) {
    shift_ns_ = wanted_ns;
  } else {
    shift_ns_ += std::clamp(off_ns, -gap_ns / kSlew, gap_ns / kSlew);
  }
}

void PoseTimeLine::set_validity(double valid_s) {
  const std::lock_guard lock(mutex_);
  poses_.back().pose.valid_s = valid_s;
}

PoseAt PoseTimeLine::at(std::int64_t now_ns) const {
  const std::lock_guard lock(mutex_);
  const Sent& newest = poses_.back();
  PoseAt result{newest.pose, newest.received_ns, false, timed_, now_ns};
  const double age_s = static_cast<double>(now_ns - newest.received_ns) * 1e-9;
  result.stale = newest.received_ns != 0 && newest.pose.valid_s > 0 && age_s > newest.pose.valid_s;
  if (poses_.size() < 2) return result;
  const std::int64_t shown_ns = ticks(now_ns) + shift_ns_;
  if (timed_) {
    const std::int64_t behind_ns = std::ranges::max(arrivals_, {}, &Arrival::offset_ns).offset_ns - shift_ns_;
    result.shown_ns -= std::llround(static_cast<double>(behind_ns) / rate_);
  }
  const auto after =
      std::ranges::upper_bound(poses_, shown_ns, {}, [](const Sent& sent) { return sent.pose.sim_time_ns; });
  // The two poses that tell the velocity; before the first and past the newest the antenna waits.
  const auto to = std::clamp(after, std::next(poses_.begin()), std::prev(poses_.end()));
  const PoseSettings& a = std::prev(to)->pose;
  const PoseSettings& b = to->pose;
  if (after == poses_.begin()) {
    result.pose = a;
    result.received_ns = std::prev(to)->received_ns;
  } else if (after != poses_.end()) {
    const double u =
        static_cast<double>(shown_ns - a.sim_time_ns) / static_cast<double>(b.sim_time_ns - a.sim_time_ns);
    result.pose = between(a, b, u);
    result.received_ns = to->received_ns;
    result.pose.sim_time_ns = shown_ns;
  }
  if (!result.pose.has_velocity()) take_slope(a, b, result.pose);
  return result;
}

PoseSettings PoseTimeLine::newest() const {
  const std::lock_guard lock(mutex_);
  return poses_.back().pose;
}

std::uint64_t PoseTimeLine::late() const {
  const std::lock_guard lock(mutex_);
  return late_;
}

}  // namespace obliq
