#pragma once
// The operator's side of the room, for control systems that are no clients of the stream (server/modbus).
// Callers have threads of their own: changes are made on the io thread, status is a snapshot.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/control/parameters.h"
#include "server/net/requests/request_limits.h"
#include "terrain/base/errors.h"

namespace obliq::net {

class Room;
struct LiveRadar;
struct RoomStatistics;

/// A radar as it was when the io thread last looked.
struct PanelStatus {
  RadarConfig config;  ///< name, settings and pose as set; a frozen radar shows an older picture
  std::uint64_t settings_version = 0;
  double rate_limit_hz = 0;  ///< 0: none
  bool transmit = true;
  bool frozen = false;
  bool exercise_frozen = false;  ///< all radars are
  bool pose_stale = false;
  bool at_gimbal_limit = false;
  std::string controller;           ///< the client that holds its pose; empty: none
  std::string settings_controller;  ///< and its settings
  std::vector<FieldError> faults;   ///< why it cannot be rendered as it is
  std::uint32_t clients = 0;        ///< of the server
  std::uint32_t watchers = 0;       ///< of this radar
  double rate_hz = 0;               ///< frames rendered per second, over the last second or so
  std::uint64_t frames = 0;         ///< rendered since start
  double frame_time_s = 0;          ///< of the newest frame, plan to last wedge
  std::uint64_t rays = 0;           ///< of the newest frame
  std::uint64_t hits = 0;           ///< of the newest frame
  double coverage = 0;              ///< part of the newest frame's sector and range with known ground, 0 to 1
  std::uint64_t frames_dropped = 0;  ///< of the server: frames that clients were too slow for
  double uptime_s = 0;
  std::uint64_t heartbeat = 0;  ///< counts snapshots: it stands still when the io thread does
};

/// One change, done as a whole or not at all.
struct PanelChange {
  struct Setting {
    const Parameter* parameter;
    Value value;
  };
  std::vector<Setting> settings;
  /// beam.file, which no message carries; null: none any more.
  std::optional<std::shared_ptr<const PatternCuts>> pattern_file;
  std::optional<double> rate_limit_hz;  ///< 0: none
  std::optional<bool> transmit;
  std::optional<bool> freeze;
  bool clear_faults = false;
  bool reset = false;                   ///< to the scene file's settings, pose and switches
  std::optional<bool> exercise_freeze;  ///< of all radars
};

enum class PanelVerdict {
  done,
  invalid,     ///< values refused: the errors say which
  controlled,  ///< a client holds what the change takes: pose, or settings, rate and aim
  no_answer    ///< the io thread did not get to it in time; nothing was or will be changed
};

struct PanelAnswer {
  PanelVerdict verdict = PanelVerdict::no_answer;
  std::vector<FieldError> errors;
  std::optional<OverLimit> over;  ///< of invalid: what limit of the server it exceeds, if any
  std::string held;               ///< of controlled: what, and by which client
};

/// transmit off: the radar is not rendered and its watchers get no frames. freeze: frames go on, of the
/// settings and the pose that it was frozen with; what is set meanwhile is checked, kept, and shown from the
/// thaw on.
class Panel {
 public:
  using Post = std::function<void(std::function<void()>)>;

  Panel(Room& room, Post post);

  // From any thread:
  const std::vector<std::string>& names() const { return names_; }
  std::size_t radars() const { return names_.size(); }
  std::shared_ptr<const PanelStatus> status(std::size_t radar) const;
  /// Asks the io thread for new snapshots; returns at once. Snapshots are also made after every change.
  void refresh();
  /// Waits for the answer, at most so long (a change that has been begun is waited for).
  PanelAnswer change(std::size_t radar, PanelChange change, std::chrono::milliseconds deadline);
  /// Does not wait.
  void command(std::size_t radar, PanelChange change);

  // On the io thread, of a radar of names():
  /// What a reset brings back, from now on: another scene file has been read.
  void set_initial(const std::string& radar, const RadarConfig& config);
  /// At once.
  PanelAnswer apply(const std::string& radar, const PanelChange& change);

 private:
  using Clock = std::chrono::steady_clock;
  struct Pace {  ///< of a radar's frames
    Clock::time_point since = Clock::now();
    std::uint64_t frames = 0;
    double rate_hz = 0;
  };

  // On the io thread:
  PanelAnswer perform(std::size_t radar, const PanelChange& change);
  PanelAnswer set(LiveRadar& radar, const PanelChange& change);
  void publish();
  PanelStatus look(std::size_t radar, const RoomStatistics& all);

  Room& room_;
  Post post_;
  std::vector<std::string> names_;
  std::vector<Pace> paces_;
  std::uint64_t heartbeat_ = 0;
  std::atomic<bool> refreshing_ = false;

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const PanelStatus>> statuses_;  ///< guarded by mutex_
};

}  // namespace obliq::net
