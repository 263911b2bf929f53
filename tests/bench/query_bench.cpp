// What a ground query of 10,000 places costs one thread: only what is there, points on the ground, points
// over it, bearings and ranges. Processor time, the least of several.
//
//   query_bench [SCENE]     without: tests/bench/paper_hills.toml
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>

#include "server/control/scene_file.h"
#include "server/ground_query/ground_query.h"
#include "server/loading/scene_loading.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kRepeats = 9;
constexpr std::size_t kPoints = 10000;

double thread_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void measure(const char* name, const std::shared_ptr<const Scene>& scene, const GroundQuestion& question) {
  GroundAnswering answering;
  double least = HUGE_VAL, first = 0;
  GroundAnswers answers;
  for (int k = 0; k <= kRepeats; ++k) {
    const double start = thread_s();
    answers = answering.answer(scene, question);
    const double took = thread_s() - start;
    if (k == 0) {
      first = took;
    } else {
      least = std::min(least, took);
    }
  }
  const auto share = [&](auto&& is) {
    return 100.0 * static_cast<double>(std::ranges::count_if(answers.records, is)) / kPoints;
  };
  std::printf("%-28s %7.2f ms (the first of a scene %7.2f), %5.1f %% on known ground, %5.1f %% seen\n", name,
              1e3 * least, 1e3 * first,
              share([](const wire::GroundRecord& r) { return r.state == wire::GroundState::known; }),
              share([](const wire::GroundRecord& r) {
                return r.sight == wire::Sight::visible || r.sight == wire::Sight::visible_over_unknown;
              }));
}

void run(const std::string& file) {
  SceneConfig config = load_scene_file(file);
  config.world.terrain.cache_folder.clear();
  const auto scene =
      std::make_shared<const Scene>(std::make_shared<World>(load_world(config.world)), config.materials, 0);
  const RadarConfig& radar = config.radars.front();
  std::printf("%s: %d x %d posts every %g m, %zu buildings; 10,000 places of the sector within %g m\n",
              file.c_str(), scene->world().grid.nx, scene->world().grid.nz, scene->world().grid.cell_m,
              scene->world().buildings.list.size(), radar.settings.r_max_m);
  const auto dice = [](std::size_t k, int which) {
    return unit_from_hash(mix64(k * 4 + static_cast<std::size_t>(which) + 1));
  };
  GroundQuestion places, ranges;
  const double degree_m = 111200;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double bearing_deg = radar.pose.bearing_deg + radar.settings.sector_deg * (dice(k, 0) - 0.5);
    const double range_m = 0.98 * radar.settings.r_max_m * std::sqrt(0.01 + 0.99 * dice(k, 1));
    ranges.bearing_deg.push_back(bearing_deg);
    ranges.range_m.push_back(range_m);
    places.latitude_deg.push_back(radar.pose.latitude_deg +
                                  range_m * std::cos(bearing_deg * kDegree_rad) / degree_m);
    places.longitude_deg.push_back(radar.pose.longitude_deg +
                                   range_m * std::sin(bearing_deg * kDegree_rad) / degree_m /
                                       std::cos(radar.pose.latitude_deg * kDegree_rad));
  }
  measure("what is there", scene, places);
  places.antenna = ranges.antenna = radar.pose;
  measure("points on the ground", scene, places);
  measure("by bearing and range", scene, ranges);
  places.height_m = {50};
  places.height_reference = HeightReference::ground;
  measure("points 50 m over it", scene, places);
  // Where the ground is known; a radar may stand on the terrain's edge.
  places.antenna->latitude_deg += 0.01;
  places.antenna->height_reference = HeightReference::ground;
  places.antenna->height_m = 30;
  std::vector<FieldError> errors;
  if (place_antenna(scene->world(), *places.antenna, errors)) measure("the same from 30 m up", scene, places);
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  try {
    obliq::run(argc > 1 ? argv[1] : std::string(OBLIQ_SOURCE_DIR) + "/tests/bench/paper_hills.toml");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "query_bench: %s\n", error.what());
    return 1;
  }
}
