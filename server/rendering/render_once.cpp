// RenderOnce requests, slice by slice.
#include <algorithm>
#include <exception>
#include <new>

#include "proto/obliq.pb.h"
#include "server/rendering/once_task.h"
#include "terrain/base/failure_text.h"

namespace obliq::net {
namespace {

using Seconds = std::chrono::duration<double>;

/// The part of a job's frame that was asked for; checked when the job was made.
wire::Window window_of(const OnceJob& job) {
  const RadarSettings& settings = job.view.settings->settings;
  return wire::cut_window(job.choice.format.window, static_cast<std::uint32_t>(settings.azimuth_bins),
                          static_cast<std::uint32_t>(settings.range_bins))
      .value_or(wire::Window{});
}

}  // namespace

std::string words_of(const std::exception& failure) { return failure_text(failure); }

std::vector<FieldError> memory_failure(const std::exception& failure) {
  return {{"frame", words_of(failure), "a frame that can be rendered with the memory there is"}};
}

void RenderThread::render_once(std::size_t index, std::unique_lock<std::mutex>& lock) {
  const std::shared_ptr<OnceTask> task = once_[index];
  lock.unlock();
  bool more = false;
  try {
    more = task->frame || begin_once(*task);
    if (more && task->frame) more = continue_once(*task);
  } catch (const std::exception& e) {
    if (task->encoder) {
      task->send(events_, task->encoder->abort(words_of(e)));
    } else {
      events_.on_once_fault(task->job, memory_failure(e));
    }
  }
  lock.lock();
  if (!more) std::erase(once_, task);
}

bool RenderThread::begin_once(OnceTask& task) {
  const OnceJob& job = *task.job;
  auto plan = renderer_.plan(job.view.settings, job.view.pose);
  if (!plan.frame && plan.errors.empty()) return true;  // nothing yet
  if (!plan.frame) {
    events_.on_once_fault(task.job, plan.errors);
    return false;
  }
  task.frame = std::move(plan.frame);
  wire::FrameDescriptor descriptor;
  task.frame->describe(job.radar, descriptor);
  FrameIdentity identity;
  identity.stream_id = job.stream_id;
  identity.request_id = job.request_id;
  identity.choices = {job.choice};
  identity.pose_received_ns = job.view.pose_received_ns;
  task.stats.emplace(job.view.settings->settings);
  task.encoder.emplace(identity, task.sequence);
  for (const BlockPtr& block : task.encoder->begin(descriptor)) task.send(events_, block);
  const auto window = window_of(job);
  task.next_azimuth = static_cast<int>(window.azimuth.first) / kWedgeAzimuthBins * kWedgeAzimuthBins;
  task.end_azimuth = static_cast<int>(window.azimuth.end());
  return true;
}

bool RenderThread::continue_once(OnceTask& task) {
  const RadarSettings& settings = task.job->view.settings->settings;
  const std::size_t wedge_bytes = std::size_t{wire::bytes_per_bin(wire::kAllPlanes)} * kWedgeAzimuthBins *
                                  static_cast<std::size_t>(settings.range_bins);
  const int wedges =
      static_cast<int>(std::clamp<std::size_t>(options_.slice_bytes / wedge_bytes, 1, 1u << 16));
  const int count = std::min(wedges * kWedgeAzimuthBins, task.end_azimuth - task.next_azimuth);
  task.pause.batches = scanning_ ? options_.slice_batches_while_scanning : options_.slice_batches;

  RenderOptions options;
  options.threads = options_.threads;
  options.states = (task.job->choice.planes & wire::plane_bit(wire::Plane::state)) != 0;
  options.before_wedge = options_.before_wedge;
  options.stop = task.job->stop.get_token();
  options.pause = &task.pause;
  task.pause.is_due = [this] { return gives_way(); };
  options.on_wedge = [&](Wedge&& wedge) {
    task.stats->add(wedge);
    for (const BlockPtr& block : task.encoder->wedge(wedge.index, wedge.bins)) {
      task.send(events_, block);
    }
  };
  const auto start = clock_now();
  if (!task.frame->render({task.next_azimuth, count}, options)) {
    task.send(events_, task.encoder->abort("the server has stopped rendering this frame"));
    return false;
  }
  task.render_s += Seconds(clock_now() - start).count();
  if (task.pause.begun) return true;
  task.next_azimuth += count;
  if (task.next_azimuth < task.end_azimuth) return true;
  wire::FrameSummary summary;
  task.frame->summarise(task.stats->total(), summary);
  events_.on_once_rendered({task.render_s, summary.rays(), summary.hits()});  // counted before anyone has it
  task.send(events_, task.encoder->end(summary, task.render_s));
  return false;
}

}  // namespace obliq::net
