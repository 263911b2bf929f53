#include "server/flight/scene_keeper.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "server/log/log.h"
#include "server/scene/scene.h"
#include "terrain/base/errors.h"
#include "terrain/base/parallel.h"
#include "terrain/base/process.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// How often to check whether the last frame of a scene has ended.
constexpr std::chrono::milliseconds kLook{50};
/// A frame that clients never read must not delay loading: after this long there may be a third scene.
constexpr std::chrono::seconds kLongestFrame{90};

constexpr double kFirstPause_s = 5;
constexpr double kLongestPause_s = 60;

constexpr const char* kSuperseded = "a newer configuration came before this one was loaded";

/// A window has to be there before what is loaded ends: twice what the last one took, and a few seconds.
constexpr double kLeastLead_s = 5;

/// Grids of later windows have the cell that "auto" gave the first one.
void keep_cell(SceneConfig& config, const Scene& scene) {
  if (!config.world.terrain.cell_m) config.world.terrain.cell_m = scene.world().grid.cell_m;
}

void check_size(const SceneConfig& config, const SceneWindow& window) {
  if (!config.world.terrain.cell_m || !config.world.terrain.area.empty()) return;
  const double megaposts = window_posts(window, *config.world.terrain.cell_m) / 1e6;
  if (megaposts <= config.flight.max_megaposts) return;
  throw InputError(FieldError{
      "flight.max_megaposts", fmt::format("terrain of {} million posts around the radars", megaposts),
      fmt::format(
          "at most {} million, so raise it, make terrain.cell_m larger, or keep the radars closer together",
          config.flight.max_megaposts)}
                       .text());
}

/// Default: the whole world, if extents cannot be read any longer.
SourceExtents extents_of(const SceneConfig& config) {
  try {
    return source_extents(config.world.terrain);
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

SceneKeeper::SceneKeeper(SceneConfig config, std::shared_ptr<const Scene> scene, Build build, Swap swap,
                         Now now)
    : build_(std::move(build)),
      swap_(std::move(swap)),
      now_(std::move(now)),
      config_(std::move(config)),
      scene_(std::move(scene)) {
  state_.window = window_of(config_);
  keep_cell(config_, *scene_);
  extents_ = extents_of(config_);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SceneKeeper::~SceneKeeper() {
  thread_.request_stop();
  thread_.join();
  if (reload_) reload_->done("the server is stopping");
}

void SceneKeeper::reload(SceneConfig config, Done done) {
  Request request{std::move(config), {}, std::move(done)};
  std::optional<Request> replaced;
  {
    const std::lock_guard lock(mutex_);
    replaced = std::exchange(reload_, std::move(request));
    superseded_ = true;
    build_stop_.request_stop();
    changed_.notify_all();
  }
  if (replaced) replaced->done(kSuperseded);
}

void SceneKeeper::give_up_reload() {
  std::optional<Request> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting = std::exchange(reload_, std::nullopt);
    if (reload_in_hand_) {
      superseded_ = true;
      build_stop_.request_stop();
    }
  }
  if (waiting) waiting->done(kSuperseded);
}

void SceneKeeper::poses_changed(std::vector<RadarPlace> radars) {
  const std::lock_guard lock(mutex_);
  const auto now = now_();
  radars_ = std::move(radars);
  speed_.note(radars_, now);
  const bool wanted = window_wanted(now).has_value();
  if (!wanted && !reload_failed_) note_well();
  if (wanted && !state_.building && now >= not_before_) changed_.notify_all();
}

SceneKeeper::State SceneKeeper::state() const {
  const std::lock_guard lock(mutex_);
  State state = state_;
  if (state.failures > 0 && state.last_error.empty()) state.well_s = to_seconds(now_() - well_since_);
  return state;
}

GroundThere SceneKeeper::ground_at(const LonLat& place, double r_max_m) const {
  const std::lock_guard lock(mutex_);
  GroundThere there{extents_.share(place, r_max_m), {}};
  if (extents_.covers(place)) return there;
  const std::string found = fmt::format(
      "no file has ground at latitude {:.4f}, longitude {:.4f}, and for {:.0f} % of what lies within {:.1f} "
      "km: ",
      place.latitude_deg, place.longitude_deg, 100 * (1 - there.coverage), r_max_m / 1000);
  there.warning = found + extents_.text();
  return there;
}

void SceneKeeper::note_well() {
  if (state_.last_error.empty()) return;
  state_.last_error.clear();
  reload_failed_ = false;
  well_since_ = now_();
}

double SceneKeeper::lead_s() const { return kLeastLead_s + 2 * state_.last_build_s; }

std::optional<SceneWindow> SceneKeeper::window_due() const {
  const auto now = now_();
  return now < not_before_ ? std::nullopt : window_wanted(now);
}

/// Those of `radars_`, or of where they will be, that can see ground of some file now: for the others none
/// can be loaded, and the rest is not to suffer from it.
std::vector<RadarPlace> SceneKeeper::with_ground(const std::vector<RadarPlace>& places) const {
  std::vector<RadarPlace> left;
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    if (extents_.reaches(radars_[i].position, radars_[i].r_max_m)) left.push_back(places[i]);
  }
  return left;
}

std::optional<SceneWindow> SceneKeeper::window_wanted(Clock::time_point now) const {
  const std::vector<RadarPlace> radars = with_ground(radars_);
  const std::vector<RadarPlace> ahead = with_ground(speed_.ahead(radars_, lead_s(), now));
  if (!needs_next_window(config_, state_.window, radars, ahead)) return std::nullopt;
  SceneWindow next = next_window(config_, state_.window, radars, ahead);
  if (is_same(next, state_.window)) return std::nullopt;  // built again it would be no better
  return next;
}

std::optional<SceneKeeper::Request> SceneKeeper::next_request() {
  if (reload_) {
    std::optional<Request> request = std::exchange(reload_, std::nullopt);
    // The new file's window, unless the radars have been moved since the start.
    request->window = window_of(request->config);
    const bool same_files = request->config.world.terrain.dem == config_.world.terrain.dem;
    const std::vector<RadarPlace> radars = same_files ? with_ground(radars_) : radars_;
    if (!radars.empty() && request->config.flight.enabled)
      request->window = next_window(request->config, request->window, radars, radars);
    return request;
  }
  auto window = window_due();
  if (!window) return std::nullopt;
  return Request{config_, std::move(*window), nullptr};
}

void SceneKeeper::run(const std::stop_token& stop) {
  if (!lower_own_priority()) log_warning("terrain is loaded at the same priority as frames are rendered");
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (auto request = next_request()) {
      serve(std::move(*request), stop, lock);
      continue;
    }
    if (retired_ && retired_.use_count() == 1) {
      auto last = std::exchange(retired_, nullptr);
      lock.unlock();
      last.reset();  // hundreds of megabytes: not under the lock, and not on a thread that renders
      lock.lock();
      continue;
    }
    if (retired_) {
      changed_.wait_for(lock, stop, kLook, [] { return false; });
    } else if (const auto now = now_(); now < not_before_) {
      changed_.wait_for(lock, stop, not_before_ - now, [this] { return reload_.has_value(); });
    } else {
      changed_.wait(lock, stop, [this] { return reload_ || window_due(); });
    }
  }
}

