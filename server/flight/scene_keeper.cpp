#include "server/flight/scene_keeper.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "server/flight/background.h"
#include "server/scene/scene.h"
#include "terrain/errors.h"
#include "terrain/failure_text.h"
#include "terrain/parallel.h"

namespace obliq {
namespace {

using Seconds = std::chrono::duration<double>;

/// How often it is looked whether the last frame of a scene has ended.
constexpr std::chrono::milliseconds kLook{50};
/// A frame that nobody takes may not hold up a flight: after this long there may be a third scene.
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
      "flight.max_megaposts", "terrain of " + std::to_string(megaposts) + " million posts around the radars",
      "at most " + std::to_string(config.flight.max_megaposts) +
          " million, so raise it, make terrain.cell_m larger, or keep the radars closer "
          "together"}
                       .text());
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
    changed_.notify_all();
  }
  if (replaced) replaced->done(kSuperseded);
}

void SceneKeeper::poses_changed(std::vector<RadarPlace> radars) {
  const std::lock_guard lock(mutex_);
  radars_ = std::move(radars);
  speed_.note(radars_, now_());
  if (!state_.building && window_due()) changed_.notify_all();
}

SceneKeeper::State SceneKeeper::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

double SceneKeeper::lead_s() const { return kLeastLead_s + 2 * state_.last_build_s; }

std::optional<SceneWindow> SceneKeeper::window_due() const {
  const auto now = now_();
  if (now < not_before_) return std::nullopt;
  const auto ahead = speed_.ahead(radars_, lead_s(), now);
  if (!needs_next_window(config_, state_.window, radars_, ahead)) return std::nullopt;
  SceneWindow next = next_window(config_, state_.window, radars_, ahead);
  if (is_same(next, state_.window)) return std::nullopt;  // built again it would be no better
  return next;
}

std::optional<SceneKeeper::Request> SceneKeeper::next_request() {
  if (reload_) {
    std::optional<Request> request = std::exchange(reload_, std::nullopt);
    // The new file's window, unless the radars have been moved since the start.
    request->window = window_of(request->config);
    if (!radars_.empty() && request->config.flight.enabled)
      request->window = next_window(request->config, request->window, radars_, radars_);
    return request;
  }
  auto window = window_due();
  if (!window) return std::nullopt;
  return Request{config_, std::move(*window), nullptr};
}

void SceneKeeper::run(const std::stop_token& stop) {
  if (!lower_own_priority()) spdlog::warn("terrain is loaded at the same priority as frames are rendered");
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
  if (retired_ && retired_.use_count() > 1 && !stop.stop_requested())
    spdlog::warn("a frame of the scene before the last is not finished: for now there are three in memory");
  auto last = std::exchange(retired_, nullptr);
  lock.unlock();
  last.reset();
  lock.lock();
}

void SceneKeeper::serve(Request request, const std::stop_token& stop, std::unique_lock<std::mutex>& lock) {
  state_.building = true;
  wait_for_retired(stop, lock);
  if (request.done && reload_) {  // a newer one came meanwhile
    state_.building = false;
    lock.unlock();
    request.done(kSuperseded);
    lock.lock();
    return;
  }
  lock.unlock();
  const auto start = Clock::now();
  std::string error;
  std::shared_ptr<const Scene> scene;
  try {
    check_size(request.config, request.window);
    on_this_thread_alone([&] { scene = build_(aimed_at(request.config, request.window), stop); });
    if (!scene) error = "nothing was built";
  } catch (const std::exception& e) {
    error = failure_text(e);
  }
  if (scene) swap_(scene);
  const double build_s = Seconds(Clock::now() - start).count();
  lock.lock();
  state_.building = false;
  state_.last_error = error;
  if (scene) {
    ++state_.swaps;
    state_.last_build_s = build_s;
    state_.window = request.window;
    config_ = std::move(request.config);
    keep_cell(config_, *scene);
    retired_ = std::exchange(scene_, std::move(scene));
    pause_s_ = 0;
    not_before_ = {};
    spdlog::info("{} serves, loaded in {:.1f} s; origin {:.4f}, {:.4f}",
                 request.done ? "the reloaded scene" : "the next window of terrain", build_s,
                 state_.window.origin.latitude_deg, state_.window.origin.longitude_deg);
  } else if (!stop.stop_requested()) {
    note_failure(request, error);
  }
  if (!request.done) return;
  lock.unlock();
  request.done(error);
  lock.lock();
}

void SceneKeeper::note_failure(const Request& request, const std::string& error) {
  ++state_.failures;
  if (request.done) {
    spdlog::error("the reloaded scene cannot be loaded, the old one serves on: {}", error);
    return;
  }
  pause_s_ = std::clamp(2 * pause_s_, kFirstPause_s, kLongestPause_s);
  not_before_ = now_() + std::chrono::duration_cast<Clock::duration>(Seconds(pause_s_));
  spdlog::error(
      "the next window of terrain cannot be loaded: {}; the old one serves on, its coverage says what is "
      "missing. Tried again in {:.0f} s; terrain.dem has to name elevation models of where the radars are",
      error, pause_s_);
}

}  // namespace obliq
