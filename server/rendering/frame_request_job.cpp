#include "server/rendering/frame_request_job.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/output/describe_targets.h"
#include "server/rendering/demand.h"
#include "server/stream/frame_encoder.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq::rendering {
namespace {

/// Frames may wait in the middle of their work until so many threads do, but so many frames may in any case:
/// a thread that waits costs some 100 KB.
constexpr int kParkedThreads = 128;
constexpr int kLeastParked = 4;

/// The part of the frame that was asked for; checked when the request was made.
wire::Window window_of(const FrameRequest& request) {
  const RadarSettings& settings = request.view.settings->settings;
  return wire::cut_window(request.choice.format.window, settings.azimuth_bins, settings.range_bins)
      .value_or(wire::Window{});
}

}  // namespace

struct FrameRequestJob::Frame {
  explicit Frame(FrameRequestPtr of) : request(std::move(of)) {}

  /// Counts the block as waiting before it can be taken.
  void send(RenderEvents& events, const stream::BlockPtr& block) const {
    *request->queued += block->memory();
    events.on_request_block(request, block);
  }

  const FrameRequestPtr request;
  std::unique_ptr<PlannedFrame> plan;  ///< null: it has not begun
  std::optional<stream::FrameEncoder> encoder;
  std::uint64_t sequence = 0;
  std::optional<FrameSum> stats;
  std::optional<Receiver> receiver;
  int next_azimuth = 0;              ///< of the current slice
  int end_azimuth = 0;               ///< of the window
  double render_s = 0;               ///< in the turns before this one
  bool goes_on = false;              ///< after the current work
  std::unique_ptr<ParkedWork> work;  ///< the plan or the current slice; made last, destroyed first
};

FrameRequestJob::FrameRequestJob(const RenderContext& context) : context_(context) {}

FrameRequestJob::~FrameRequestJob() = default;

void FrameRequestJob::enqueue(FrameRequestPtr request) {
  auto frame = std::make_shared<Frame>(std::move(request));
  const std::lock_guard lock(mutex_);
  queue_.push_back(std::move(frame));
}

void FrameRequestJob::stop() {
  const std::lock_guard lock(mutex_);
  for (const auto& frame : queue_) frame->request->stop.request_stop();
}

bool FrameRequestJob::is_empty() const {
  const std::lock_guard lock(mutex_);
  return queue_.empty();
}

void FrameRequestJob::give_up() {
  std::deque<FramePtr> all;
  const std::lock_guard lock(mutex_);
  all.swap(queue_);
}

/// Frames that are being worked on. With the mutex held.
int FrameRequestJob::parked() const {
  return static_cast<int>(
      std::ranges::count_if(queue_, [](const auto& frame) { return frame->work != nullptr; }));
}

/// The current slice may end; another begins where its client has room, and the machine.
bool FrameRequestJob::is_ready(const Frame& frame, int parked) const {
  const RenderThreadOptions& options = context_.options;
  const int most = std::max(kLeastParked, kParkedThreads / thread_count(options.threads));
  return frame.work || (parked < most && frame.request->queued->load() < options.slice_bytes);
}

bool FrameRequestJob::has_ended(const Frame& frame) const {
  return frame.request->stop.stop_requested() || (context_.finishing && !frame.plan && !frame.work);
}

Job::Time FrameRequestJob::date(Time now) {
  std::vector<FramePtr> ended;  // their threads end without the lock
  const std::lock_guard lock(mutex_);
  for (const auto& frame : queue_)
    if (has_ended(*frame)) ended.push_back(frame);
  std::erase_if(queue_, [this](const auto& frame) { return has_ended(*frame); });
  const int now_parked = parked();
  const bool ready = std::ranges::any_of(
      first_of_clients(), [&](const auto& first) { return is_ready(*first.second, now_parked); });
  return ready ? now : Time::max();
}

/// By client, its oldest request. With the mutex held.
std::map<std::uint64_t, FrameRequestJob::FramePtr> FrameRequestJob::first_of_clients() const {
  std::map<std::uint64_t, FramePtr> first;
  for (const auto& frame : queue_) first.emplace(frame->request->client_id, frame);
  return first;
}

FrameRequestJob::FramePtr FrameRequestJob::next_ready() {
  const std::lock_guard lock(mutex_);
  const auto first = first_of_clients();
  const int now_parked = parked();
  // The next client after the one before, round and round.
  auto next = first.upper_bound(last_client_);
  for (std::size_t looks = 0; looks < first.size(); ++looks, ++next) {
    if (next == first.end()) next = first.begin();
    if (!is_ready(*next->second, now_parked)) continue;
    last_client_ = next->first;
    return next->second;
  }
  return nullptr;
}

bool FrameRequestJob::work() {
  const FramePtr frame = next_ready();
  if (!frame || work_on(*frame)) return true;
  const std::lock_guard lock(mutex_);
  std::erase(queue_, frame);
  return true;
}

