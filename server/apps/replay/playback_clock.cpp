#include "server/apps/replay/playback_clock.h"

#include <algorithm>
#include <cmath>

#include "server/apps/replay/recorded_time.h"

namespace obliq {

// Called with the mutex held, as are all private functions.
std::int64_t PlaybackClock::read() const {
  if (!flows()) return anchor_ns_;
  if (!std::isfinite(speed_)) return std::max(anchor_ns_, reached_ns_);
  const double flown_ns = speed_ * std::chrono::duration<double, std::nano>(Clock::now() - anchored_).count();
  // Years beyond any recording's end.
  constexpr double kMost_ns = 4e18;
  return anchor_ns_ +
         static_cast<std::int64_t>(std::min(flown_ns, kMost_ns - static_cast<double>(anchor_ns_)));
}

void PlaybackClock::anchor() {
  anchor_ns_ = read();
  anchored_ = Clock::now();
}

template <class Value>
void PlaybackClock::change(Value& value, Value to) {
  const std::lock_guard lock(mutex_);
  anchor();
  value = to;
  ++changes_;
  changed_.notify_all();
}

void PlaybackClock::set_speed(double speed) { change(speed_, speed); }
void PlaybackClock::set_paused(bool paused) { change(paused_, paused); }
void PlaybackClock::set_watched(bool watched) { change(watched_, watched); }

void PlaybackClock::jump(std::int64_t to_ns) {
  const std::lock_guard lock(mutex_);
  anchor_ns_ = reached_ns_ = to_ns;
  anchored_ = Clock::now();
  ++jumps_;
  ++changes_;
  changed_.notify_all();
}

void PlaybackClock::set_back(std::int64_t to_ns) {
  const std::lock_guard lock(mutex_);
  anchor_ns_ = reached_ns_ = to_ns;
  anchored_ = Clock::now();
}

double PlaybackClock::speed() const {
  const std::lock_guard lock(mutex_);
  return speed_;
}

bool PlaybackClock::is_paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

bool PlaybackClock::runs() const {
  const std::lock_guard lock(mutex_);
  return flows();
}

std::int64_t PlaybackClock::now_ns() const {
  const std::lock_guard lock(mutex_);
  return read();
}

std::uint64_t PlaybackClock::jumps() const {
  const std::lock_guard lock(mutex_);
  return jumps_;
}

PlaybackClock::Outcome PlaybackClock::wait_until(std::int64_t at_ns, std::uint64_t jumps,
                                                 const std::stop_token& stop, Clock::duration most) {
  std::unique_lock lock(mutex_);
  const auto end = Clock::now() + most;
  for (;;) {
    if (stop.stop_requested()) return Outcome::stopped;
    if (jumps != jumps_) return Outcome::jumped;
    const std::int64_t now_ns = read();
    if (now_ns >= at_ns || (flows() && !std::isfinite(speed_))) {
      reached_ns_ = std::max(reached_ns_, at_ns);
      return Outcome::reached;
    }
    if (Clock::now() >= end) return Outcome::not_yet;
    auto until = end;
    if (flows()) until = std::min(until, Clock::now() + played(at_ns - now_ns, speed_));
    changed_.wait_until(lock, stop, until, [&, seen = changes_] { return changes_ != seen; });
  }
}

}  // namespace obliq
