#include "server/rendering/scan_job.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/radar/beam/echo_rows.h"
#include "server/rendering/scan_schedule.h"
#include "terrain/base/units.h"

namespace obliq::rendering {
namespace {

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

struct ScanJob::Pass : BegunFrame {
  using BegunFrame::BegunFrame;

  std::vector<bool> wanted;  ///< [wedges] that some client asked for
  PoseSettings planned_pose;
  std::vector<AzimuthRange> missed;
};

struct ScanJob::Scan {
  Scan(SettingsPtr of, Time begin) : settings(std::move(of)), schedule(settings->settings, begin) {}

  SettingsPtr settings;
  ScanSchedule schedule;
  Dwell next;  ///< in order
  /// Behind a beam: what neighbouring dwells look at both, and the antenna and scene that it is of.
  SharpStore sharp;
  PoseSettings sharp_pose;
  std::uint64_t generation = 0;
  bool moved = false;  ///< within a pass

  /// The pose of a pass: each has an elevation of its own, where bars are asked for.
  std::shared_ptr<const LiveView> at_bar(const LiveView& view) const;
  std::unique_ptr<Pass> pass;
};

std::shared_ptr<const LiveView> ScanJob::Scan::at_bar(const LiveView& view) const {
  auto barred = std::make_shared<LiveView>(view);
  const std::vector<double>& bars = settings->settings.scan_bars_deg;
  if (!bars.empty()) {
    barred->pose.tilt_deg = bars[next.pass % bars.size()];
    barred->pose.tilt_auto = false;
    barred->hold();
  }
  return barred;
}

ScanJob::ScanJob(const RenderContext& context, LiveStream& stream) : context_(context), stream_(stream) {}

ScanJob::~ScanJob() = default;

Job::Time ScanJob::date(Time now) {
  if (work_) return now;
  if (const auto rest = stream_.rests_until(now)) return *rest;
  stream_.put_off(now);
  if (const auto pause = stream_.take_pause(); scan_ && pause > Time::duration{})
    scan_->schedule.delay(pause);
  if (scan_ && scan_->settings == stream_.view()->settings) {
    const auto due = scan_->schedule.middle(scan_->next);
    if (due > now) return due;
    if (scan_->pass) return now;
  }
  return stream_.free_at(now);
}

void ScanJob::end(const std::string& reason) {
  work_ = nullptr;
  if (scan_ && scan_->pass) scan_->pass->send_abort(reason);
  scan_ = nullptr;
}

bool ScanJob::work() {
  if (!work_) {
    auto start = stream_.begin_dwell();
    if (!start) return true;
    start_ = std::move(*start);
    view_ = start_.view;
    generation_ = context_.renderer.generation();
    errors_.clear();
    stopped_ = false;
    if (scan_ && scan_->settings != start_.view->settings) end("the radar's settings changed");
    work_ = std::make_unique<ParkedWork>([this, now = context_.now()] { dwell(now); }, start_.stop,
                                         context_.options.look);
  }
  try {
    if (!context_.turn(*work_, kShortestDwell)) return false;
  } catch (const std::exception& e) {  // no memory, above all
    errors_ = memory_failure(e);
  }
  work_ = nullptr;
  if (stopped_) end("the server has stopped rendering this pass");
  if (!errors_.empty()) {
    end(errors_.front().text());
    context_.events.on_live_fault(stream_.radar(), view_, errors_);
  }
  stream_.set_faulty(errors_.empty() ? nullptr : view_, generation_);
  return true;
}

void ScanJob::dwell(Time now) {
  if (!scan_) scan_ = std::make_unique<Scan>(start_.view->settings, now);
  view_ = std::make_shared<const LiveView>(start_.view->at(in_nanoseconds(now)));
  leave_out(scan_->schedule.next(scan_->next, now));
  const Time middle = scan_->schedule.middle(scan_->next);
  if (middle > now) return;
  view_ = scan_->at_bar(start_.view->at(in_nanoseconds(middle)));
  errors_ = scan_->pass ? plan_dwell(*view_) : begin_pass(*view_, start_.demands);
  if (errors_.empty()) render_dwell(*view_, start_.stop);
}

void ScanJob::render_dwell(const LiveView& view, const std::stop_token& stop) {
  // Without a pass no client wants any bin of it.
  stopped_ = scan_->pass && !render_azimuths(view, stop);
  if (!stopped_) advance();
}

void ScanJob::advance() {
  scan_->next = scan_->schedule.after(scan_->next);
  if (scan_->next.number == 0 && scan_->pass) end_pass();
}

void ScanJob::leave_out(const Dwell& dwell) {
  while (scan_->pass && scan_->next < dwell) {
    miss(scan_->next);
    advance();
  }
  if (!(scan_->next < dwell)) return;
  stream_.skip(dwell.pass - scan_->next.pass);
  scan_->next = dwell;
}

bool ScanJob::is_wanted(const AzimuthRange& azimuths) const {
  const auto first = scan_->pass->wanted.begin() + azimuths.first / kWedgeAzimuthBins;
  const auto end = first + wedges_of(azimuths);
  return std::find(first, end, true) != end;
}

void ScanJob::miss(const Dwell& dwell) {
  const AzimuthRange azimuths = scan_->schedule.azimuths(dwell);
  Pass& pass = *scan_->pass;
  if (!is_wanted(azimuths)) return;
  add_span(pass.missed, azimuths);
  ++pass.rendered.dwells_missed;
}

std::vector<FieldError> ScanJob::begin_pass(const LiveView& view, const std::vector<Demand>& demands) {
  const RadarSettings& settings = scan_->settings->settings;
  const Order order = order_of(demands, settings);
  if (order.takers.empty()) return {};
  auto plan = context_.renderer.plan(scan_->settings, view.pose);
  if (!plan.frame) return plan.errors;

  // Sharp wedges of the pass before are those of this one while nothing has moved.
  const std::uint64_t generation = context_.renderer.generation();
  if (std::exchange(scan_->moved, false) || !same_antenna(settings, view.pose, scan_->sharp_pose) ||
      generation != scan_->generation)
    scan_->sharp.clear();
  scan_->sharp_pose = view.pose;
  scan_->generation = generation;

  scan_->pass = std::make_unique<Pass>(stream_, stream_.next_frame_id(), std::move(plan.frame), settings,
                                       order, view, 0);
  Pass& pass = *scan_->pass;
  pass.wanted.assign(static_cast<std::size_t>(wedge_count(settings.azimuth_bins)), false);
  for (const AzimuthRange& part : order.azimuths)
    std::fill_n(pass.wanted.begin() + part.first / kWedgeAzimuthBins, wedges_of(part), true);
  pass.planned_pose = view.pose;

  wire::ScanPass about;
  about.set_mode(settings.scan_mode == ScanMode::circular ? wire::CIRCULAR_SCAN : wire::SECTOR_SCAN);
  about.set_clockwise(scan_->schedule.is_clockwise(scan_->next.pass));
  about.set_rate_deg_s(settings.scan_rate_deg_s);
  about.set_dwell_bins(static_cast<std::uint32_t>(settings.scan_dwell_bins));
  about.set_begin_ns(in_nanoseconds(scan_->schedule.pass_begin(scan_->next.pass)));
  pass.encoder.set_scan(about);
  pass.send_begin(view);
  for (Dwell before{scan_->next.pass, 0}; before < scan_->next; ++before.number) miss(before);
  return {};
}

std::vector<FieldError> ScanJob::plan_dwell(const LiveView& view) {
  Pass& pass = *scan_->pass;
  const RadarSettings& settings = scan_->settings->settings;
  if (same_antenna(settings, view.pose, pass.planned_pose)) return {};
  // An antenna that rolls sees in each sharp bin what it saw in another.
  // Rows that pulses add up have the phases of where they were looked at from.
  if (!settings.beam.stabilised || (pass.pulses && resolved_speckle(settings) != SpeckleKind::independent))
    scan_->sharp.clear();
  auto plan = context_.renderer.plan_again(*pass.plan, scan_->settings, view.pose);
  if (!plan.frame) return plan.errors;
  pass.plan = std::move(plan.frame);
  pass.planned_pose = view.pose;
  scan_->moved = true;
  return {};
}

bool ScanJob::render_azimuths(const LiveView& view, const std::stop_token& stop) {
  Pass& pass = *scan_->pass;
  const auto start = Clock::now();
  wire::Pose pose;
  write_message(view.pose, pose);
  pass.encoder.set_dwell(pose, view.pose_received_ns, view.pose_stale,
                         in_nanoseconds(scan_->schedule.middle(scan_->next)));
  // Wedges of one dwell are finished in any order; a display is given them in the beam's.
  std::vector<Wedge> wedges;
  pass.take_targets();
  RenderOptions options = pass.render_options(stop, view);
  options.sharp = &scan_->sharp;
  options.dwell = static_cast<std::uint64_t>(scan_->next.number);
  options.on_wedge = [&](Wedge&& wedge) { wedges.push_back(std::move(wedge)); };
  const AzimuthRange azimuths = scan_->schedule.azimuths(scan_->next);
  if (pass.bins && !render_wanted(azimuths, options)) return false;
  const bool clockwise = scan_->schedule.is_clockwise(scan_->next.pass);
  std::ranges::sort(wedges, [&](const Wedge& a, const Wedge& b) {
    return clockwise ? a.index < b.index : a.index > b.index;
  });
  for (const Wedge& wedge : wedges) {
    pass.stats.add(wedge);
    pass.send(pass.encoder.wedge(wedge.index, wedge.bins));
  }
  if (pass.pulses && is_wanted(azimuths)) {
    const double rate_deg_s = scan_->settings->settings.scan_rate_deg_s;
    if (!pass.send_train({azimuths, clockwise ? rate_deg_s : -rate_deg_s}, options)) return false;
  }
  pass.send_truth(azimuths, options);
  const double render_s = to_seconds(Clock::now() - start);
  if (pass.rendered.first_wedge_s == 0) pass.rendered.first_wedge_s = render_s;
  pass.rendered.render_s += render_s;
  return true;
}

bool ScanJob::render_wanted(const AzimuthRange& azimuths, const RenderOptions& options) const {
  const Pass& pass = *scan_->pass;
  const int end = azimuths.first / kWedgeAzimuthBins + wedges_of(azimuths);
  const auto is_wanted = [&](int wedge) { return pass.wanted[static_cast<std::size_t>(wedge)]; };
  for (int from = azimuths.first / kWedgeAzimuthBins; from < end; ++from) {
    if (!is_wanted(from)) continue;
    int to = from;
    while (to < end && is_wanted(to)) ++to;
    const int begin_bin = from * kWedgeAzimuthBins;
    const int end_bin = std::min(to * kWedgeAzimuthBins, azimuths.first + azimuths.count);
    if (!pass.plan->render({begin_bin, end_bin - begin_bin}, options)) return false;
    from = to;
  }
  return true;
}

void ScanJob::end_pass() {
  Pass& pass = *scan_->pass;
  pass.send_end(pass.missed);
  context_.events.on_live_rendered(stream_.radar(), pass.rendered);
  scan_->pass = nullptr;
}

}  // namespace obliq::rendering
