// Frames of live radars, whole ones.
#include <algorithm>
#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/rendering/live_task.h"
#include "server/rendering/once_task.h"

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

/// The radar's turn: its frame begins or goes on. True when one is over.
bool RenderThread::render_live(std::size_t index, std::unique_lock<std::mutex>& lock) {
  LiveTask& task = live_[index];
  if (!task.hand && !begin_live(index, lock)) return false;
  lock.unlock();
  const bool over = continue_live(index);
  const std::shared_ptr<FrameInHand> hand = over ? std::exchange(task.hand, nullptr) : task.hand;
  if (over) hand->frame = nullptr;  // its going is heard of under the lock
  lock.lock();
  if (hand->failed) {
    task.faulty = hand->view;
    task.faulty_generation = hand->generation;
  }
  return over;
}

/// Plans the newest frame that is due and sends its begin; false when there is none after all.
bool RenderThread::begin_live(std::size_t index, std::unique_lock<std::mutex>& lock) {
  LiveTask& task = live_[index];
  const auto now = clock_now();
  const FrameDates::Taken date = task.dates.take(now, period_of(task.rate_hz), none_is_shed(task));
  const auto view = std::make_shared<const LiveView>(task.view->at(clock_ns()));
  const std::uint64_t generation = renderer_.generation();
  const std::vector<Demand> due = take_due(task.demands, now);
  if (due.empty()) return false;
  task.shed += date.shed;
  task.stop = std::stop_source();
  const std::stop_token stop = task.stop.get_token();
  const std::uint64_t frame_id = ++task.last_frame;
  lock.unlock();

  std::vector<FieldError> errors;
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
      Order order = order_of(due, made_with->settings);
      FrameIdentity identity = identity_of(task, frame_id, order, *view);
      identity.waited_s = Seconds(date.late).count();
      auto hand = std::make_shared<FrameInHand>(std::move(identity), task.sequence, made_with->settings);
      hand->frame = task.frames->open(frame_id, order.takers);
      hand->states = order.states;
      hand->azimuths = std::move(order.azimuths);
      hand->plan = std::move(plan.frame);
      hand->begun = now;
      hand->rendered.waited_s = Seconds(date.late).count();
      hand->view = view;
      hand->generation = generation;
      hand->stop = stop;
      events_.on_live_blocks(index, hand->frame, hand->encoder.begin(descriptor));
      task.hand = std::move(hand);  // this thread's alone
    }
  } catch (const std::exception& e) {  // no memory, above all
    errors = memory_failure(e);
  }
  if (!errors.empty()) events_.on_live_fault(index, view, errors);
  lock.lock();
  task.faulty = errors.empty() ? nullptr : view;
  task.faulty_generation = generation;
  if (nothing_new) {
    --task.last_frame;
    task.dates.begin_at(clock_now());
    give_back(due, task.demands);
  }
  return task.hand != nullptr;
}

/// Renders until the frame is done or gives way; true when it is over.
bool RenderThread::continue_live(std::size_t index) {
  LiveTask& task = live_[index];
  FrameInHand& hand = *task.hand;
  const auto send = [&](std::vector<BlockPtr> blocks) {
    events_.on_live_blocks(index, hand.frame, std::move(blocks));
  };
  try {
    RenderOptions options;
    options.threads = options_.threads;
    options.states = hand.states;
    options.before_wedge = options_.before_wedge;
    options.stop = hand.stop;
    options.pause = &hand.pause;
    hand.pause.is_due = [this] { return gives_way(); };
    options.on_wedge = [&](Wedge&& wedge) {
      if (hand.rendered.first_wedge_s == 0)
        hand.rendered.first_wedge_s = Seconds(clock_now() - hand.begun).count();
      hand.stats.add(wedge);
      send(hand.encoder.wedge(wedge.index, wedge.bins));
    };
    for (; hand.part < hand.azimuths.size(); ++hand.part) {
      if (!hand.plan->render(hand.azimuths[hand.part], options)) {
        send({hand.encoder.abort("the server has stopped rendering this frame")});
        return true;
      }
      if (hand.pause.begun) return false;
    }
    const wire::FrameSummary summary = summary_of(*hand.plan, hand.stats, hand.frame_id, hand.rendered);
    hand.rendered.render_s = Seconds(clock_now() - hand.begun).count();
    send({hand.encoder.end(summary, hand.rendered.render_s)});
    // A pose that stays has no latency: its age grows and says nothing.
    if (hand.view->pose_received_ns > task.shown_pose_ns) {
      hand.rendered.pose_to_end_s = 1e-9 * static_cast<double>(clock_ns() - hand.view->pose_received_ns);
      task.shown_pose_ns = hand.view->pose_received_ns;  // this thread alone uses it
    }
    events_.on_live_rendered(index, hand.rendered);
  } catch (const std::exception& e) {  // no memory, above all
    send({hand.encoder.abort(words_of(e))});
    events_.on_live_fault(index, hand.view, memory_failure(e));
    hand.failed = true;
  }
  return true;
}

}  // namespace obliq::net
