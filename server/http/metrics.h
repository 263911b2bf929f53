#pragma once
#include <memory>
#include <string>

#include "server/net/options.h"
#include "server/rendering/rendered.h"
#include "server/scene/scene_memory.h"

namespace obliq::http {

/// What this program was built from, shown as labels of obliq_build_info.
struct BuildInfo {
  std::string version;
  std::string compiler;
  std::string embree;
  std::string gdal;
};

/// What became of scenes that were to replace the first one.
struct SceneStatistics {
  std::uint64_t swaps = 0;
  std::uint64_t failures = 0;
  bool building = false;
  double last_build_s = 0;  ///< of the newest swap
  SceneMemory memory;       ///< of the scene that serves
};

/// What the daemon counts, in Prometheus' terms; METRICS.md lists it. From any thread.
class Metrics {
 public:
  explicit Metrics(const BuildInfo& build);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// A live radar, whose counters stand at 0 from now on.
  void add_radar(const std::string& radar);
  void frame(const std::string& radar, const rendering::RenderedFrame& frame);
  void once_frame(const rendering::RenderedRequest& frame);
  /// The first scene is in place after so many seconds.
  void scene_loaded(double load_s);
  /// A line was logged at "debug", "info", "warning" or "error".
  void log_line(const std::string& level);

  /// Everything, in Prometheus' text format; `room` is null before clients are served. certificate_end_s:
  /// since 1970, infinite without a certificate.
  std::string text(const net::RoomStatistics* room, const SceneStatistics& scene,
                   double certificate_end_s) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::http
