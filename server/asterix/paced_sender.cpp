#include "server/asterix/paced_sender.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <span>
#include <utility>

#include "proto/message_codec.h"
#include "terrain/base/units.h"

namespace obliq::asterix {
namespace {

using Clock = Pace::Clock;

// Datagrams go out in groups of what is due within this time: a thread cannot be woken for each of 10,000 a
// second. Ten of a kilobyte each are a twentieth of a receiver's default buffer (208 kB,
// net.core.rmem_default).
constexpr Clock::duration kGroup = std::chrono::milliseconds(1);
// A thread that was not scheduled in time catches up twice as fast as the datagrams were planned, in no
// burst.
constexpr int kCatchUp = 2;
// More waits only where the plan is impossible, and is dropped.
constexpr std::size_t kMostWaiting = std::size_t{64} << 20;

}  // namespace

PacedSender::PacedSender(UdpTarget target)
    : target_(std::move(target)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

PacedSender::~PacedSender() {
  thread_.request_stop();
  thread_.join();
}

void PacedSender::queue(std::vector<Bytes> messages, const Pace::Times& times,
                        std::optional<std::int64_t> utc_ns) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (due_octets_ + messages[i].size() > kMostWaiting) {
      counts_.not_sent += messages.size() - i;
      counts_.error = ENOBUFS;
      break;
    }
    due_octets_ += messages[i].size();
    due_.push_back({std::move(messages[i]), times.at(i), utc_ns});
  }
  changed_.notify_all();
}

void PacedSender::drain() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return due_.empty() && !sending_; });
}

SenderCounts PacedSender::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

// What goes out now. Called with the mutex held.
std::vector<Bytes> PacedSender::take_due() {
  std::vector<Bytes> group;
  const auto end = std::min(due_.front().at + kCatchUp * kGroup, Clock::now() + kGroup);
  const std::int64_t now_ns = wire::utc_now_ns();
  while (!due_.empty() && (group.empty() || due_.front().at < end)) {
    Due& due = due_.front();
    stamp(due.message, due.utc_ns.value_or(now_ns));
    due_octets_ -= due.message.size();
    group.push_back(std::move(due.message));
    due_.pop_front();
  }
  return group;
}

void PacedSender::send(std::vector<Bytes>& messages) {
  std::span<const Bytes> rest = messages;
  while (!rest.empty()) {
    int error = 0;
    const std::size_t sent = target_.send(rest, error);
    rest = rest.subspan(sent);
    const std::lock_guard lock(mutex_);
    counts_.sent += sent;
    if (error == 0) continue;
    // That one is left out: a display wants the newest radial, not an old one late.
    ++counts_.not_sent;
    counts_.error = error;
    rest = rest.subspan(1);
  }
}

void PacedSender::run(const std::stop_token& stop) {
  auto earliest = Clock::now();
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!changed_.wait(lock, stop, [this] { return !due_.empty(); })) return;
    const auto at = std::max(earliest, due_.front().at);
    if (changed_.wait_until(lock, stop, at, [] { return false; }); stop.stop_requested()) return;
    if (Clock::now() < at) continue;
    std::vector<Bytes> group = take_due();
    earliest = Clock::now() + kGroup;
    sending_ = true;
    lock.unlock();
    send(group);
    lock.lock();
    sending_ = false;
    if (due_.empty()) changed_.notify_all();
  }
}

namespace {
constexpr int kMostSqueezed = 4;
}

Pace::Times Pace::spread(Clock::time_point now, std::size_t datagrams, Clock::duration period) {
  const auto first = std::max(now, free_from_);
  free_from_ = std::max(now + period, first + period / kMostSqueezed);
  const auto n = static_cast<Clock::rep>(std::max<std::size_t>(datagrams, 1));
  return {first, (free_from_ - first) / n};
}

FramePeriod::FramePeriod(double rate_hz) : asked_(from_seconds(1 / rate_hz)), before_(asked_) {}

Pace::Clock::duration FramePeriod::next(Pace::Clock::time_point now) {
  const auto since = newest_ == Pace::Clock::time_point{} ? asked_ : std::max(now - newest_, asked_);
  newest_ = now;
  // Of two: one long pause says nothing about the next.
  const auto period = std::min(since, before_);
  before_ = since;
  return period;
}

Pace::Clock::duration DwellPeriod::next(Pace::Clock::time_point now, Pace::Clock::duration beam) {
  constexpr double kMost = 10;     // a pause is no slow beam
  constexpr double kNewest = 0.2;  // of the mean: dwells that come bunched do not count as fast ones
  if (newest_ != Pace::Clock::time_point{} && beam.count() > 0) {
    const double part = std::chrono::duration<double>(now - newest_) / std::chrono::duration<double>(beam);
    part_ += kNewest * (std::min(part, kMost) - part_);
  }
  newest_ = now;
  return from_seconds(std::min(part_, 1.0) * to_seconds(beam));
}

}  // namespace obliq::asterix
