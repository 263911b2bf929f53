#include "server/rendering/render_thread.h"

#include <algorithm>
#include <utility>

#include "terrain/base/units.h"

namespace obliq::rendering {

RenderThread::Radar::Radar(RenderContext& context, std::size_t number, const std::string& name,
                           std::uint32_t stream_id, LiveView view, std::function<void()> on_freed)
    : stream(context, number, name, stream_id, std::move(view), std::move(on_freed)),
      frames(context, stream),
      scan(context, stream) {}

RenderThread::RenderThread(const FrameRenderer& renderer, RenderEvents& events, RenderThreadOptions options)
    : context_{.renderer = renderer, .events = events, .options = std::move(options)},
      requests_(context_),
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
  requests_.stop();
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

void RenderThread::enqueue(FrameRequestPtr request) {
  requests_.enqueue(std::move(request));
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
    } else if (context_.finishing && requests_.is_empty()) {
      return context_.events.on_finished();
    } else {
      wait(stop, next_due);
    }
  }
  for (Radar& radar : radars_) {
    radar.frames.give_up();
    radar.scan.end("the server is stopping");
  }
  requests_.give_up();
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
  jobs.push_back(&requests_);
  jobs.push_back(&appraisals_);
  std::vector<Time> dates;
  for (std::size_t flow = 0; flow < jobs.size(); ++flow) {
    dates.push_back(jobs[flow]->date(now));
    shares_.set_wanting(flow, dates[flow] <= now);
    if (dates[flow] > now) next_due = std::min(next_due, dates[flow]);
  }
  const std::optional<std::size_t> first = shares_.first();
  if (!first) return std::nullopt;

  context_.turn_ends = Time::max();
  for (std::size_t flow = 0; flow < dates.size(); ++flow) {
    if (flow == *first || dates[flow] == Time::max()) continue;
    const auto lead = from_seconds(shares_.lead_s(*first, flow));
    context_.turn_ends =
        std::min(context_.turn_ends, std::max({dates[flow], now + lead, now + kShortestTurn}));
  }
  return Turn{jobs[*first], *first};
}

void RenderThread::take(const Turn& turn) {
  context_.turn_began = context_.now();
  context_.changes_seen = seen_;
  const bool done = turn.job->work();
  shares_.charge(turn.flow, to_seconds(context_.now() - context_.turn_began));
  if (done) shares_.done(turn.flow);
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

}  // namespace obliq::rendering
