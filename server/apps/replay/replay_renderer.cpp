#include "server/apps/replay/replay_renderer.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"
#include "server/control/settings_message.h"

namespace obliq {

namespace {

using Clock = ReplayClock::Clock;

// The render thread is stopped between plans: it shall not wait for a frame for longer than this.
constexpr std::chrono::milliseconds kLongestWait{100};
// Later than this, no client was watching. A shorter delay is caught up by leaving frames out.
constexpr std::chrono::seconds kMostLate{2};

/// False when stopped before.
bool wait_until(Clock::time_point due, const std::stop_token& stop) {
  if (due <= Clock::now()) return !stop.stop_requested();
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_until(lock, stop, due, [] { return false; });
  return !stop.stop_requested();
}

/// The rows of some azimuth bins.
template <typename T>
std::vector<T> rows(const std::vector<T>& plane, std::size_t first, std::size_t count, std::size_t n_range) {
  // A plane that was not recorded; the server does not send it.
  if (plane.empty()) return std::vector<T>(count * n_range);
  const auto begin = plane.begin() + static_cast<std::ptrdiff_t>(first * n_range);
  return {begin, begin + static_cast<std::ptrdiff_t>(count * n_range)};
}

class ReplayedFrame : public net::PlannedFrame {
 public:
  ReplayedFrame(std::shared_ptr<const client::RecordedFrame> recorded, Clock::time_point begun,
                const ReplayClock& clock)
      : recorded_(std::move(recorded)), begun_(begun), clock_(clock) {}

  void describe(const std::string&, wire::FrameDescriptor& descriptor) const override {
    descriptor = *recorded_->frame.descriptor;
  }

  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    const client::AssembledFrame& frame = recorded_->frame;
    const auto first_wanted = static_cast<std::uint32_t>(azimuths.first);
    const auto end_wanted = static_cast<std::uint32_t>(azimuths.first + azimuths.count);
    for (const client::RecordedWedge& recorded : recorded_->wedges) {
      const std::uint32_t end_azimuth = recorded.first_azimuth + recorded.n_azimuth;
      if (recorded.first_azimuth >= end_wanted || end_azimuth <= first_wanted) continue;
      if (!wait_until(due(recorded.utc_ns), options.stop)) return false;
      Wedge wedge;
      // What a file says may be anything; there are no more wedges than this in a frame.
      const int most = (frame.n_azimuth - 1) / kWedgeAzimuthBins;
      wedge.index = static_cast<int>(std::min(recorded.index, static_cast<std::uint32_t>(most)));
      wedge.bins.first_azimuth = static_cast<int>(recorded.first_azimuth);
      wedge.bins.n_azimuth = static_cast<int>(recorded.n_azimuth);
      wedge.bins.n_range = frame.n_range;
      const auto n_range = static_cast<std::size_t>(frame.n_range);
      wedge.bins.iq = rows(frame.iq, recorded.first_azimuth, recorded.n_azimuth, n_range);
      wedge.bins.power_w = rows(frame.power_w, recorded.first_azimuth, recorded.n_azimuth, n_range);
      wedge.bins.count = rows(frame.count, recorded.first_azimuth, recorded.n_azimuth, n_range);
      wedge.bins.state = rows(frame.state, recorded.first_azimuth, recorded.n_azimuth, n_range);
      if (options.video8 || options.video16)
        add_video(rows(frame.video, recorded.first_azimuth, recorded.n_azimuth, n_range), options,
                  wedge.bins);
      options.on_wedge(std::move(wedge));
    }
    return wait_until(due(recorded_->end_utc_ns), options.stop);
  }

  void summarise(const FrameStats&, wire::FrameSummary& summary) const override {
    summary = *recorded_->frame.summary;
  }

 private:
  /// In the levels that are asked for, whatever was recorded.
  void add_video(std::vector<std::uint16_t> levels, const RenderOptions& options, BinBlock& bins) const {
    const bool of_8_bits = recorded_->frame.video_bits == 8;
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

  Clock::time_point due(std::int64_t utc_ns) const {
    std::int64_t since_ns = 0;
    if (__builtin_sub_overflow(utc_ns, recorded_->begin_utc_ns, &since_ns)) since_ns = 0;
    return begun_ + clock_.scaled(since_ns);
  }

  std::shared_ptr<const client::RecordedFrame> recorded_;
  Clock::time_point begun_;
  ReplayClock clock_;
};

constexpr std::int64_t kLongestPause_ns = std::chrono::nanoseconds(ReplayClock::kLongestPause).count();
// Messages are encoded on several threads: so little backwards is not a clock that was set.
constexpr std::int64_t kJitter_ns = 1'000'000'000;

/// later - earlier, where both may be anything that was in a file.
std::int64_t difference_ns(std::int64_t later, std::int64_t earlier) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(later, earlier, &difference)) return later > earlier ? INT64_MAX : INT64_MIN;
  return difference;
}

}  // namespace

