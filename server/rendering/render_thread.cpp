#include "server/rendering/render_thread.h"

#include <algorithm>
#include <utility>

#include "terrain/base/units.h"

namespace obliq::net {

RenderThread::Radar::Radar(RenderContext& context, std::size_t number, const std::string& name,
                           std::uint32_t stream_id, LiveView view, std::function<void()> on_freed)
    : stream(context, number, name, stream_id, std::move(view), std::move(on_freed)),
      frames(context, stream),
      scan(context, stream) {}

RenderThread::RenderThread(const FrameRenderer& renderer, RenderEvents& events, RenderThreadOptions options)
    : context_{.renderer = renderer, .events = events, .options = std::move(options)},
      once_(context_),
      appraisals_(context_) {}

RenderThread::~RenderThread() { end(); }

void RenderThread::end() {
  stop();
  if (thread_.joinable()) thread_.join();
  for (Radar& radar : radars_) radar.stream.forget_listener();
}

void RenderThread::add_radar(const std::string& name, std::uint32_t stream_id, LiveView view) {
  radars_.emplace_back(context_, radars_.size(), name, stream_id, std::move(view), [this] { wake(); });
  shares_.add();
}

void RenderThread::start() {
  shares_.add();
  shares_.add();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void RenderThread::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake();
}

void RenderThread::stop() {
  thread_.request_stop();
  for (Radar& radar : radars_) radar.stream.stop();
  once_.stop();
  appraisals_.stop();
}

void RenderThread::set_view(std::size_t radar, LiveView view) {
  radars_[radar].stream.set_view(std::move(view));
  wake();
}

void RenderThread::set_demand(std::size_t radar, std::vector<Demand> demands) {
  radars_[radar].stream.set_demand(std::move(demands));
  wake();
}

void RenderThread::hold(bool on) {
  for (Radar& radar : radars_) radar.stream.hold(on);
  wake();
}

void RenderThread::enqueue(OnceRequestPtr request) {
  once_.enqueue(std::move(request));
  wake();
}

void RenderThread::enqueue(AppraisalPtr appraisal) {
  appraisals_.enqueue(std::move(appraisal));
  wake();
}

void RenderThread::wake() {
  const std::lock_guard lock(mutex_);
  ++context_.changes;
  changed_.notify_all();
}

void RenderThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    begin_round();
    end_scans();
    auto next_due = Time::max();
    if (const auto turn = choose(context_.now(), next_due)) {
      take(*turn);
    } else if (context_.finishing && once_.is_empty()) {
      return context_.events.on_finished();
    } else {
      wait(stop, next_due);
    }
  }
  for (Radar& radar : radars_) {
    radar.frames.give_up();
    radar.scan.end("the server is stopping");
  }
  once_.give_up();
  appraisals_.give_up();
}

void RenderThread::begin_round() {
  const std::lock_guard lock(mutex_);
  seen_ = context_.changes;
  context_.finishing = finishing_;
}

void RenderThread::end_scans() {
  for (Radar& radar : radars_) {
    if (!radar.scan.has_begun()) continue;
    if (context_.finishing) {
      radar.scan.end("the server is stopping");
    } else if (!radar.stream.wants_scan()) {
      radar.scan.end(radar.stream.is_watched() ? "the radar's settings changed" : "no watchers left");
    }
  }
}

std::optional<RenderThread::Turn> RenderThread::choose(Time now, Time& next_due) {
  std::vector<Job*> jobs;
  context_.scanning = false;
  for (Radar& radar : radars_) {
    const bool scans = radar.stream.wants_scan() && !radar.stream.wants_still();
    jobs.push_back(scans && !radar.frames.has_begun() ? static_cast<Job*>(&radar.scan) : &radar.frames);
    context_.scanning |= scans && !context_.finishing;
  }
  jobs.push_back(&once_);
  jobs.push_back(&appraisals_);
  std::vector<Time> dates;
  for (std::size_t party = 0; party < jobs.size(); ++party) {
    dates.push_back(jobs[party]->date(now));
    shares_.set_wanting(party, dates[party] <= now);
    if (dates[party] > now) next_due = std::min(next_due, dates[party]);
  }
  const std::optional<std::size_t> first = shares_.first();
  if (!first) return std::nullopt;

  context_.turn_ends = Time::max();
  for (std::size_t party = 0; party < dates.size(); ++party) {
    if (party == *first || dates[party] == Time::max()) continue;
    const auto lead = from_seconds(shares_.lead_s(*first, party));
    context_.turn_ends =
        std::min(context_.turn_ends, std::max({dates[party], now + lead, now + kShortestTurn}));
  }
  return Turn{jobs[*first], *first};
}

void RenderThread::take(const Turn& turn) {
  context_.turn_began = context_.now();
  context_.changes_seen = seen_;
  const bool done = turn.job->work();
  shares_.charge(turn.party, to_seconds(context_.now() - context_.turn_began));
  if (done) shares_.done(turn.party);
}

void RenderThread::wait(const std::stop_token& stop, Time until) {
  std::unique_lock lock(mutex_);
  const auto woken = [this] { return context_.changes != seen_; };
  if (until == Time::max()) {
    changed_.wait(lock, stop, woken);
  } else {
    changed_.wait_for(lock, stop, until - context_.now(), woken);
  }
}

}  // namespace obliq::net
