#include "server/apps/replay/replayed_frame.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"
#include "server/apps/replay/received_train.h"
#include "server/apps/replay/recorded_time.h"
#include "server/radar/receiver/video.h"
#include "server/stream/frame_encoder.h"

namespace obliq {
namespace {

/// The rows of some azimuth bins.
template <typename T>
std::vector<T> rows(const std::vector<T>& plane, std::size_t first, std::size_t count, std::size_t n_range) {
  // A plane that was not recorded; the server does not send it.
  if (plane.empty()) return std::vector<T>(count * n_range);
  const auto begin = plane.begin() + static_cast<std::ptrdiff_t>(first * n_range);
  return {begin, begin + static_cast<std::ptrdiff_t>(count * n_range)};
}

/// The recorded levels, in those that are asked for.
void add_video(std::vector<std::uint16_t> levels, int recorded_bits, const RenderOptions& options,
               BinBlock& bins) {
  const bool of_8_bits = recorded_bits == 8;
  const auto narrow = [](std::uint16_t level) { return static_cast<std::uint8_t>(level); };
  bins.video8.resize(options.video8 ? levels.size() : 0);
  if (options.video8)
    std::ranges::transform(levels, bins.video8.begin(), [&](std::uint16_t level) {
      return of_8_bits ? narrow(level) : wire::video8_of(level);
    });
  if (!options.video16) return;
  if (of_8_bits)
    std::ranges::transform(levels, levels.begin(),
                           [&](std::uint16_t level) { return wire::video16_of(narrow(level)); });
  bins.video16 = std::move(levels);
}

/// A reading of the recorded server's clock by this server's, as it was beside `recorded_now_ns`. 0 stays:
/// there was none.
std::int64_t by_this_clock(std::int64_t recorded_ns, std::int64_t recorded_now_ns, std::int64_t now_ns) {
  std::int64_t age_ns = 0;
  if (recorded_ns == 0 || __builtin_sub_overflow(recorded_now_ns, recorded_ns, &age_ns) ||
      __builtin_sub_overflow(now_ns, age_ns, &now_ns))
    return 0;
  return now_ns;
}

}  // namespace

ReplayedFrame::ReplayedFrame(std::shared_ptr<const client::RecordedFrame> recorded, const VideoScale& video,
                             PlaybackClock& clock, const Times& times)
    : recorded_(std::move(recorded)), video_(video), clock_(clock), times_(times) {}
ReplayedFrame::~ReplayedFrame() = default;

void ReplayedFrame::describe(const std::string&, wire::FrameDescriptor& descriptor) const {
  descriptor = *recorded_->frame.descriptor;
}

void ReplayedFrame::summarise(const FrameStats&, wire::FrameSummary& summary) const {
  summary = *recorded_->frame.summary;
}

std::vector<wire::TargetRecord> ReplayedFrame::truth(AzimuthRange, const RenderOptions&, double) const {
  const auto& all = recorded_->frame.targets;
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(
                                         std::min<std::size_t>(all.size(), wire::kMaxTargetRecords))};
}

const wire::ScanPass* ReplayedFrame::scan() const {
  if (!recorded_->scan) return nullptr;
  scan_ = std::make_unique<wire::ScanPass>(*recorded_->scan);
  std::int64_t recorded_now_ns = 0;
  if (__builtin_sub_overflow(recorded_->begin_utc_ns, recorded_->clock_offset_ns, &recorded_now_ns))
    recorded_now_ns = 0;
  scan_->set_begin_ns(by_this_clock(scan_->begin_ns(), recorded_now_ns, stream::monotonic_ns()));
  return scan_.get();
}

std::vector<AzimuthRange> ReplayedFrame::missed() const {
  std::vector<AzimuthRange> missed;
  for (const auto& [first, count] : recorded_->frame.missed) missed.push_back({first, count});
  return missed;
}

std::string ReplayedFrame::why_stopped() const {
  if (clock_.jumps() != times_.jumps) return "the replay went to another place";
  return PlannedFrame::why_stopped();
}

