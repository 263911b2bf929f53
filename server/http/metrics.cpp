#include "server/http/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <chrono>
#include <cmath>
#include <map>
#include <mutex>

#include "terrain/base/memory_limit.h"
#include "terrain/base/process.h"
#include "terrain/base/units.h"

namespace obliq::http {
namespace {

using prometheus::BuildCounter;
using prometheus::BuildGauge;
using prometheus::BuildHistogram;
using prometheus::ClientMetric;
using prometheus::Counter;
using prometheus::Gauge;
using prometheus::Histogram;
using prometheus::MetricFamily;
using prometheus::MetricType;

/// From a fast sweep (ms) to a large frame on a slow machine (a minute), about two buckets an octave where
/// frames usually are.
const std::vector<double> kSeconds = {0.001, 0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.05, 0.075, 0.1,
                                      0.15,  0.2,    0.3,   0.5,    0.75, 1,     2,    5,    10,   30,    60};

MetricFamily family(const std::string& name, const std::string& help, MetricType type) {
  MetricFamily made;
  made.name = name;
  made.help = help;
  made.type = type;
  return made;
}

ClientMetric sample(MetricType type, double value, const std::string& radar = "") {
  ClientMetric metric;
  if (!radar.empty()) metric.label.push_back({"radar", radar});
  (type == MetricType::Counter ? metric.counter.value : metric.gauge.value) = value;
  return metric;
}

/// Families of one value without a label.
struct Singles {
  template <class Number>
  void gauge(const std::string& name, const std::string& help, Number value) {
    add(family(name, help, MetricType::Gauge), static_cast<double>(value));
  }
  template <class Number>
  void counter(const std::string& name, const std::string& help, Number value) {
    add(family(name, help, MetricType::Counter), static_cast<double>(value));
  }
  void add(MetricFamily made, double value) {
    made.metric.push_back(sample(made.type, value));
    all.push_back(std::move(made));
  }

  std::vector<MetricFamily>& all;
};

MetricFamily per_radar(const std::string& name, const std::string& help,
                       const std::vector<net::RadarStatistics>& radars,
                       double (*value)(const net::RadarStatistics&), MetricType type = MetricType::Gauge) {
  MetricFamily made = family(name, help, type);
  for (const net::RadarStatistics& radar : radars)
    made.metric.push_back(sample(type, value(radar), radar.name));
  return made;
}

MetricFamily scene_memory_by_kind(const SceneMemory& memory) {
  MetricFamily made =
      family("obliq_scene_memory_bytes", "Memory of the scene in use, by content.", MetricType::Gauge);
  const auto kind = [&](const char* name, std::uint64_t bytes) {
    ClientMetric metric = sample(MetricType::Gauge, static_cast<double>(bytes));
    metric.label.push_back({"kind", name});
    made.metric.push_back(std::move(metric));
  };
  kind("heights", memory.heights);
  kind("surfaces", memory.surfaces);
  kind("buildings", memory.buildings);
  kind("index", memory.index);
  kind("embree", memory.tracer);
  return made;
}

/// What the room knows at the time of the question.
void append_room(const net::RoomStatistics& room, std::vector<MetricFamily>& all) {
  Singles singles{all};
  const auto radar = [&](const char* name, const char* help, double (*value)(const net::RadarStatistics&)) {
    all.push_back(per_radar(name, help, room.radars, value));
  };
  using Radar = net::RadarStatistics;
  singles.gauge("obliq_clients", "Clients connected to the stream.", room.clients);
  singles.counter("obliq_sent_bytes_total", "Bytes written to clients' sockets.", room.bytes_sent);
  singles.counter("obliq_frames_dropped_total",
                  "Frames not sent because clients were too slow, over all clients.", room.frames_dropped);
  singles.gauge("obliq_queue_messages", "Messages that wait to be written, over all clients.",
                room.queued_messages);
  singles.gauge("obliq_queue_bytes", "Bytes that wait to be written, over all clients.", room.queued_bytes);
  singles.gauge("obliq_renders_queued", "Unfinished RenderOnce requests.", room.renders_queued);
  radar("obliq_radar_watchers", "Clients that watch the radar.",
        [](const Radar& r) { return static_cast<double>(r.watchers); });
  radar("obliq_radar_wanted_rate_hertz", "Highest frame rate that a watcher of the radar asked for.",
        [](const Radar& r) { return r.rate_hz; });
  radar("obliq_radar_controlled", "1 while a client holds the radar's pose or settings.",
        [](const Radar& r) { return r.controlled ? 1.0 : 0.0; });
  radar("obliq_radar_faulty", "1 while the radar cannot be rendered with its settings.",
        [](const Radar& r) { return r.faulty ? 1.0 : 0.0; });
  radar("obliq_radar_live_frames",
        "Frames of the radar being rendered or waiting, in whole or in part, for a client.",
        [](const Radar& r) { return static_cast<double>(r.live_frames); });
  all.push_back(per_radar(
      "obliq_radar_frames_shed_total",
      "Frames of the radar skipped because rendering could not keep up with the requests.", room.radars,
      [](const Radar& r) { return static_cast<double>(r.frames_shed); }, MetricType::Counter));
  radar("obliq_radar_live_bytes", "Memory of the blocks of live frames.",
        [](const Radar& r) { return static_cast<double>(r.live_bytes); });
  radar("obliq_radar_spare_bytes", "Memory of blocks that were sent, kept for the next.",
        [](const Radar& r) { return static_cast<double>(r.spare_bytes); });
  radar("obliq_terrain_coverage_ratio", "Share of the radar's sector over known ground in its newest frame.",
        [](const Radar& r) { return r.coverage; });
}

/// Counters and histograms of one radar.
struct RadarMetrics {
  Counter& frames;
  Counter& rays;
  Counter& hits;
  Histogram& render_s;
  Histogram& first_wedge_s;
  Histogram& pose_to_end_s;
};

}  // namespace

struct Metrics::State {
  RadarMetrics& of(const std::string& radar) {
    const std::lock_guard lock(mutex);
    const auto at = radars.find(radar);
    if (at != radars.end()) return at->second;
    const prometheus::Labels labels{{"radar", radar}};
    return radars
        .emplace(radar, RadarMetrics{frames.Add(labels), rays.Add(labels), hits.Add(labels),
                                     render.Add(labels, kSeconds), first_wedge.Add(labels, kSeconds),
                                     pose_to_end.Add(labels, kSeconds)})
        .first->second;
  }

