#include "server/rendering/live_stream.h"

#include <algorithm>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/output/describe_targets.h"
#include "terrain/base/units.h"

namespace obliq::rendering {
namespace {

constexpr auto kNever = LiveStream::Time::max();
/// How often the clients that hold a radar up are looked at.
constexpr std::chrono::milliseconds kReminder{20};
/// What could not be rendered is looked at again this often: pose or scene may have changed.
constexpr std::chrono::milliseconds kFaultLook{50};
/// Of recorded passes, which have their own times: faster than any antenna turns.
constexpr double kPassRate_hz = 1000;

}  // namespace

LiveStream::LiveStream(RenderContext& context, std::size_t radar, std::string name, std::uint32_t stream_id,
                       LiveView view, std::function<void()> on_freed)
    : context_(context),
      radar_(radar),
      name_(std::move(name)),
      stream_id_(stream_id),
      frames_(std::make_shared<stream::LiveFrames>(std::move(on_freed))),
      view_(std::make_shared<const LiveView>(std::move(view))) {}

void LiveStream::set_view(LiveView view) {
  const std::lock_guard lock(mutex_);
  view_ = std::make_shared<const LiveView>(std::move(view));
  if (!held_since_ || wants_scan(*view_)) return;
  for (Demand& demand : demands_) demand.due = {};
}

void LiveStream::hold(bool on) {
  const std::lock_guard lock(mutex_);
  if (on == held_since_.has_value()) return;
  const auto now = context_.now();
  if (on) {
    held_since_ = now;
    if (wants_scan(*view_))
      for (Demand& demand : demands_) demand.due = now;  // they see the pass that stands
    return;
  }
  pause_ += now - *std::exchange(held_since_, std::nullopt);
  dates_.begin_at(now);
}

LiveStream::Time::duration LiveStream::take_pause() {
  const std::lock_guard lock(mutex_);
  return std::exchange(pause_, {});
}

bool LiveStream::stands_still() const {
  return held_since_ && std::ranges::all_of(demands_, &Demand::is_served);
}

bool LiveStream::wants_still() const {
  const std::lock_guard lock(mutex_);
  return rate_hz_ > 0 && held_since_ && wants_scan(*view_) && !stands_still();
}

void LiveStream::set_demand(std::vector<Demand> demands) {
  const std::lock_guard lock(mutex_);
  double rate_hz = 0;
  for (Demand& demand : demands) {
    if (context_.renderer.has_passes()) demand.rate_hz = kPassRate_hz;
    rate_hz = std::max(rate_hz, demand.rate_hz);
    const auto same = std::ranges::find(demands_, demand.watch_id, &Demand::watch_id);
    if (same != demands_.end()) demand.due = same->due;
  }
  // A faster rate, or a first client, does not wait for a date that the old rate set.
  const auto now = context_.now();
  if (rate_hz_ == 0 && rate_hz > 0) dates_.begin_at(now);
  if (rate_hz > 0) dates_.begin_at(std::min(dates_.due(), now + period_of(rate_hz)));
  if (rate_hz == 0) {
    stop_.request_stop();
    held_up_since_ = kNever;  // no client waits
  }
  frames_->meter()->spare.keep(rate_hz > 0);
  rate_hz_ = rate_hz;
  demands_ = std::move(demands);
}

void LiveStream::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  stop_.request_stop();
}

LiveStream::Load LiveStream::load() const {
  return {frames_->live(), frames_->meter()->bytes, frames_->meter()->spare.bytes(), skipped_in_all_, shed_};
}

std::shared_ptr<const LiveView> LiveStream::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

bool LiveStream::is_watched() const {
  const std::lock_guard lock(mutex_);
  return rate_hz_ > 0;
}

bool LiveStream::wants_scan() const {
  const std::lock_guard lock(mutex_);
  return rate_hz_ > 0 && wants_scan(*view_);
}

bool LiveStream::wants_scan(const LiveView& view) const {
  // A renderer that only replays has its own times.
  return view.settings->settings.scan_mode != ScanMode::frame && context_.renderer.fixed().empty();
}

bool LiveStream::sheds_none() const {
  // A renderer that only replays has its own times.
  return !context_.renderer.fixed().empty() || std::ranges::any_of(demands_, &Demand::lossless);
}

bool LiveStream::still_faulty(Time now) const {
  if (!faulty_ || faulty_generation_ != context_.renderer.generation()) return false;
  const LiveView view = view_->at(in_nanoseconds(now));
  return view.settings == faulty_->settings && view.pose == faulty_->pose;
}

std::optional<LiveStream::Time> LiveStream::rests_until(Time now) {
  const std::lock_guard lock(mutex_);
  if (context_.finishing || rate_hz_ <= 0 || stands_still()) return kNever;
  if (!still_faulty(now)) return std::nullopt;
  dates_.begin_at(now);
  return now + kFaultLook;
}

LiveStream::Time LiveStream::due() const {
  const std::lock_guard lock(mutex_);
  return dates_.due();
}

void LiveStream::put_off(Time now) {
  const std::lock_guard lock(mutex_);
  dates_.begin_at(now);
}

LiveStream::Time LiveStream::free_at(Time now) {
  std::unique_lock lock(mutex_);
  if (frames_->live() >= context_.options.live_frames) {
    if (held_up_since_ == kNever) held_up_since_ = next_reminder_ = now;
    const double since_s = to_seconds(now - held_up_since_);
    lock.unlock();
    if (now >= next_reminder_) {
      next_reminder_ = now + kReminder;
      context_.events.on_live_held_up(radar_, since_s);
    }
    return next_reminder_;
  }
  const Time since = std::exchange(held_up_since_, kNever);
  // Where none is shed the radar is slower, and nothing is lost.
  if (since == kNever || rate_hz_ <= 0 || sheds_none()) return now;
  const auto period = period_of(rate_hz_);
  const auto missed = (now - since) / period;
  dates_.begin_at(dates_.due() + missed * period);
  skip(static_cast<std::uint64_t>(missed));
  return now;
}