void SceneKeeper::wait_for_retired(const std::stop_token& stop, std::unique_lock<std::mutex>& lock) {
  const auto deadline = Clock::now() + kLongestFrame;
  while (retired_ && retired_.use_count() > 1 && Clock::now() < deadline && !stop.stop_requested())
    changed_.wait_for(lock, stop, kLook, [] { return false; });
  if (stop.stop_requested()) return;
  if (retired_ && retired_.use_count() > 1)
    log_warning("a frame of the scene before the last is not finished: for now there are three in memory");
  auto last = std::exchange(retired_, nullptr);
  lock.unlock();
  last.reset();
  lock.lock();
}

/// Why it could not be built; empty: here it is.
std::string SceneKeeper::build(const Request& request, const std::stop_token& stop,
                               std::shared_ptr<const Scene>& scene) {
  try {
    check_size(request.config, request.window);
    on_this_thread_alone([&] { scene = build_(aimed_at(request.config, request.window), stop); });
    return scene ? "" : "nothing was built";
  } catch (const std::exception& e) {
    return failure_text(e);
  }
}

void SceneKeeper::serve(Request request, const std::stop_token& stop, std::unique_lock<std::mutex>& lock) {
  state_.building = true;
  reload_in_hand_ = request.done != nullptr;
  superseded_ = false;
  build_stop_ = std::stop_source();
  const std::stop_callback also_at_the_end(stop, [source = build_stop_]() mutable { source.request_stop(); });
  const std::stop_token give_up = build_stop_.get_token();
  wait_for_retired(give_up, lock);
  const auto start = Clock::now();
  std::string error;
  std::shared_ptr<const Scene> scene;
  if (!superseded_) {
    lock.unlock();
    error = build(request, give_up, scene);
    lock.lock();
  }
  const bool superseded = superseded_;
  lock.unlock();
  if (superseded) {
    scene = nullptr;
    error = kSuperseded;
  } else if (scene) {
    swap_(scene);
  }
  const double build_s = seconds_since(start);
  std::optional<SourceExtents> extents;
  if (scene && request.done) extents = extents_of(request.config);
  lock.lock();
  state_.building = reload_in_hand_ = false;
  if (extents) extents_ = std::move(*extents);
  if (scene) {
    take(request, std::move(scene), build_s);
  } else if (!superseded && !stop.stop_requested()) {
    note_failure(request, error);
  }
  if (!request.done) return;
  lock.unlock();
  request.done(error);
  lock.lock();
}

/// It serves.
void SceneKeeper::take(Request& request, std::shared_ptr<const Scene> scene, double build_s) {
  note_well();
  ++state_.swaps;
  state_.last_build_s = build_s;
  state_.window = request.window;
  config_ = std::move(request.config);
  keep_cell(config_, *scene);
  retired_ = std::exchange(scene_, std::move(scene));
  pause_s_ = 0;
  not_before_ = {};
  log_info("{} serves, loaded in {:.1f} s; origin {:.4f}, {:.4f}",
           request.done ? "the reloaded scene" : "the next window of terrain", build_s,
           state_.window.origin.latitude_deg, state_.window.origin.longitude_deg);
}

void SceneKeeper::note_failure(const Request& request, const std::string& error) {
  ++state_.failures;
  state_.last_error = state_.last_failure = error;
  reload_failed_ = request.done != nullptr;
  if (request.done) {
    log_error("the reloaded scene cannot be loaded; still serving the previous one: {}", error);
    return;
  }
  pause_s_ = std::clamp(2 * pause_s_, kFirstPause_s, kLongestPause_s);
  not_before_ = now_() + from_seconds(pause_s_);
  log_error(
      "the next window of terrain cannot be loaded: {}; still serving the previous one, whose coverage says "
      "what is missing. Next attempt in {:.0f} s; terrain.dem must name elevation models around the radars",
      error, pause_s_);
}

}  // namespace obliq