  prometheus::Registry registry;
  prometheus::Family<Counter>& counters(const std::string& name, const std::string& help) {
    return BuildCounter().Name(name).Help(help).Register(registry);
  }
  prometheus::Family<Histogram>& times(const std::string& name, const std::string& help) {
    return BuildHistogram().Name(name).Help(help).Register(registry);
  }

  prometheus::Family<Counter>& frames = counters("obliq_frames_total", "Live frames rendered completely.");
  prometheus::Family<Counter>& rays =
      counters("obliq_rays_total", "Rays of live frames; for the sweep, vertical planes marched.");
  prometheus::Family<Counter>& hits = counters(
      "obliq_hits_total", "Rays of live frames that hit; for the sweep, visible ground and wall segments.");
  prometheus::Family<Histogram>& render =
      times("obliq_frame_render_seconds", "Time from planning a live frame to its last block.");
  prometheus::Family<Histogram>& first_wedge =
      times("obliq_frame_first_wedge_seconds", "Time from planning a live frame to its first wedge.");
  prometheus::Family<Histogram>& pose_to_end =
      times("obliq_frame_pose_latency_seconds",
            "Time from the arrival of a pose to the last block of the first live frame that shows it.");
  Counter& once_frames =
      counters("obliq_once_frames_total", "Frames of RenderOnce requests rendered completely.").Add({});
  Counter& once_rays =
      counters("obliq_once_rays_total", "Rays of RenderOnce frames; for the sweep, vertical planes marched.")
          .Add({});
  Counter& once_hits =
      counters("obliq_once_hits_total",
               "Rays of RenderOnce frames that hit; for the sweep, visible ground and wall segments.")
          .Add({});
  Histogram& once_render_s =
      times("obliq_once_render_seconds",
            "Rendering time of a RenderOnce frame, its plan included, without the waits between its turns.")
          .Add({}, kSeconds);
  prometheus::Family<Counter>& log_lines = counters("obliq_log_lines_total", "Lines logged.");
  Gauge& scene_load_s = BuildGauge()
                            .Name("obliq_scene_load_seconds")
                            .Help("Time to load and build the scene in use.")
                            .Register(registry)
                            .Add({});
  std::map<std::string, Counter*> lines;  ///< by level; never changes once made
  double started_s = 0;                   ///< since 1970
  double memory_limit_bytes = 0;          ///< infinite: the system does not say

