// Frames of live radars, whole ones.
#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/net/frame_encoder.h"
#include "server/net/once_task.h"

namespace obliq::net {
namespace {

using Seconds = std::chrono::duration<double>;

}  // namespace

wire::FrameSummary RenderThread::summary_of(const PlannedFrame& frame, const FrameSum& stats,
                                            std::uint64_t frame_id, RenderedFrame& rendered) {
  wire::FrameSummary summary;
  frame.summarise(stats.total(), summary);
  summary.set_frame_id(frame_id);
  rendered.rays = summary.rays();
  rendered.hits = summary.hits();
  rendered.coverage = summary.coverage();
  return summary;
}

void RenderThread::render_live(std::size_t index, std::unique_lock<std::mutex>& lock) {
  LiveTask& task = live_[index];
  const auto now = clock_now();
  // Never catch up: a frame that could not be rendered in time is not rendered later.
  task.due = std::max(task.due + period_of(task.rate_hz), now);
  const auto view = std::make_shared<const LiveView>(task.view->at(clock_ns()));
  const std::uint64_t generation = renderer_.generation();
  const std::vector<Demand> due = take_due(task.demands, now);
  if (due.empty()) return;
  task.stop = std::stop_source();
  const std::stop_token stop = task.stop.get_token();
  const std::uint64_t frame_id = ++task.last_frame;
  lock.unlock();

  LiveFramePtr frame;
  const auto send = [&](std::vector<BlockPtr> blocks) {
    events_.on_live_blocks(index, frame, std::move(blocks));
  };
  std::vector<FieldError> errors;
  std::optional<FrameEncoder> encoder;
  bool begun = false;
  bool nothing_new = false;
  try {
    auto plan = renderer_.plan(view->settings, view->pose);
    errors = std::move(plan.errors);
    nothing_new = !plan.frame && errors.empty();
    if (plan.frame) {
      wire::FrameDescriptor descriptor;
      plan.frame->describe(task.name, descriptor);
      descriptor.set_frame_id(frame_id);
      descriptor.set_pose_stale(view->pose_stale);
      const SettingsPtr made_with = plan.settings ? plan.settings : view->settings;
      const Order order = order_of(due, made_with->settings);
      frame = task.frames->open(frame_id, order.takers);
      encoder.emplace(identity_of(task, frame_id, order, *view), task.sequence);  // this thread's alone
      FrameSum stats(made_with->settings);
      RenderOptions options;
      options.threads = options_.threads;
      options.states = order.states;
      options.before_wedge = options_.before_wedge;
      options.stop = stop;
      RenderedFrame rendered;
      options.on_wedge = [&](Wedge&& wedge) {
        if (rendered.first_wedge_s == 0) rendered.first_wedge_s = Seconds(clock_now() - now).count();
        stats.add(wedge);
        send(encoder->wedge(wedge.index, wedge.bins));
      };
      begun = true;
      send(encoder->begin(descriptor));
      const bool finished =
          std::all_of(order.azimuths.begin(), order.azimuths.end(),
                      [&](const AzimuthRange& azimuths) { return plan.frame->render(azimuths, options); });
      if (finished) {
        const wire::FrameSummary summary = summary_of(*plan.frame, stats, frame_id, rendered);
        rendered.render_s = Seconds(clock_now() - now).count();
        send({encoder->end(summary, rendered.render_s)});
        // A pose that stays has no latency: its age grows and says nothing.
        if (view->pose_received_ns > task.shown_pose_ns) {
          rendered.pose_to_end_s = 1e-9 * static_cast<double>(clock_ns() - view->pose_received_ns);
          task.shown_pose_ns = view->pose_received_ns;  // this thread alone uses it
        }
        events_.on_live_rendered(index, rendered);
      } else {
        send({encoder->abort("the server has stopped rendering this frame")});
      }
    }
  } catch (const std::exception& e) {  // no memory, above all
    errors = memory_failure(e);
    if (begun) send({encoder->abort(words_of(e))});
  }
  if (!errors.empty()) events_.on_live_fault(index, view, errors);
  frame.reset();  // its going is heard of under the lock
  lock.lock();
  task.faulty = errors.empty() ? nullptr : view;
  task.faulty_generation = generation;
  if (nothing_new) {
    task.due = clock_now();
    give_back(due, task.demands);
  }
}

}  // namespace obliq::net