std::stop_token LiveStream::new_stop() {
  stop_ = std::stop_source();
  return stop_.get_token();
}

std::optional<LiveStream::Start> LiveStream::begin_frame(Time now) {
  const std::lock_guard lock(mutex_);
  if (stopped_ || rate_hz_ <= 0 || (wants_scan(*view_) && !held_since_) || stands_still())
    return std::nullopt;
  const FrameDates::Taken date = dates_.take(now, period_of(rate_hz_), sheds_none());
  Start start;
  start.demands = take_due(demands_, now, held_since_.has_value());
  if (start.demands.empty()) return std::nullopt;
  start.view = std::make_shared<const LiveView>(view_->at(in_nanoseconds(now)));
  start.late_s = to_seconds(date.late);
  start.stop = new_stop();
  shed_ += date.shed;
  return start;
}

void LiveStream::take_all(Start& start) const {
  const std::lock_guard lock(mutex_);
  start.demands = demands_;
}

void LiveStream::give_back(const Start& start, Time now) {
  const std::lock_guard lock(mutex_);
  dates_.begin_at(now);
  rendering::give_back(start.demands, demands_);
}

std::optional<LiveStream::Start> LiveStream::begin_dwell() {
  const std::lock_guard lock(mutex_);
  if (stopped_ || rate_hz_ <= 0 || !wants_scan(*view_) || held_since_) return std::nullopt;
  return Start{view_, demands_, 0, new_stop()};
}

void LiveStream::skip(std::uint64_t frames) {
  skipped_ += frames;
  skipped_in_all_ += frames;
}

void LiveStream::set_faulty(std::shared_ptr<const LiveView> view, std::uint64_t generation) {
  faulty_ = std::move(view);
  faulty_generation_ = generation;
}

BegunFrame::BegunFrame(LiveStream& stream_of, std::uint64_t id, std::unique_ptr<PlannedFrame> planned,
                       const RadarSettings& settings, const Order& order, const LiveView& view,
                       double waited_s)
    : stream(stream_of),
      frame_id(id),
      encoder({.stream_id = stream.stream_id_,
               .frame_id = id,
               .choices = order.choices,
               .pose_received_ns = view.pose_received_ns,
               .frames_skipped = std::exchange(stream.skipped_, 0),
               .waited_s = waited_s,
               .meter = stream.frames_->meter()},
              stream.sequence_),
      stats(settings),
      frame(stream.frames_->open(id, order.takers)),
      iq(order.iq),
      states(order.states),
      video8(order.video8),
      video16(order.video16),
      labels(order.labels),
      target_ids(order.target_ids),
      truth(order.truth),
      bins(order.bins),
      pulses(order.pulses),
      azimuth_bins(settings.azimuth_bins),
      targets(stream.context_.targets.get()),
      plan(std::move(planned)) {
  rendered.waited_s = waited_s;
  if (stream.context_.renderer.fixed().empty()) receiver.emplace(settings, stream.name_, id, plan->air());
}

RenderOptions BegunFrame::render_options(const std::stop_token& stop, const LiveView& view) const {
  RenderOptions options = stream.context_.render_options(iq, states, stop);
  options.targets = targets.get();
  options.targets_at = view.targets_at;
  if (receiver) options.receiver = &*receiver;
  options.video8 = video8;
  options.video16 = video16;
  options.labels = labels;
  options.target_ids = target_ids;
  options.draw = frame_draw(stream.name_, frame_id);
  return options;
}

void BegunFrame::send_truth(const AzimuthRange& azimuths, const RenderOptions& options) {
  if (!truth) return;
  const double noise_w = receiver ? receiver->noise_power_w() : 0;
  send({encoder.targets(azimuths, plan->truth(azimuths, options, noise_w))});
}

bool BegunFrame::send_train(const TrainLook& look, const RenderOptions& options) {
  auto made = plan->render_train(look, options);
  if (!made) return false;
  // Where no bins are wanted it counts for the frame.
  if (!bins) stats.add({look.azimuths.first / kWedgeAzimuthBins, {}, made->stats});
  send(encoder.train(made->train));
  return true;
}

void BegunFrame::send(std::vector<stream::BlockPtr> blocks) const {
  stream.context_.events.on_live_blocks(stream.radar_, frame, std::move(blocks));
}

void BegunFrame::send_begin(const LiveView& view) {
  wire::FrameDescriptor descriptor;
  plan->describe(stream.name_, descriptor);
  if (receiver) describe_receiver(*receiver, descriptor);
  descriptor.set_frame_id(frame_id);
  descriptor.set_pose_stale(view.pose_stale);
  describe_targets(targets, descriptor);
  send(encoder.begin(descriptor));
}

void BegunFrame::send_end(const std::vector<AzimuthRange>& missed) {
  wire::FrameSummary summary;
  plan->summarise(stats.total(), summary);
  summary.set_frame_id(frame_id);
  rendered.rays = summary.rays();
  rendered.hits = summary.hits();
  rendered.coverage = summary.coverage();
  send({encoder.end(summary, rendered.render_s, missed)});
}

void BegunFrame::send_abort(const std::string& reason) { send({encoder.abort(reason)}); }

}  // namespace obliq::rendering
