#include "server/net/render_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/net/once_task.h"

namespace obliq::net {
namespace {

using Seconds = std::chrono::duration<double>;

/// How often those who hold a radar up are looked at.
constexpr std::chrono::milliseconds kReminder{20};
/// What could not be rendered is looked at again this often: pose or scene may have changed.
constexpr std::chrono::milliseconds kFaultLook{50};

}  // namespace

RenderThread::RenderThread(const FrameRenderer& renderer, RenderEvents& events, RenderThreadOptions options)
    : renderer_(renderer), events_(events), options_(std::move(options)) {}

RenderThread::~RenderThread() { end(); }

void RenderThread::end() {
  stop();
  if (thread_.joinable()) thread_.join();
  for (LiveTask& task : live_) task.frames->forget_listener();
}

void RenderThread::add_radar(const std::string& name, std::uint32_t stream_id, LiveView view) {
  LiveTask& task = live_.emplace_back();
  task.name = name;
  task.stream_id = stream_id;
  task.view = std::make_shared<const LiveView>(std::move(view));
  task.frames = std::make_shared<LiveFrames>([this] { wake(); });
}

void RenderThread::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void RenderThread::finish() {
  const std::lock_guard lock(mutex_);
  finishing_ = true;
  ++changes_;
  changed_.notify_all();
}

void RenderThread::stop() {
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  for (LiveTask& task : live_) task.stop.request_stop();
  for (const auto& task : once_) task->job->stop.request_stop();
}

void RenderThread::set_view(std::size_t radar, LiveView view) {
  const std::lock_guard lock(mutex_);
  live_[radar].view = std::make_shared<const LiveView>(std::move(view));
  ++changes_;
  changed_.notify_all();
}

void RenderThread::set_demand(std::size_t radar, std::vector<Demand> demands) {
  const std::lock_guard lock(mutex_);
  LiveTask& task = live_[radar];
  double rate_hz = 0;
  for (Demand& demand : demands) {
    rate_hz = std::max(rate_hz, demand.rate_hz);
    const auto same = std::find_if(task.demands.begin(), task.demands.end(),
                                   [&](const Demand& d) { return d.watch_id == demand.watch_id; });
    if (same != task.demands.end()) demand.due = same->due;
  }
  const bool wakes = task.rate_hz == 0 && rate_hz > 0;
  // A faster rate, or a first client, does not wait for a date that the old rate set.
  const auto now = clock_now();
  if (wakes) task.due = now;
  if (rate_hz > 0) {
    task.due = std::min(task.due, now + period_of(rate_hz));
  }
  if (rate_hz == 0) {
    task.stop.request_stop();
    task.held_up_since = Clock::time_point::max();  // nobody waits
  }
  task.rate_hz = rate_hz;
  task.demands = std::move(demands);
  ++changes_;
  changed_.notify_all();
}

void RenderThread::enqueue(OnceJobPtr job) {
  auto task = std::make_shared<OnceTask>();
  task->job = std::move(job);
  const std::lock_guard lock(mutex_);
  once_.push_back(std::move(task));
  ++changes_;
  changed_.notify_all();
}

void RenderThread::wake() {
  const std::lock_guard lock(mutex_);
  ++changes_;
  changed_.notify_all();
}

RenderThread::Load RenderThread::load(std::size_t radar) const {
  const LiveTask& task = live_[radar];
  return {task.frames->live(), task.frames->meter()->bytes, task.skipped_in_all};
}

void RenderThread::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    Choice choice;
    auto next_due = Clock::time_point::max();
    if (choose(clock_now(), choice, next_due)) {
      if (choice.live) {
        const LiveTask& task = live_[choice.index];
        if (!finishing_ && wants_scan(task)) {
          render_dwell(choice.index, lock);
        } else if (task.scan) {
          const bool watched = task.rate_hz > 0;
          lock.unlock();
          end_scan(choice.index, watched ? "the radar's settings changed" : "nobody watches any more");
          lock.lock();
        } else {
          render_live(choice.index, lock);
        }
      } else {
        render_once(choice.index, lock);
      }
      continue;
    }
    if (finishing_ && once_.empty()) {
      lock.unlock();
      return events_.on_finished();
    }
    const auto woken = [this, seen = changes_] { return changes_ != seen; };
    if (next_due == Clock::time_point::max()) {
      changed_.wait(lock, stop, woken);
    } else {
      changed_.wait_for(lock, stop, next_due - clock_now(), woken);
    }
  }
}

// Live radars and jobs form one ring; the search goes on where it last stopped, so each gets its turn.
bool RenderThread::choose(Clock::time_point now, Choice& choice, Clock::time_point& next_due) {
  std::erase_if(once_, [this](const auto& task) {
    return task->job->stop.stop_requested() || (finishing_ && !task->frame);
  });
  const std::size_t n = live_.size() + once_.size();
  scanning_ = !finishing_ && std::ranges::any_of(live_, [this](const LiveTask& t) { return wants_scan(t); });
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = (turn_ + i) % n;
    if (at < live_.size()) {
      const LiveTask& task = live_[at];
      if (task.scan && (finishing_ || !wants_scan(task))) {  // to be ended
        choice = {true, at};
        return true;
      }
      if (finishing_ || task.rate_hz <= 0) continue;
      if (still_faulty(task)) {
        next_due = std::min(next_due, now + kFaultLook);
        continue;
      }
      if (wants_scan(task)) {
        if (!scan_is_due(at, now, next_due)) continue;
        choice = {true, at};
        turn_ = at + 1;
        return true;
      }
      if (task.due > now) {
        next_due = std::min(next_due, task.due);
        continue;
      }
      if (is_held_up(at, now, next_due)) continue;
      choice = {true, at};
    } else {
      const std::size_t index = at - live_.size();
      if (once_[index]->job->queued->load() >= options_.slice_bytes) continue;
      choice = {false, index};
    }
    turn_ = at + 1;
    return true;
  }
  return false;
}

// With as many frames alive as may be, the next one waits; what it is late by was not rendered.
bool RenderThread::is_held_up(std::size_t index, Clock::time_point now, Clock::time_point& next_due) {
  LiveTask& task = live_[index];
  constexpr auto kNever = Clock::time_point::max();
  if (task.frames->live() >= options_.live_frames) {
    if (task.held_up_since == kNever) task.held_up_since = task.next_reminder = now;
    if (now >= task.next_reminder) {
      task.next_reminder = now + kReminder;
      events_.on_live_held_up(index, Seconds(now - task.held_up_since).count());
    }
    next_due = std::min(next_due, task.next_reminder);
    return true;
  }
  if (task.held_up_since == kNever) return false;
  const bool lossless = std::any_of(task.demands.begin(), task.demands.end(),
                                    [](const Demand& demand) { return demand.lossless; });
  if (!lossless) {  // else the radar is slower, and nothing is lost
    const auto missed = static_cast<std::uint64_t>((now - task.held_up_since) / period_of(task.rate_hz));
    task.skipped += missed;
    task.skipped_in_all += missed;
  }
  task.held_up_since = kNever;
  return false;
}

FrameIdentity RenderThread::identity_of(LiveTask& task, std::uint64_t frame_id, const Order& order,
                                        const LiveView& view) {
  FrameIdentity identity;
  identity.stream_id = task.stream_id;
  identity.frame_id = frame_id;
  identity.choices = order.choices;
  identity.pose_received_ns = view.pose_received_ns;
  identity.frames_skipped = std::exchange(task.skipped, 0);
  identity.meter = task.frames->meter();
  return identity;
}

}  // namespace obliq::net
