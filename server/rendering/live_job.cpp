#include "server/rendering/live_job.h"

#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq::rendering {

LiveJob::LiveJob(const RenderContext& context, LiveStream& stream) : context_(context), stream_(stream) {}

LiveJob::~LiveJob() = default;

Job::Time LiveJob::date(Time now) {
  if (work_) return now;
  if (const auto rest = stream_.rests_until(now)) return *rest;
  const Time due = stream_.due();
  return due > now ? due : stream_.free_at(now);
}

bool LiveJob::work() {
  if (!work_) {
    const Time now = context_.now();
    auto start = stream_.begin_frame(now);
    if (!start) return false;
    start_ = std::move(*start);
    begun_ = now;
    generation_ = context_.renderer.generation();
    errors_.clear();
    work_ = std::make_unique<ParkedWork>([this] { render(); }, start_.stop, context_.options.look);
  }
  try {
    if (!context_.turn(*work_)) return false;
  } catch (const std::exception& e) {  // no memory, above all
    if (frame_) frame_->send_abort(failure_text(e));
    errors_ = memory_failure(e);
  }
  work_ = nullptr;
  stream_.set_faulty(errors_.empty() ? nullptr : start_.view, generation_);
  if (!errors_.empty()) context_.events.on_live_fault(stream_.radar(), start_.view, errors_);
  return std::exchange(frame_, nullptr) != nullptr;
}

void LiveJob::give_up() {
  work_ = nullptr;
  frame_ = nullptr;
}

void LiveJob::render() {
  if (!plan()) return;
  BegunFrame& frame = *frame_;
  RenderOptions options = frame.render_options(start_.stop, *start_.view);
  const auto take_dwell = [&] {
    if (const wire::WedgeBlock* dwell = frame.plan->dwell())
      frame.encoder.set_dwell(dwell->pose(), dwell->pose_received_ns(), dwell->pose_stale(),
                              dwell->beam_ns());
  };
  options.on_wedge = [&](Wedge&& wedge) {
    if (frame.rendered.first_wedge_s == 0) frame.rendered.first_wedge_s = to_seconds(context_.now() - begun_);
    frame.stats.add(wedge);
    take_dwell();
    frame.send(frame.encoder.wedge(wedge.index, wedge.bins));
  };
  options.on_train = [&](PulseTrain&& train) {
    take_dwell();
    frame.send(frame.encoder.train(train));
  };
  const bool replays = !context_.renderer.fixed().empty();
  for (const AzimuthRange& azimuths : azimuths_)
    if ((frame.bins || replays) && !frame.plan->render(azimuths, options))
      return frame.send_abort(frame.plan->why_stopped());
  if (frame.pulses && !replays && !frame.send_train({{0, frame.azimuth_bins}, 0}, options))
    return frame.send_abort(frame.plan->why_stopped());
  frame.send_truth({0, frame.azimuth_bins}, options);
  end();
}

/// False when there is no frame after all.
bool LiveJob::plan() {
  auto plan = context_.renderer.plan(start_.view->settings, start_.view->pose);
  errors_ = std::move(plan.errors);
  if (!plan.frame && errors_.empty()) stream_.give_back(start_, context_.now());  // nothing new
  if (!plan.frame) return false;
  if (plan.for_all) stream_.take_all(start_);
  const SettingsPtr made_with = plan.settings ? plan.settings : start_.view->settings;
  Order order = order_of(start_.demands, made_with->settings);
  azimuths_ = std::move(order.azimuths);
  frame_ = std::make_unique<BegunFrame>(stream_, stream_.next_frame_id(), std::move(plan.frame),
                                        made_with->settings, order, *start_.view, start_.late_s);
  if (const wire::ScanPass* scan = frame_->plan->scan()) frame_->encoder.set_scan(*scan);
  frame_->send_begin(*start_.view);
  return true;
}

void LiveJob::end() {
  BegunFrame& frame = *frame_;
  frame.rendered.render_s = to_seconds(context_.now() - begun_);
  frame.send_end(frame.plan->missed());
  // A pose that stays has no latency: its age grows and says nothing.
  const std::int64_t received_ns = start_.view->pose_received_ns;
  if (received_ns > shown_pose_ns_) {
    frame.rendered.pose_to_end_s = 1e-9 * static_cast<double>(in_nanoseconds(context_.now()) - received_ns);
    shown_pose_ns_ = received_ns;
  }
  context_.events.on_live_rendered(stream_.radar(), frame.rendered);
}

}  // namespace obliq::rendering