bool ReplayedFrame::wait_until(std::int64_t utc_ns, const std::stop_token& stop) const {
  const std::int64_t at_ns = times_.begin_ns + recorded_gap_ns(recorded_->begin_utc_ns, utc_ns);
  if (at_ns <= times_.keep_until_ns) return !stop.stop_requested();
  constexpr auto kForEver = std::chrono::hours(24);  // the token ends it
  PlaybackClock::Outcome outcome{};
  do {
    outcome = clock_.wait_until(at_ns, times_.jumps, stop, kForEver);
  } while (outcome == PlaybackClock::Outcome::not_yet);
  return outcome == PlaybackClock::Outcome::reached;
}

void ReplayedFrame::take_dwell(const client::RecordedWedge& recorded) const {
  dwell_.reset();
  if (!recorded.block || !recorded.block->has_pose()) return;
  const wire::WedgeBlock& block = *recorded.block;
  const std::int64_t now_ns = stream::monotonic_ns();
  dwell_ = std::make_unique<wire::WedgeBlock>();
  *dwell_->mutable_pose() = block.pose();
  dwell_->set_pose_stale(block.pose_stale());
  dwell_->set_pose_received_ns(by_this_clock(block.pose_received_ns(), block.send_ns(), now_ns));
  dwell_->set_beam_ns(by_this_clock(block.beam_ns(), block.send_ns(), now_ns));
}

void ReplayedFrame::give_trains(const client::RecordedWedge& recorded, const RenderOptions& options) const {
  if (!options.on_train) return;
  const auto first = static_cast<int>(recorded.first_azimuth);
  const int end = first + static_cast<int>(recorded.n_azimuth);
  for (const client::AssembledTrain& train : recorded_->frame.trains) {
    // With the first wedge of its azimuths, whichever way the antenna turns.
    const bool meets = train.first_azimuth < end && train.first_azimuth + train.n_azimuth > first;
    if (meets && given_.insert(&train).second) options.on_train(received_train(train));
  }
}

bool ReplayedFrame::render(AzimuthRange azimuths, const RenderOptions& options) const {
  const client::AssembledFrame& frame = recorded_->frame;
  const auto first_wanted = static_cast<std::uint32_t>(azimuths.first);
  const auto end_wanted = static_cast<std::uint32_t>(azimuths.first + azimuths.count);
  for (const client::RecordedWedge& recorded : recorded_->wedges) {
    const std::uint32_t end_azimuth = recorded.first_azimuth + recorded.n_azimuth;
    if (recorded.missed || recorded.first_azimuth >= end_wanted || end_azimuth <= first_wanted) continue;
    if (!wait_until(recorded.utc_ns, options.stop)) return false;
    Wedge wedge;
    // What a file says may be anything; there are no more wedges than this in a frame.
    const int most = (frame.n_azimuth - 1) / kWedgeAzimuthBins;
    wedge.index = static_cast<int>(std::min(recorded.index, static_cast<std::uint32_t>(most)));
    wedge.bins.first_azimuth = static_cast<int>(recorded.first_azimuth);
    wedge.bins.n_azimuth = static_cast<int>(recorded.n_azimuth);
    wedge.bins.n_range = frame.n_range;
    const auto n_range = static_cast<std::size_t>(frame.n_range);
    const auto rows_of = [&](const auto& plane) {
      return rows(plane, recorded.first_azimuth, recorded.n_azimuth, n_range);
    };
    wedge.bins.iq = rows_of(frame.iq);
    wedge.bins.power_w = rows_of(frame.power_w);
    wedge.bins.count = rows_of(frame.count);
    wedge.bins.state = rows_of(frame.state);
    if (options.labels)
      wedge.bins.labels = {rows_of(frame.material), rows_of(frame.building), rows_of(frame.height_m),
                           rows_of(frame.returns)};
    if (options.target_ids) wedge.bins.target = rows_of(frame.target);
    if (!frame.video.empty() && (options.video8 || options.video16)) {
      add_video(rows_of(frame.video), frame.video_bits, options, wedge.bins);
    } else if (options.video8 || options.video16) {
      add_video_of_iq(video_, options.video8, options.video16, wedge.bins);
    }
    take_dwell(recorded);
    give_trains(recorded, options);
    options.on_wedge(std::move(wedge));
  }
  return wait_until(recorded_->end_utc_ns, options.stop);
}

}  // namespace obliq