  std::mutex mutex;  ///< guards radars
  std::map<std::string, RadarMetrics> radars;
};

Metrics::Metrics(const BuildInfo& build) : state_(std::make_unique<State>()) {
  BuildGauge()
      .Name("obliq_build_info")
      .Help("Always 1; its labels name the versions that this program was built with.")
      .Register(state_->registry)
      .Add({{"version", build.version},
            {"compiler", build.compiler},
            {"embree", build.embree},
            {"gdal", build.gdal}})
      .Set(1);
  for (const char* level : {"debug", "info", "warning", "error"})
    state_->lines[level] = &state_->log_lines.Add({{"level", level}});
  const std::int64_t limit_bytes = memory_there_is_bytes();
  state_->memory_limit_bytes = limit_bytes > 0 ? static_cast<double>(limit_bytes) : INFINITY;
  state_->started_s = to_seconds(std::chrono::system_clock::now().time_since_epoch());
}

Metrics::~Metrics() = default;

void Metrics::add_radar(const std::string& radar) { (void)state_->of(radar); }

void Metrics::frame(const std::string& radar, const rendering::RenderedFrame& frame) {
  const RadarMetrics& metrics = state_->of(radar);
  metrics.frames.Increment();
  metrics.rays.Increment(static_cast<double>(frame.rays));
  metrics.hits.Increment(static_cast<double>(frame.hits));
  metrics.render_s.Observe(frame.render_s);
  metrics.first_wedge_s.Observe(frame.first_wedge_s);
  if (frame.pose_to_end_s >= 0) metrics.pose_to_end_s.Observe(frame.pose_to_end_s);
}

void Metrics::once_frame(const rendering::RenderedRequest& frame) {
  state_->once_frames.Increment();
  state_->once_rays.Increment(static_cast<double>(frame.rays));
  state_->once_hits.Increment(static_cast<double>(frame.hits));
  state_->once_render_s.Observe(frame.render_s);
}

void Metrics::scene_loaded(double load_s) { state_->scene_load_s.Set(load_s); }

void Metrics::log_line(const std::string& level) {
  const auto at = state_->lines.find(level);
  if (at != state_->lines.end()) at->second->Increment();
}

std::string Metrics::text(const net::RoomStatistics* room, const SceneStatistics& scene,
                          double certificate_end_s) const {
  if (scene.swaps > 0) state_->scene_load_s.Set(scene.last_build_s);
  std::vector<MetricFamily> all = state_->registry.Collect();
  if (room != nullptr) append_room(*room, all);
  Singles singles{all};
  singles.counter("obliq_scene_swaps_total",
                  "Scenes that replaced another: terrain windows of a flight, reloads.", scene.swaps);
  singles.counter("obliq_scene_failures_total",
                  "Scenes that could not be loaded; the server keeps using the old one.", scene.failures);
  singles.gauge("obliq_scene_building", "1 while the next scene is being built.", scene.building ? 1 : 0);
  if (scene.memory.total() > 0) all.push_back(scene_memory_by_kind(scene.memory));
  singles.gauge("process_resident_memory_bytes", "Memory in use.", resident_bytes());
  singles.gauge("process_resident_memory_peak_bytes", "Highest memory use so far, mostly while loading.",
                peak_resident_bytes());
  singles.gauge("obliq_memory_limit_bytes", "Memory that the process may have.", state_->memory_limit_bytes);
  singles.gauge("obliq_tls_certificate_end_time_seconds",
                "End of the TLS certificate in use, since 1970, UTC; +Inf without one.", certificate_end_s);
  singles.gauge("process_start_time_seconds", "Start time of the process, since 1970, UTC.",
                state_->started_s);
  return prometheus::TextSerializer().Serialize(all);
}

}  // namespace obliq::http