ReplayRenderer::ReplayRenderer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                               std::function<void(const std::string&)> say, std::function<void()> ended)
    : path_(std::move(path)),
      start_(std::move(start)),
      options_(options),
      say_(std::move(say)),
      ended_(std::move(ended)),
      clock_(options.speed) {}

std::string ReplayRenderer::fixed() const {
  return "this server replays a recording of radar " + start_.radar +
         ": it can be watched, not controlled, and renders nothing else";
}

std::vector<FieldError> ReplayRenderer::place(const PoseSettings&) const {
  return {{"pose", "a pose", "none: " + fixed()}};
}

client::RecordingLosses ReplayRenderer::losses() const {
  const std::lock_guard lock(mutex_);
  return losses_;
}

// The next whole frame, or nothing at the recording's end.
std::optional<ReplayRenderer::Due> ReplayRenderer::read_frame() const {
  bool anything = false;  // a recording without a whole frame is not begun again for ever
  for (;;) {
    if (!frames_) {
      std::unique_ptr<client::RecordingReader> reader;
      if (const client::Status status = client::RecordingReader::open(path_, reader); !status.ok()) {
        say_(status.sentence());
        return std::nullopt;
      }
      frames_ = std::make_unique<client::RecordedFrames>(std::move(reader), start_.radar, start_.planes);
    }
    auto frame = std::make_shared<client::RecordedFrame>();
    const auto found = frames_->next(*frame);
    losses_ = client::more_of(losses_, frames_->losses());
    if (!frames_->note().empty()) say_(frames_->note());
    if (found == client::RecordedFrames::Found::frame) {
      if (frame->frame.descriptor->has_window()) {
        say_("a frame of a part of the bins is left out: whole frames only can be served");
        continue;
      }
      const std::int64_t begin_ns = frame->begin_utc_ns;
      return Due{std::move(frame), clock_.due(begin_ns)};
    }
    if (found == client::RecordedFrames::Found::note) continue;
    if (!options_.loop || anything) return std::nullopt;
    anything = true;
    frames_.reset();
    clock_.begin_again();
  }
}

net::FrameRenderer::Plan ReplayRenderer::plan(const SettingsPtr& settings, const PoseSettings&) const {
  const std::lock_guard lock(mutex_);
  if (over_) {
    std::this_thread::sleep_for(kLongestWait);
    return {};
  }
  if (!next_) next_ = read_frame();
  if (next_ && next_->at > Clock::now()) {
    std::this_thread::sleep_until(std::min(next_->at, Clock::now() + kLongestWait));
    if (next_->at > Clock::now()) return {};
  }
  if (next_ && Clock::now() - next_->at > kMostLate) {
    clock_.stand_still();
    next_->at = clock_.due(next_->frame->begin_utc_ns);
  }
  const auto now = Clock::now();
  std::optional<Due> newest;
  while (next_ && (!newest || (std::isfinite(options_.speed) && next_->at <= now))) {
    newest = std::exchange(next_, std::nullopt);
    next_ = read_frame();
  }
  if (!newest) {
    over_ = true;
    ended_();
    return {};
  }
  Plan plan;
  RadarSettings as_recorded = settings->settings;
  plan.errors = merge_message(newest->frame->frame.descriptor->settings(), as_recorded);
  if (!plan.errors.empty()) return plan;
  as_recorded.scan_mode = ScanMode::frame;
  plan.settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{as_recorded, settings->version});
  plan.frame = std::make_unique<ReplayedFrame>(std::move(newest->frame), newest->at, clock_);
  return plan;
}

ReplayClock::Clock::duration ReplayClock::scaled(std::int64_t recorded_ns) const {
  if (!std::isfinite(speed_)) return {};
  const double ns = static_cast<double>(std::clamp<std::int64_t>(recorded_ns, 0, kLongestPause_ns)) / speed_;
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(ns));
}

void ReplayClock::begin_again() {
  newest_ns_.reset();
  due_ += scaled(last_gap_ns_);
}

ReplayClock::Clock::time_point ReplayClock::due(std::int64_t utc_ns) {
  if (!newest_ns_) {
    newest_ns_ = utc_ns;
    return due_ = std::max(due_, Clock::now());
  }
  const std::int64_t gap_ns = difference_ns(utc_ns, *newest_ns_);
  if (gap_ns > 0) {
    due_ += scaled(gap_ns);
    last_gap_ns_ = gap_ns;
  }
  if (gap_ns > 0 || gap_ns < -kJitter_ns) newest_ns_ = utc_ns;
  return due_;
}

}  // namespace obliq
