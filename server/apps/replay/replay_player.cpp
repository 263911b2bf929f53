#include "server/apps/replay/replay_player.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/recording/recorded_events.h"
#include "proto/obliq.pb.h"
#include "server/apps/replay/replayed_frame.h"
#include "server/control/key.h"
#include "server/control/settings_message.h"

namespace obliq {

namespace {

// The render thread is stopped between plans: it shall not wait for a frame for longer than this.
constexpr std::chrono::milliseconds kLongestWait{100};
// A shorter delay is caught up by leaving frames out; after a longer one, nothing could be shown meanwhile.
constexpr double kMostLate_s = 2;

}  // namespace

ReplayPlayer::ReplayPlayer(std::string path, client::RecordingStart start, const ReplayOptions& options,
                           std::function<void(const std::string&)> say, std::function<void()> ended)
    : path_(std::move(path)),
      start_(std::move(start)),
      options_(options),
      say_(std::move(say)),
      ended_(std::move(ended)),
      clock_(options.speed) {
  const client::Status status = client::RecordingSearch::open(path_, start_.radar, search_);
  if (!status.ok()) throw InputError(status.sentence());
  origin_utc_ns_ = options.origin_utc_ns.value_or(search_->first().utc_ns);
  duration_ns_ = from_start_ns(search_->end_utc_ns());
  // One that began before the flight has them later on.
  has_sim_times_ = search_->first().sim_time_ns || search_->at_utc(search_->end_utc_ns()).frame.sim_time_ns;
  time_.restart(from_start_ns(search_->first().utc_ns));
}

std::int64_t ReplayPlayer::from_start_ns(std::int64_t utc_ns) const {
  std::int64_t ns = 0;
  if (__builtin_sub_overflow(utc_ns, origin_utc_ns_, &ns)) return 0;
  return std::max<std::int64_t>(ns, 0);
}

client::RecordingLosses ReplayPlayer::losses() const {
  const std::lock_guard lock(reading_);
  return losses_;
}

bool ReplayPlayer::is_over() const {
  const std::lock_guard lock(state_);
  return over_;
}

// ---- Reading ----

// The next whole frame, or nothing at the recording's end.
std::optional<ReplayPlayer::Due> ReplayPlayer::read_frame() {
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
      const std::int64_t at_ns = time_.at(frame->begin_utc_ns);
      return Due{std::move(frame), at_ns};
    }
    if (found == client::RecordedFrames::Found::note) continue;
    if (!options_.loop || anything) return std::nullopt;
    anything = true;
    frames_.reset();
    time_.begin_again();
  }
}

// Before the frame of the place comes the one before it, so that a turning antenna's picture is whole.
void ReplayPlayer::go_to(const Seek& place) {
  std::int64_t utc_ns = 0;
  if (__builtin_add_overflow(origin_utc_ns_, place.at_ns, &utc_ns)) utc_ns = INT64_MAX;
  auto found = search_->at_utc(utc_ns);
  std::int64_t to_ns = place.at_ns;
  if (place.sim_time_ns) {
    found = search_->at_sim_time(*place.sim_time_ns).value_or(found);
    to_ns = from_start_ns(found.frame.utc_ns);
  }
  std::unique_ptr<client::RecordingReader> reader;
  if (const client::Status status = client::RecordingReader::open(path_, reader); !status.ok())
    return say_(status.sentence());
  reader->seek(found.before.offset);
  frames_ = std::make_unique<client::RecordedFrames>(std::move(reader), start_.radar, start_.planes);
  time_.restart(from_start_ns(found.before.utc_ns));
  keep_until_ns_ = to_ns;
  next_ = read_frame();
  const std::lock_guard lock(state_);
  if (seek_) return;  // somewhere else by now
  frame_at_ns_ = frame_place_ns_ = to_ns;
  clock_.jump(to_ns);
  jumps_ = clock_.jumps();
}

ReplayPlayer::Due ReplayPlayer::take_newest() {
  const std::int64_t now_ns = clock_.now_ns();
  const bool leaves_out = std::isfinite(clock_.speed());
  std::optional<Due> newest;
  while (next_ && (!newest || (leaves_out && !is_kept(*newest) && next_->at_ns <= now_ns))) {
    newest = std::exchange(next_, std::nullopt);
    next_ = read_frame();
  }
  return std::move(*newest);
}

