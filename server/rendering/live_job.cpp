#include "server/rendering/live_job.h"

#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "terrain/base/errors.h"
#include "terrain/base/seconds.h"

namespace obliq::net {

struct LiveJob::Frame : BegunFrame {
  using BegunFrame::BegunFrame;

  std::vector<AzimuthRange> azimuths;
  std::size_t part = 0;  ///< of the azimuths
  RenderPause pause;     ///< within the part
  Time begun;
  std::shared_ptr<const LiveView> view;
  std::uint64_t generation = 0;  ///< of the renderer when it was planned
  std::stop_token stop;
};

LiveJob::LiveJob(const RenderContext& context, LiveStream& stream) : context_(context), stream_(stream) {}

LiveJob::~LiveJob() = default;

Job::Time LiveJob::date(Time now) {
  if (frame_) return now;
  if (const auto rest = stream_.rests_until(now)) return *rest;
  const Time due = stream_.due();
  return due > now ? due : stream_.free_at(now);
}

bool LiveJob::work() {
  if (!frame_ && !begin()) return false;
  const bool over = go_on(*frame_);
  if (over) frame_ = nullptr;
  return over;
}

bool LiveJob::begin() {
  const Time now = context_.now();
  const std::uint64_t generation = context_.renderer.generation();
  const auto start = stream_.begin_frame(now);
  if (!start) return false;
  const std::uint64_t frame_id = stream_.next_frame_id();
  std::vector<FieldError> errors;
  try {
    auto plan = context_.renderer.plan(start->view->settings, start->view->pose);
    if (plan.frame) {
      const SettingsPtr made_with = plan.settings ? plan.settings : start->view->settings;
      Order order = order_of(start->demands, made_with->settings);
      auto frame = std::make_unique<Frame>(stream_, frame_id, std::move(plan.frame), made_with->settings,
                                           order, *start->view, start->late_s);
      frame->azimuths = std::move(order.azimuths);
      frame->begun = now;
      frame->view = start->view;
      frame->generation = generation;
      frame->stop = start->stop;
      if (const wire::ScanPass* scan = frame->plan->scan()) frame->encoder.set_scan(*scan);
      frame->send_begin(*start->view);
      frame_ = std::move(frame);
    } else if (plan.errors.empty()) {  // nothing new
      stream_.take_back_frame_id();
      stream_.give_back(*start, context_.now());
    }
    errors = std::move(plan.errors);
  } catch (const std::exception& e) {  // no memory, above all
    errors = memory_failure(e);
  }
  stream_.set_faulty(errors.empty() ? nullptr : start->view, generation);
  if (!errors.empty()) context_.events.on_live_fault(stream_.radar(), start->view, errors);
  return frame_ != nullptr;
}

bool LiveJob::go_on(Frame& frame) {
  try {
    RenderOptions options = frame.render_options(frame.stop, &frame.pause);
    options.on_wedge = [&](Wedge&& wedge) {
      if (frame.rendered.first_wedge_s == 0)
        frame.rendered.first_wedge_s = to_seconds(context_.now() - frame.begun);
      frame.stats.add(wedge);
      if (const wire::WedgeBlock* dwell = frame.plan->dwell())
        frame.encoder.set_dwell(dwell->pose(), dwell->pose_received_ns(), dwell->pose_stale(),
                                dwell->beam_ns());
      frame.send(frame.encoder.wedge(wedge.index, wedge.bins));
    };
    for (; frame.part < frame.azimuths.size(); ++frame.part) {
      if (!frame.plan->render(frame.azimuths[frame.part], options)) {
        frame.send_abort(frame.plan->why_stopped());
        return true;
      }
      if (frame.pause.begun) return false;
    }
    end(frame);
  } catch (const std::exception& e) {  // no memory, above all
    frame.send_abort(failure_text(e));
    stream_.set_faulty(frame.view, frame.generation);
    context_.events.on_live_fault(stream_.radar(), frame.view, memory_failure(e));
  }
  return true;
}

void LiveJob::end(Frame& frame) {
  frame.rendered.render_s = to_seconds(context_.now() - frame.begun);
  frame.send_end(frame.plan->missed());
  // A pose that stays has no latency: its age grows and says nothing.
  const std::int64_t received_ns = frame.view->pose_received_ns;
  if (received_ns > shown_pose_ns_) {
    frame.rendered.pose_to_end_s = 1e-9 * static_cast<double>(in_nanoseconds(context_.now()) - received_ns);
    shown_pose_ns_ = received_ns;
  }
  context_.events.on_live_rendered(stream_.radar(), frame.rendered);
}

}  // namespace obliq::net