bool FrameRequestJob::work_on(Frame& frame) const {
  const RenderThreadOptions& options = context_.options;
  try {
    if (!frame.work) {
      frame.goes_on = false;
      const auto work = [this, &frame] { frame.goes_on = frame.plan ? render_slice(frame) : begin(frame); };
      frame.work = std::make_unique<ParkedWork>(work, frame.request->stop.get_token(), options.look);
    }
    const bool ended = context_.turn(
        *frame.work, {}, context_.scanning ? options.once_work_while_scanning : options.once_work);
    frame.render_s += to_seconds(context_.now() - context_.turn_began);
    if (!ended) return true;
  } catch (const std::exception& e) {
    if (frame.encoder) {
      frame.send(context_.events, frame.encoder->abort(failure_text(e)));
    } else {
      context_.events.on_request_fault(frame.request, memory_failure(e));
    }
  }
  frame.work = nullptr;
  return frame.goes_on;
}

bool FrameRequestJob::begin(Frame& frame) const {
  const FrameRequest& request = *frame.request;
  auto plan = context_.renderer.plan(request.view.settings, request.view.pose);
  if (!plan.frame && plan.errors.empty()) return true;  // nothing yet
  if (!plan.frame) {
    context_.events.on_request_fault(frame.request, plan.errors);
    return false;
  }
  frame.plan = std::move(plan.frame);
  wire::FrameDescriptor descriptor;
  frame.plan->describe(request.radar, descriptor);
  const RadarSettings& settings = request.view.settings->settings;
  frame.receiver.emplace(settings, request.radar, settings.receiver.noise_frame, frame.plan->air());
  describe_receiver(*frame.receiver, descriptor);
  describe_targets(request.targets, descriptor);
  stream::FrameIdentity identity;
  identity.stream_id = request.stream_id;
  identity.request_id = request.request_id;
  identity.choices = {request.choice};
  identity.pose_received_ns = request.view.pose_received_ns;
  frame.stats.emplace(request.view.settings->settings);
  frame.encoder.emplace(identity, frame.sequence);
  for (const stream::BlockPtr& block : frame.encoder->begin(descriptor)) frame.send(context_.events, block);
  const auto window = window_of(request);
  frame.next_azimuth = static_cast<int>(window.azimuth.first) / kWedgeAzimuthBins * kWedgeAzimuthBins;
  frame.end_azimuth = static_cast<int>(window.azimuth.end());
  return true;
}

bool FrameRequestJob::render_slice(Frame& frame) const {
  const FrameRequest& request = *frame.request;
  const std::size_t wedge_bytes = std::size_t{wire::bytes_per_bin(wire::kAllPlanes)} * kWedgeAzimuthBins *
                                  static_cast<std::size_t>(request.view.settings->settings.range_bins);
  const int wedges =
      static_cast<int>(std::clamp<std::size_t>(context_.options.slice_bytes / wedge_bytes, 1, 1u << 16));
  int count = std::min(wedges * kWedgeAzimuthBins, frame.end_azimuth - frame.next_azimuth);
  const bool has_bins = (request.choice.planes & wire::kBinPlanes) != 0;
  if (!has_bins) count = frame.end_azimuth - frame.next_azimuth;

  const auto wants = [&](wire::Plane plane) { return (request.choice.planes & wire::plane_bit(plane)) != 0; };
  const ReceivedPlanes needed = needed_planes(request.choice, request.view.settings->settings);
  RenderOptions options =
      context_.render_options(needed.iq, wants(wire::Plane::state), request.stop.get_token());
  options.video8 = needed.video8;
  options.video16 = needed.video16;
  options.labels = (request.choice.planes & wire::kLabelPlanes) != 0;
  options.target_ids = (request.choice.planes & wire::kTargetPlane) != 0;
  options.receiver = &*frame.receiver;
  options.draw = frame_draw(request.radar, frame.receiver->counter());
  options.targets = request.targets.get();
  options.targets_at = request.view.targets_at;
  options.on_wedge = [&](Wedge&& wedge) {
    frame.stats->add(wedge);
    for (const stream::BlockPtr& block : frame.encoder->wedge(wedge.index, wedge.bins))
      frame.send(context_.events, block);
  };
  const auto stopped = [&] {
    frame.send(context_.events, frame.encoder->abort("the server has stopped rendering this frame"));
    return false;
  };
  if (has_bins && !frame.plan->render({frame.next_azimuth, count}, options)) return stopped();
  frame.next_azimuth += count;
  if (frame.next_azimuth < frame.end_azimuth) return true;
  const RadarSettings& settings = request.view.settings->settings;
  if (wants_pulses(request.choice, settings)) {
    const auto made = frame.plan->render_train(train_of_frame(settings), options);
    if (!made) return stopped();
    if (!has_bins) frame.stats->add({0, {}, made->stats});
    for (const stream::BlockPtr& block : frame.encoder->train(made->train))
      frame.send(context_.events, block);
  }
  if (request.choice.truth) {
    const AzimuthRange all{0, request.view.settings->settings.azimuth_bins};
    const auto records = frame.plan->truth(all, options, frame.receiver->noise_power_w());
    frame.send(context_.events, frame.encoder->targets(all, records));
  }
  wire::FrameSummary summary;
  frame.plan->summarise(frame.stats->total(), summary);
  // Counted before the client has it.
  const double render_s = frame.render_s + to_seconds(context_.now() - context_.turn_began);
  context_.events.on_request_rendered({render_s, summary.rays(), summary.hits()});
  frame.send(context_.events, frame.encoder->end(summary, render_s));
  return false;
}

}  // namespace obliq::rendering
