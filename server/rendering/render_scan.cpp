// A scanning antenna: each dwell is rendered, with the pose of its moment, when the beam is there. A pass
// over the sector is one frame of the stream.
#include <algorithm>
#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/rendering/once_task.h"
#include "server/rendering/scan_task.h"

namespace obliq::net {
namespace {

using Seconds = std::chrono::duration<double>;

std::int64_t nanoseconds(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

void add_span(std::vector<AzimuthRange>& spans, const AzimuthRange& more) {
  if (!spans.empty() && spans.back().first + spans.back().count == more.first) {
    spans.back().count += more.count;
  } else if (!spans.empty() && more.first + more.count == spans.back().first) {
    spans.back() = {more.first, more.count + spans.back().count};
  } else {
    spans.push_back(more);
  }
}

int wedges_of(const AzimuthRange& azimuths) {
  return (azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins;
}

}  // namespace

std::int64_t RenderThread::clock_ns() const { return nanoseconds(clock_now()); }

bool RenderThread::still_faulty(const LiveTask& task) const {
  if (!task.faulty || task.faulty_generation != renderer_.generation()) return false;
  const LiveView view = task.view->at(clock_ns());
  return view.settings == task.faulty->settings && view.pose == task.faulty->pose;
}

bool RenderThread::wants_scan(const LiveTask& task) const {
  // A renderer that only repeats has its own times.
  return renderer_.fixed().empty() && task.rate_hz > 0 &&
         task.view->settings->settings.scan_mode != ScanMode::frame;
}

RenderThread::Clock::time_point RenderThread::scan_date(std::size_t index, Clock::time_point now) {
  const LiveTask& task = live_[index];
  const auto& scan = task.scan;
  if (scan && scan->settings == task.view->settings) {
    const auto due = scan->schedule.middle(scan->next);
    if (due > now) return due;
    if (scan->pass) return now;
  }
  return is_held_up(index, now) ? task.next_reminder : now;
}

void RenderThread::end_scan(std::size_t index, const std::string& reason) {
  LiveTask& task = live_[index];
  if (task.scan && task.scan->pass) {
    ScanPass& pass = *task.scan->pass;
    events_.on_live_blocks(index, pass.frame, {pass.encoder.abort(reason)});
  }
  task.scan = nullptr;
}

void RenderThread::render_dwell(std::size_t index, std::unique_lock<std::mutex>& lock) {
  LiveTask& task = live_[index];
  const auto now = clock_now();
  const auto kept_view = task.view;
  const std::vector<Demand> demands = task.demands;
  task.stop = std::stop_source();
  const std::stop_token stop = task.stop.get_token();
  const std::uint64_t generation = renderer_.generation();
  lock.unlock();

  if (task.scan && task.scan->settings != kept_view->settings)
    end_scan(index, "the radar's settings changed");
  if (!task.scan) task.scan = std::make_shared<ScanTask>(kept_view->settings, now);
  ScanTask& scan = *task.scan;
  auto view = std::make_shared<const LiveView>(kept_view->at(nanoseconds(now)));
  std::vector<FieldError> errors;
  try {
    leave_out(index, scan.schedule.next(scan.next, now));
    const auto middle = scan.schedule.middle(scan.next);
    if (middle <= now) {
      view = std::make_shared<const LiveView>(kept_view->at(nanoseconds(middle)));
      errors = scan.pass ? plan_dwell(scan, *view) : begin_pass(index, *view, demands);
      if (!errors.empty() || !scan.pass) {
        if (errors.empty()) advance(index);  // nobody wants any bin of it
      } else if (render_azimuths(index, scan.schedule.azimuths(scan.next), *view, stop)) {
        advance(index);
      } else {
        end_scan(index, "the server has stopped rendering this pass");
      }
    }
  } catch (const std::exception& e) {  // no memory, above all
    errors = memory_failure(e);
  }
  if (!errors.empty()) {
    end_scan(index, errors.front().text());
    events_.on_live_fault(index, view, errors);
  }
  lock.lock();
  task.faulty = errors.empty() ? nullptr : view;
  task.faulty_generation = generation;
}

// To the next dwell; at the edge the pass ends.
void RenderThread::advance(std::size_t index) {
  ScanTask& scan = *live_[index].scan;
  scan.next = scan.schedule.after(scan.next);
  if (scan.next.number == 0 && scan.pass) end_pass(index);
}

// The dwells before this one, which the beam has left: missed in the pass that has begun, and in the one that
// will begin with `dwell`; whole passes between were skipped.
void RenderThread::leave_out(std::size_t index, const Dwell& dwell) {
  LiveTask& task = live_[index];
  ScanTask& scan = *task.scan;
  while (scan.pass && scan.next < dwell) {
    miss(scan, scan.next);
    advance(index);
  }
  if (!(scan.next < dwell)) return;
  const std::uint64_t passes = dwell.pass - scan.next.pass;
  task.skipped += passes;
  task.skipped_in_all += passes;
  scan.next = dwell;
}

void RenderThread::miss(ScanTask& scan, const Dwell& dwell) {
  const AzimuthRange azimuths = scan.schedule.azimuths(dwell);
  ScanPass& pass = *scan.pass;
  const auto first = pass.wanted.begin() + azimuths.first / kWedgeAzimuthBins;
  if (std::find(first, first + wedges_of(azimuths), true) == first + wedges_of(azimuths)) return;
  add_span(pass.missed, azimuths);
  ++pass.rendered.dwells_missed;
}

// All watchers get every pass, whatever rate they asked for.
std::vector<FieldError> RenderThread::begin_pass(std::size_t index, const LiveView& view,
                                                 const std::vector<Demand>& demands) {
  LiveTask& task = live_[index];
  ScanTask& scan = *task.scan;
  const RadarSettings& settings = scan.settings->settings;
  const Order order = order_of(demands, settings);
  if (order.takers.empty()) return {};
  auto plan = renderer_.plan(scan.settings, view.pose);
  if (!plan.frame) return plan.errors;

  FrameIdentity identity = identity_of(task, ++task.last_frame, order, view);
  scan.pass = std::make_unique<ScanPass>(std::move(identity), task.sequence, settings);
  ScanPass& pass = *scan.pass;
  pass.frame = task.frames->open(pass.frame_id, order.takers);
  pass.states = order.states;
  pass.wanted.assign(static_cast<std::size_t>(wedge_count(settings.azimuth_bins)), false);
  for (const AzimuthRange& part : order.azimuths)
    std::fill_n(pass.wanted.begin() + part.first / kWedgeAzimuthBins, wedges_of(part), true);
  pass.plan = std::move(plan.frame);
  pass.planned_pose = view.pose;

  wire::FrameDescriptor descriptor;
  pass.plan->describe(task.name, descriptor);
  descriptor.set_frame_id(pass.frame_id);
  descriptor.set_pose_stale(view.pose_stale);
  wire::ScanPass about;
  about.set_mode(settings.scan_mode == ScanMode::circular ? wire::CIRCULAR_SCAN : wire::SECTOR_SCAN);
  about.set_clockwise(scan.schedule.is_clockwise(scan.next.pass));
  about.set_rate_deg_s(settings.scan_rate_deg_s);
  about.set_dwell_bins(static_cast<std::uint32_t>(settings.scan_dwell_bins));
  about.set_begin_ns(nanoseconds(scan.schedule.pass_begin(scan.next.pass)));
  pass.encoder.set_scan(about);
  events_.on_live_blocks(index, pass.frame, pass.encoder.begin(descriptor));
  for (Dwell before{scan.next.pass, 0}; before < scan.next; ++before.number) miss(scan, before);
  return {};
}

std::vector<FieldError> RenderThread::plan_dwell(ScanTask& scan, const LiveView& view) {
  ScanPass& pass = *scan.pass;
  if (same_antenna(view.pose, pass.planned_pose)) return {};
  auto plan = renderer_.plan_again(*pass.plan, scan.settings, view.pose);
  if (!plan.frame) return plan.errors;
  pass.plan = std::move(plan.frame);
  pass.planned_pose = view.pose;
  return {};
}

bool RenderThread::render_azimuths(std::size_t index, const AzimuthRange& azimuths, const LiveView& view,
                                   const std::stop_token& stop) {
  ScanTask& scan = *live_[index].scan;
  ScanPass& pass = *scan.pass;
  const auto start = Clock::now();
  wire::Pose pose;
  write_message(view.pose, pose);
  pass.encoder.set_dwell(pose, view.pose_received_ns, view.pose_stale,
                         nanoseconds(scan.schedule.middle(scan.next)));
  // Wedges of one dwell are finished in any order; a display is given them in the beam's.
  std::vector<Wedge> wedges;
  RenderOptions options;
  options.threads = options_.threads;
  options.states = pass.states;
  options.before_wedge = options_.before_wedge;
  options.stop = stop;
  options.on_wedge = [&](Wedge&& wedge) { wedges.push_back(std::move(wedge)); };
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = first + wedges_of(azimuths);
  for (int from = first; from < end;) {
    if (!pass.wanted[static_cast<std::size_t>(from)]) {
      ++from;
      continue;
    }
    int to = from;
    while (to < end && pass.wanted[static_cast<std::size_t>(to)]) ++to;
    const int begin_bin = from * kWedgeAzimuthBins;
    const int end_bin = std::min(to * kWedgeAzimuthBins, azimuths.first + azimuths.count);
    if (!pass.plan->render({begin_bin, end_bin - begin_bin}, options)) return false;
    from = to;
  }
  const bool clockwise = scan.schedule.is_clockwise(scan.next.pass);
  std::ranges::sort(wedges, [&](const Wedge& a, const Wedge& b) {
    return clockwise ? a.index < b.index : a.index > b.index;
  });
  for (const Wedge& wedge : wedges) {
    pass.stats.add(wedge);
    events_.on_live_blocks(index, pass.frame, pass.encoder.wedge(wedge.index, wedge.bins));
  }
  const double render_s = Seconds(Clock::now() - start).count();
  if (pass.rendered.first_wedge_s == 0) pass.rendered.first_wedge_s = render_s;
  pass.rendered.render_s += render_s;
  return true;
}

void RenderThread::end_pass(std::size_t index) {
  ScanTask& scan = *live_[index].scan;
  ScanPass& pass = *scan.pass;
  const wire::FrameSummary summary = summary_of(*pass.plan, pass.stats, pass.frame_id, pass.rendered);
  events_.on_live_blocks(index, pass.frame, {pass.encoder.end(summary, pass.rendered.render_s, pass.missed)});
  events_.on_live_rendered(index, pass.rendered);
  scan.pass = nullptr;
}

}  // namespace obliq::net
