#include "server/rendering/render_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/rendering/live_task.h"
#include "server/rendering/once_task.h"

namespace obliq::net {
namespace {

using Seconds = std::chrono::duration<double>;

/// How often those who hold a radar up are looked at.
constexpr std::chrono::milliseconds kReminder{20};
/// What could not be rendered is looked at again this often: pose or scene may have changed.
constexpr std::chrono::milliseconds kFaultLook{50};
/// Whoever has begun a turn goes on for so long: a turn costs some 0.1 ms of threads that come and go.
constexpr std::chrono::milliseconds kShortestTurn{5};

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
  turns_.add();
  task.name = name;
  task.stream_id = stream_id;
  task.view = std::make_shared<const LiveView>(std::move(view));
  task.frames = std::make_shared<LiveFrames>([this] { wake(); });
}

void RenderThread::start() {
  turns_.add();
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
  if (wakes) task.dates.begin_at(now);
  if (rate_hz > 0) task.dates.begin_at(std::min(task.dates.due(), now + period_of(rate_hz)));
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
  return {task.frames->live(), task.frames->meter()->bytes, task.skipped_in_all, task.shed};
}

void RenderThread::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    Choice choice;
    auto next_due = Clock::time_point::max();
    if (choose(clock_now(), choice, next_due)) {
      take_turn(choice, lock);
      continue;
    }
    if (finishing_ && once_.empty()) {
      lock.unlock();
      return events_.on_finished();
    }
    const auto woken = [this, seen = changes_.load()] { return changes_ != seen; };
    if (next_due == Clock::time_point::max()) {
      changed_.wait(lock, stop, woken);
    } else {
      changed_.wait_for(lock, stop, next_due - clock_now(), woken);
    }
  }
}

bool RenderThread::choose(Clock::time_point now, Choice& choice, Clock::time_point& next_due) {
  std::erase_if(once_, [this](const auto& task) {
    return task->job->stop.stop_requested() || (finishing_ && !task->frame);
  });
  scanning_ = !finishing_ && std::ranges::any_of(live_, [this](const LiveTask& t) { return wants_scan(t); });
  std::vector<Clock::time_point> dates;
  for (std::size_t k = 0; k < live_.size(); ++k) {
    if (live_[k].scan && (finishing_ || !wants_scan(live_[k]))) {
      choice = {.live = true, .index = k, .ends_scan = true};
      return true;
    }
    dates.push_back(live_date(k, now));
  }
  const auto has_room = [this](const auto& task) { return task->job->queued->load() < options_.slice_bytes; };
  dates.push_back(std::ranges::any_of(once_, has_room) ? now : Clock::time_point::max());
  for (std::size_t party = 0; party < dates.size(); ++party) {
    turns_.set_wanting(party, dates[party] <= now);
    if (dates[party] > now) next_due = std::min(next_due, dates[party]);
  }
  const std::optional<std::size_t> first = turns_.first();
  if (!first) return false;

  give_way_ = Clock::time_point::max();
  for (std::size_t party = 0; party < dates.size(); ++party) {
    if (party == *first || dates[party] == Clock::time_point::max()) continue;
    const auto lead = std::chrono::duration_cast<Clock::duration>(Seconds(turns_.lead_s(*first, party)));
    give_way_ = std::min(give_way_, std::max({dates[party], now + lead, now + kShortestTurn}));
  }
  choice = {.live = *first < live_.size(), .index = *first};
  while (!choice.live) {
    choice.index = once_turn_++ % once_.size();
    if (has_room(once_[choice.index])) break;
  }
  return true;
}

bool RenderThread::gives_way() const {
  const bool changed = changes_ != changes_seen_;
  if (!changed && give_way_ == Clock::time_point::max()) return false;
  const auto now = clock_now();
  return now >= give_way_ || (changed && now >= turn_began_ + kShortestTurn);
}

void RenderThread::take_turn(const Choice& choice, std::unique_lock<std::mutex>& lock) {
  if (choice.ends_scan) {
    const char* const reason = finishing_                        ? "the server is stopping"
                               : live_[choice.index].rate_hz > 0 ? "the radar's settings changed"
                                                                 : "nobody watches any more";
    lock.unlock();
    end_scan(choice.index, reason);
    lock.lock();
    return;
  }
  turn_began_ = clock_now();
  changes_seen_ = changes_;
  bool done = true;
  if (!choice.live) {
    render_once(choice.index, lock);
  } else if (!live_[choice.index].hand && wants_scan(live_[choice.index])) {
    render_dwell(choice.index, lock);
  } else {
    done = render_live(choice.index, lock);
  }
  const std::size_t party = choice.live ? choice.index : live_.size();
  turns_.charge(party, Seconds(clock_now() - turn_began_).count());
  if (done) turns_.done(party);
}

RenderThread::Clock::time_point RenderThread::live_date(std::size_t index, Clock::time_point now) {
  LiveTask& task = live_[index];
  if (task.hand) return now;
  if (finishing_ || task.rate_hz <= 0) return Clock::time_point::max();
  // Dates that pass meanwhile are not shed: nobody was to be served at them.
  if (still_faulty(task)) {
    task.dates.begin_at(now);
    return now + kFaultLook;
  }
  if (wants_scan(task)) {
    task.dates.begin_at(now);
    return scan_date(index, now);
  }
  if (task.dates.due() > now) return task.dates.due();
  return is_held_up(index, now) ? task.next_reminder : now;
}

bool RenderThread::none_is_shed(const LiveTask& task) const {
  // A renderer that only repeats has its own times.
  return !renderer_.fixed().empty() || std::ranges::any_of(task.demands, &Demand::lossless);
}

// With as many frames alive as may be, the next one waits; what it is late by was not rendered.
bool RenderThread::is_held_up(std::size_t index, Clock::time_point now) {
  LiveTask& task = live_[index];
  constexpr auto kNever = Clock::time_point::max();
  if (task.frames->live() >= options_.live_frames) {
    if (task.held_up_since == kNever) task.held_up_since = task.next_reminder = now;
    if (now >= task.next_reminder) {
      task.next_reminder = now + kReminder;
      events_.on_live_held_up(index, Seconds(now - task.held_up_since).count());
    }
    return true;
  }
  if (task.held_up_since == kNever) return false;
  if (!none_is_shed(task)) {  // else the radar is slower, and nothing is lost
    const auto period = period_of(task.rate_hz);
    const auto missed = (now - task.held_up_since) / period;
    task.skipped += static_cast<std::uint64_t>(missed);
    task.skipped_in_all += static_cast<std::uint64_t>(missed);
    task.dates.begin_at(task.dates.due() + missed * period);
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