void ReplayPlayer::end() {
  {
    const std::lock_guard lock(state_);
    if (seek_) return;
    over_ = true;
  }
  tell();
  if (!options_.hold) ended_();
}

rendering::FrameRenderer::Plan ReplayPlayer::plan(const SettingsPtr& settings) {
  const std::lock_guard reading(reading_);
  std::optional<Seek> place;
  // Places sought faster than they can be shown do not keep each other from being shown.
  if (!next_ || !is_kept(*next_)) {
    const std::lock_guard lock(state_);
    place = std::exchange(seek_, std::nullopt);
  }
  if (place) {
    go_to(*place);
    tell();
  }
  const std::uint64_t jumps_now = clock_.jumps();
  if (is_over()) {
    (void)clock_.wait_until(INT64_MAX, jumps_now, {}, kLongestWait);
    return {};
  }
  if (!next_) next_ = read_frame();
  if (!next_) {
    end();
    return {};
  }
  if (!is_kept(*next_)) {
    if (clock_.wait_until(next_->at_ns, jumps_, {}, kLongestWait) != PlaybackClock::Outcome::reached)
      return {};
    const double late_s = 1e-9 * static_cast<double>(clock_.now_ns() - next_->at_ns) / clock_.speed();
    if (late_s > kMostLate_s) {
      if (!in_step_.empty()) {  // nobody watched it, or it could not: the others have gone on
        go_to({clock_.now_ns()});
        return {};
      }
      clock_.set_back(next_->at_ns);
      tell();
    }
  }
  const Due due = take_newest();
  {
    const std::lock_guard lock(state_);
    const bool elsewhere = jumps_ != clock_.jumps();
    if (elsewhere && !is_kept(due)) return {};
    if (!elsewhere) {
      frame_at_ns_ = due.at_ns;
      frame_place_ns_ = from_start_ns(due.frame->begin_utc_ns);
      const std::int64_t sim_time_ns = due.frame->frame.descriptor->pose().sim_time_ns();
      frame_sim_time_ns_ = sim_time_ns == 0 ? std::nullopt : std::optional(sim_time_ns);
    }
  }
  rendering::FrameRenderer::Plan plan;
  const wire::FrameDescriptor& recorded = *due.frame->frame.descriptor;
  RadarSettings as_recorded = settings->settings;
  plan.errors = merge_message(recorded.settings(), as_recorded);
  if (!plan.errors.empty()) return plan;
  as_recorded.video.floor_auto = false;  // it was found
  as_recorded.video.floor_db = recorded.video_floor_db();
  as_recorded.scan_mode = ScanMode::frame;  // its beam has swept
  plan.settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{as_recorded, settings->version});
  plan.for_all = is_kept(due);
  const ReplayedFrame::Times times{due.at_ns, keep_until_ns_, jumps_};
  plan.frame = std::make_unique<ReplayedFrame>(due.frame, video_scale(as_recorded), clock_, times);
  return plan;
}

void ReplayPlayer::stop() {
  const std::lock_guard lock(state_);
  over_ = true;
  clock_.jump(clock_.now_ns());
}

// ---- Control ----

void ReplayPlayer::seek_to(const Seek& place) {
  seek_ = place;
  over_ = false;
  frame_at_ns_ = frame_place_ns_ = place.at_ns;
  clock_.jump(place.at_ns);
}

// From the recording's start.
std::int64_t ReplayPlayer::place_ns() const {
  if (over_) return duration_ns_;
  return std::clamp<std::int64_t>(frame_place_ns_ + clock_.now_ns() - frame_at_ns_, 0, duration_ns_);
}

std::string replay_speeds() {
  return fmt::format("{:.10g} to {:.10g} recorded seconds in a second", kSlowestReplay, kFastestReplay);
}

std::vector<FieldError> ReplayPlayer::set(const wire::SetReplay& request) {
  std::vector<FieldError> errors;
  const bool speed_is_good = (request.speed() >= kSlowestReplay && request.speed() <= kFastestReplay) ||
                             request.speed() == std::numeric_limits<double>::infinity();
  if (request.has_speed() && !speed_is_good)
    errors.push_back(
        {"speed", toml_number(request.speed()), replay_speeds() + ", or infinity (without waiting)"});
  const double duration_s = 1e-9 * static_cast<double>(duration_ns_);
  if (request.has_seek_s() && !(request.seek_s() >= 0 && request.seek_s() <= duration_s))
    errors.push_back(
        {"seek_s", toml_number(request.seek_s()), fmt::format("0 to {} s, its length", duration_s)});
  if (request.has_seek_sim_time_ns() && request.has_seek_s())
    errors.push_back({"seek_sim_time_ns", "a time beside seek_s", "one of the two"});
  if (request.has_seek_sim_time_ns() && !has_sim_times_)
    errors.push_back({"seek_sim_time_ns", std::to_string(request.seek_sim_time_ns()),
                      "nothing: the poses of this recording have no sim_time_ns; seek_s"});
  if (!errors.empty()) return errors;
  take(request);
  for (ReplayPlayer* other : in_step_) other->follow(request);
  return {};
}

