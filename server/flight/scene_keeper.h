#pragma once
// Builds scenes while the server serves another one: the next window of a flight, or a reloaded scene file.
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/flight/window.h"
#include "terrain/dem/source_extents.h"

namespace obliq {

class Scene;

/// One background thread of low priority builds one scene at a time and hands it over; of several requests
/// the newest wins, and work for an older one is given up or dropped. What cannot be loaded is
/// logged; the present scene stays. At most two scenes exist: a new one is begun when nothing
/// holds the one before the last any more.
class SceneKeeper {
 public:
  /// Loads what the configuration says. Runs on the keeper's thread; throws what is wrong. May give up, by
  /// throwing, once stop is requested.
  using Build = std::function<std::shared_ptr<const Scene>(const SceneConfig&, const std::stop_token&)>;
  /// Takes the new scene, from the keeper's thread: SceneRenderer::replace.
  using Swap = std::function<void(std::shared_ptr<const Scene>)>;
  /// Told once, on the keeper's thread, what became of a reload: empty when the new scene serves, else why
  /// the old one serves on.
  using Done = std::function<void(const std::string& error)>;

  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;

  /// `scene` serves now and was built from `config`; neither may be null nor empty. now: by which speed is
  /// measured and failures are paused after; called on any thread.
  SceneKeeper(SceneConfig config, std::shared_ptr<const Scene> scene, Build build, Swap swap,
              Now now = Clock::now);
  ~SceneKeeper();  // stops and joins; a running build is given up as soon as possible
  SceneKeeper(const SceneKeeper&) = delete;
  SceneKeeper& operator=(const SceneKeeper&) = delete;

  // From any thread:

  /// Loads another configuration, aimed at where the radars are now, and serves it when it is complete.
  void reload(SceneConfig config, Done done);
  /// Gives up a reload that does not serve yet.
  void give_up_reload();
  /// Where all radars are now, the first one first. Cheap: called with every pose.
  void poses_changed(std::vector<RadarPlace> radars);

  using State = KeeperState;
  State state() const;
  /// Whether an antenna there has ground to look at, now or once it is loaded. Fast.
  GroundThere ground_at(const LonLat& place, double r_max_m) const;

 private:
  struct Request {
    SceneConfig config;
    SceneWindow window;
    Done done;  ///< of a reload; null: a window of the flight
  };

  void run(const std::stop_token& stop);
  double lead_s() const;
  std::vector<RadarPlace> with_ground(const std::vector<RadarPlace>& places) const;
  std::optional<SceneWindow> window_wanted(Clock::time_point now) const;
  std::optional<SceneWindow> window_due() const;
  void note_well();
  std::optional<Request> next_request();
  void serve(Request request, const std::stop_token& stop, std::unique_lock<std::mutex>& lock);
  std::string build(const Request& request, const std::stop_token& stop, std::shared_ptr<const Scene>& scene);
  void take(Request& request, std::shared_ptr<const Scene> scene, double build_s);
  void wait_for_retired(const std::stop_token& stop, std::unique_lock<std::mutex>& lock);
  void note_failure(const Request& request, const std::string& error);

  const Build build_;
  const Swap swap_;
  const Now now_;

  mutable std::mutex mutex_;  ///< guards everything below but the thread
  std::condition_variable_any changed_;
  SceneConfig config_;
  std::shared_ptr<const Scene> scene_;    ///< that serves
  std::shared_ptr<const Scene> retired_;  ///< that served before, while frames still hold it
  std::vector<RadarPlace> radars_;        ///< empty: none heard of
  Speedometer speed_;
  SourceExtents extents_;  ///< of config_
  std::optional<Request> reload_;
  std::stop_source build_stop_;  ///< of the current build: a newer request has come, or the keeper stops
  bool reload_in_hand_ = false;
  bool superseded_ = false;     ///< the current build
  bool reload_failed_ = false;  ///< that is what state_.last_error is about
  Clock::time_point well_since_;
  State state_;
  double pause_s_ = 0;            ///< after the last failure
  Clock::time_point not_before_;  ///< no window is tried before, after a failure
  std::jthread thread_;
};

}  // namespace obliq