void ReplayPlayer::follow(wire::SetReplay request) {
  if (request.has_seek_s())
    request.set_seek_s(std::min(request.seek_s(), 1e-9 * static_cast<double>(duration_ns_)));
  if (!has_sim_times_) request.clear_seek_sim_time_ns();
  take(request);
}

void ReplayPlayer::take(const wire::SetReplay& request) {
  {
    const std::lock_guard lock(state_);
    if (request.has_paused()) clock_.set_paused(request.paused());
    if (request.has_speed()) clock_.set_speed(request.speed());
    if (request.has_seek_s() || request.has_seek_sim_time_ns()) {
      ++seeks_;
      Seek place{place_ns()};
      if (request.has_seek_s()) place.at_ns = std::llround(request.seek_s() * 1e9);
      if (request.has_seek_sim_time_ns()) place.sim_time_ns = request.seek_sim_time_ns();
      seek_to(place);
    }
  }
  tell();
}

void ReplayPlayer::keep_in_step(ReplayPlayer& other) {
  in_step_.push_back(&other);
  other.in_step_.push_back(this);
}

void ReplayPlayer::write_state(wire::ReplayState& state) const {
  const std::lock_guard lock(state_);
  state.set_radar(start_.radar);
  state.set_start_utc_ns(origin_utc_ns_);
  state.set_duration_s(1e-9 * static_cast<double>(duration_ns_));
  state.set_position_s(1e-9 * static_cast<double>(place_ns()));
  state.set_speed(clock_.speed());
  state.set_paused(clock_.is_paused());
  state.set_running(clock_.runs() && !over_);
  state.set_loop(options_.loop);
  state.set_ended(over_);
  state.set_seeks(seeks_);
  if (frame_sim_time_ns_) state.set_sim_time_ns(*frame_sim_time_ns_);
}

void ReplayPlayer::each_event(const std::function<void(const wire::ExerciseEvent&)>& call) const {
  client::RecordedLog log;
  const client::Status status = client::read_events(
      path_,
      [&](const wire::ExerciseEvents& events) {
        for (const wire::ExerciseEvent& event : events.events()) call(event);
      },
      log);
  if (!status.ok()) say_(status.sentence());
}

void ReplayPlayer::keep(const wire::ExerciseEvent& bookmark) {
  if (!options_.keep_bookmarks) return;
  wire::ExerciseEvents one;
  *one.add_events() = bookmark;
  if (const client::Status status = client::append_events(path_, one); !status.ok())
    say_("the bookmark is not kept: " + status.sentence());
}

void ReplayPlayer::watched(bool by_anyone, bool newcomer) {
  {
    const std::lock_guard lock(state_);
    const bool ran = clock_.runs();
    has_watchers_ = by_anyone;
    update_watched();
    // Where time stands still, nothing would come until it flows again.
    const bool shows_again = newcomer && !seek_ && (clock_.is_paused() || over_);
    if (shows_again) seek_to({place_ns()});
    if (ran == clock_.runs() && !shows_again) return;
  }
  tell();
  for (const ReplayPlayer* other : in_step_) other->tell();
}

void ReplayPlayer::update_watched() {
  bool any = has_watchers_;
  for (const ReplayPlayer* other : in_step_) any |= other->has_watchers_;
  clock_.set_watched(any);
  for (ReplayPlayer* other : in_step_) other->clock_.set_watched(any);
}

void ReplayPlayer::on_change(std::function<void()> call) {
  const std::lock_guard lock(state_);
  changed_ = std::move(call);
}

void ReplayPlayer::tell() const {
  std::function<void()> call;
  {
    const std::lock_guard lock(state_);
    call = changed_;
  }
  if (call) call();
}

}  // namespace obliq
