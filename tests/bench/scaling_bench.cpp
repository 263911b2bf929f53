// How frame time grows: rays, posts, buildings, bins, threads and range one after the other, each over two
// decades, everything else as in the paper's setting over seeded hills. And what the machine could do at
// best: bytes a second from memory, floating point operations a second, beside what a march needs of them.
//   scaling_bench OUT.json [--only AXIS] [--repeats N]
// deploy/plots/scaling.py draws it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "server/radar/profile/ground_walk.h"
#include "server/radar/render.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// The paper's setting; every axis changes one of these.
struct Setup {
  double range_m = 37000;
  double cell_m = 30;
  double buildings = 0;  ///< in the swath
  int bins = 1024;       ///< azimuth and range
  int pixels = 2048;     ///< columns and rows; of the sweep: planes
  int threads = 2;
};

/// Buildings: with more, Embree's tree takes longer than everything else, and the sweep alone is measured.
constexpr double kMostForRays = 1e5;

double swath_km2(const Setup& setup) {
  return 0.99 * std::numbers::pi / 3 * setup.range_m * setup.range_m / 1e6;  // 120 degrees from range / 10
}

std::shared_ptr<const Scene> scene_of(const Setup& setup) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 1.05 * setup.range_m, setup.cell_m);
  spec.terrain.shape.height_m = 0.0216 * setup.range_m;
  if (setup.buildings > 0) {
    PrismSpec prisms;
    prisms.per_km2 = setup.buildings / swath_km2(setup);
    prisms.height_m = {4, 20};
    spec.prisms.push_back(prisms);
  }
  auto scene = test::make_scene(load_world(spec));
  if (setup.buildings <= kMostForRays && needs_tracer(*scene, FrustumKind::oblique))
    scene->tracer();  // not while a frame is timed
  return scene;
}

std::shared_ptr<const FramePlan> plan_of(const std::shared_ptr<const Scene>& scene, const Setup& setup,
                                         FrustumKind frustum) {
  RadarSettings settings;
  settings.r_min_m = setup.range_m / 10;
  settings.r_max_m = setup.range_m;
  settings.azimuth_bins = settings.range_bins = setup.bins;
  settings.pixel_columns = settings.pixel_rows = setup.pixels;
  settings.frustum = frustum;
  settings.plates = PlateKind::nearest;
  // Above the hills, and no higher than r_min.
  const Pose pose = test::pose_over_origin(scene->world(), 0.08 * setup.range_m);
  const PlanResult planned = plan_frame(scene, test::snapshot(settings), pose);
  if (!planned.plan) throw std::runtime_error(all_text(planned.errors));
  return planned.plan;
}

double seconds(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double least_seconds(int repeats, const std::function<void()>& work) {
  double least = HUGE_VAL;
  for (int n = 0; n < repeats; ++n) least = std::min(least, seconds(work));
  return least;
}

double frame_s(const FramePlan& plan, int threads, int repeats) {
  RenderOptions options;
  options.threads = threads;
  options.on_wedge = [](Wedge&&) {};
  return least_seconds(repeats, [&] { render_wedges(plan, {0, plan.settings().azimuth_bins}, options); });
}

struct Axis {
  std::string name;
  std::string label;
  std::vector<double> values;
  bool new_scene;
  std::function<void(Setup&, double)> set;
};

std::vector<Axis> axes() {
  return {
      {"rays",
       "rays; of the sweep: planes, squared",
       {41e3, 130e3, 410e3, 1.3e6, 4.2e6},
       false,
       [](Setup& s, double rays) { s.pixels = static_cast<int>(std::lround(std::sqrt(rays))); }},
      {"bins",
       "bins",
       {16384, 65536, 262144, 1048576, 4194304},
       false,
       [](Setup& s, double bins) { s.bins = static_cast<int>(std::lround(std::sqrt(bins))); }},
      {"threads",
       "threads",
       {1, 2, 4, 16, 100},
       false,
       [](Setup& s, double threads) { s.threads = static_cast<int>(threads); }},
      {"posts",
       "posts in a square around the swath",
       {6e4, 2e5, 6.7e5, 2e6, 6.7e6, 2e7},
       true,
       [](Setup& s, double posts) { s.cell_m = std::round(32 * 2.1 * s.range_m / std::sqrt(posts)) / 32; }},
      {"buildings",
       "buildings in the swath",
       {1e3, 3e3, 1e4, 3e4, kMostForRays, 3e5, 1e6},
       true,
       [](Setup& s, double buildings) { s.buildings = buildings; }},
      {"range",
       "range, km",
       {1.11, 3.7, 11.1, 37, 111},
       true,
       [](Setup& s, double km) { s.range_m = 1000 * km; }},
  };
}

Json measure(const Axis& axis, int repeats, std::shared_ptr<const Scene>& common) {
  Json points = Json::array();
  for (const double value : axis.values) {
    Setup setup;
    axis.set(setup, value);
    std::shared_ptr<const Scene> scene = common;
    if (axis.new_scene || !scene) scene = scene_of(setup);
    if (!axis.new_scene) common = scene;
    Json point{{"at", value}};
    std::printf("%-10s %10.4g", axis.name.c_str(), value);
    for (const auto& [name, kind] :
         {std::pair{"oblique", FrustumKind::oblique}, std::pair{"sweep", FrustumKind::sweep}}) {
      if (kind != FrustumKind::sweep && setup.buildings > kMostForRays) continue;
      Setup sampled = setup;
      // Two planes a bin unless planes are what is looked at.
      if (kind == FrustumKind::sweep && axis.name != "rays") sampled.pixels = 2 * setup.bins;
      const auto plan = plan_of(scene, sampled, kind);
      const double s = frame_s(*plan, setup.threads, repeats);
      point[name] = s;
      std::printf("  %s %9.2f ms", name, 1000 * s);
    }
    std::printf("\n");
    std::fflush(stdout);
    points.push_back(point);
  }
  return {{"label", axis.label}, {"points", points}};
}

/// Eight doubles: one vector register of the widest set.
using Eight = double __attribute__((vector_size(64)));

/// A sum that reads `n` doubles, n a multiple of 32.
__attribute__((target_clones("avx512f", "avx2", "default"))) double sum_of(const double* from,
                                                                           std::size_t n) {
  Eight sum[4] = {};
  for (std::size_t k = 0; k < n; k += 32)
    for (std::size_t part = 0; part < 4; ++part) {
      Eight eight;
      __builtin_memcpy(&eight, from + k + 8 * part, sizeof eight);
      sum[part] += eight;
    }
  const Eight all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  double total = 0;
  for (int lane = 0; lane < 8; ++lane) total += all[lane];
  return total;
}

/// rounds x 192 multiplications and additions that do not wait for each other.
__attribute__((target_clones("avx512f", "avx2", "default"))) double flops_of(std::int64_t rounds,
                                                                             double seed) {
  Eight x[12];
  for (int k = 0; k < 12; ++k) x[k] = Eight{} + (seed + k);
  for (std::int64_t round = 0; round < rounds; ++round)
    for (Eight& at : x) at = at * 0.999999 + 1e-7;
  double total = 0;
  for (const Eight& at : x) total += at[0];
  return total;
}

void on_threads(int threads, const std::function<void(int)>& work) {
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back([&work, t] { work(t); });
  work(0);
}

volatile double kept = 0;  // so that results are needed

constexpr int kThreads = 2;

/// One thread's share of planes over bare ground, below a horizon that hides everything: they go through all
/// cells and note nothing.
void march_hidden(const HeightGrid& grid, const glm::dvec3& antenna_m, double range_m,
                  const std::vector<SinCos>& bearings, int thread) {
  constexpr auto kPlanes = static_cast<std::size_t>(SightProfiles::kLanes);
  constexpr double kWidth_rad = 1, kTo_m = HUGE_VAL;
  const GroundView ground = ground_view(grid, antenna_m);
  const auto segments = std::make_unique<VisibleSegments>();
  for (std::size_t k = kPlanes * static_cast<std::size_t>(thread); k < bearings.size();
       k += kPlanes * kThreads) {
    SightProfiles planes{};
    planes.last_start_m = range_m;
    for (std::size_t lane = 0; lane < kPlanes; ++lane) {
      planes.end_m[lane] = -1;
      if (k + lane >= bearings.size()) continue;
      set_out(planes, lane, bearings[k + lane], grid, antenna_m, {&kWidth_rad, &kTo_m});
      planes.horizon_d_m[lane] = 1;
      planes.horizon_h_m[lane] = 1e9;
    }
    do {
      segments->n = 0;
    } while (active_kernels().visible_ground(ground, planes, *segments));
  }
}

/// What the machine does at best, on two threads, and what a march over bare ground needs of it.
Json limits(int repeats) {
  constexpr std::size_t kDoubles = std::size_t{32} << 20;  // 256 MiB a thread
  std::vector<std::vector<double>> memory(kThreads, std::vector<double>(kDoubles, 1.0));
  const double read_s = least_seconds(repeats, [&] {
    on_threads(kThreads, [&](int t) { kept = sum_of(memory[static_cast<std::size_t>(t)].data(), kDoubles); });
  });
  const double read_bytes_s = kThreads * kDoubles * sizeof(double) / read_s;
  constexpr std::int64_t kRounds = 2'000'000;
  const double flop_s = kThreads * kRounds * 192.0 / least_seconds(repeats, [&] {
                          on_threads(kThreads, [](int t) { kept = flops_of(kRounds, t); });
                        });
  Json report{{"read_bytes_per_s", read_bytes_s}, {"flop_per_s", flop_s}};
  std::printf("memory %.1f GB/s, %.1f Gflop/s (multiply and add, two threads)\n", read_bytes_s / 1e9,
              flop_s / 1e9);

  for (const double cell_m : {30.0, 10.0}) {
    Setup setup;
    setup.cell_m = cell_m;
    const auto scene = scene_of(setup);
    const auto plan = plan_of(scene, setup, FrustumKind::sweep);
    const Sector& sector = plan->sector();
    const HeightGrid& grid = scene->world().grid;
    std::vector<SinCos> bearings;
    for (int column = 0; column < setup.pixels; ++column) {
      const double offset = plan->bins().azimuth_start_rad + (column + 0.5) * sector.width_rad / setup.pixels;
      bearings.push_back(sincos_turns((sector.bearing_rad + offset) / (2 * std::numbers::pi)));
    }
    const double march_s = least_seconds(repeats, [&] {
      on_threads(kThreads, [&](int t) { march_hidden(grid, sector.antenna_m, setup.range_m, bearings, t); });
    });
    struct Count {
      std::int64_t cells = 0;
      void ground(const GroundSegment&) {}
      void gap(double, double) {}
      bool enough() {
        ++cells;
        return false;
      }
    } count;
    for (const SinCos& b : bearings) {
      GroundWalk walk(grid, sector.antenna_m, b.sin, b.cos, 0, setup.range_m);
      walk.advance(setup.range_m, count);
    }
    // The heights under the swath, row by row: what the march must at least read.
    const double touched_bytes = sizeof(float) * std::numbers::pi / 3 * std::pow(setup.range_m / cell_m, 2);
    const double touch_s = touched_bytes / read_bytes_s;
    // Counted in ground_cells.h and refine_hits.cpp (server/radar/simd): 30 for a cell and 30 for each of its
    // 1.5 triangles.
    constexpr double kFlopsACell = 75;
    const auto cells = static_cast<double>(count.cells);
    std::printf(
        "cells of %.0f m: %d planes, %.1f M cells in %.1f ms: %.2f ns a cell; %.1f bytes and about %.0f "
        "flops a "
        "cell are %.1f %% of the memory's rate and %.1f %% of the processors'; the heights alone come from "
        "memory in "
        "%.2f ms: the march takes %.1f times that\n",
        cell_m, setup.pixels, cells / 1e6, 1000 * march_s, 1e9 * march_s / cells, touched_bytes / cells,
        kFlopsACell, 100 * touched_bytes / march_s / read_bytes_s,
        100 * kFlopsACell * cells / march_s / flop_s, 1000 * touch_s, march_s / touch_s);
    std::fflush(stdout);
    report["march"].push_back({{"cell_m", cell_m},
                               {"planes", setup.pixels},
                               {"cells", cells},
                               {"march_s", march_s},
                               {"heights_read_s", touch_s},
                               {"bytes_per_cell", touched_bytes / cells},
                               {"flops_per_cell", kFlopsACell}});
  }
  return report;
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  CLI::App app("How frame time grows with rays, posts, buildings, bins, threads and range", "scaling_bench");
  std::string out;
  std::string only;
  int repeats = 5;
  app.add_option("OUT", out, "File for the figures, as JSON")->required();
  app.add_option("--only", only, "One of rays, bins, threads, posts, buildings, range, limits");
  app.add_option("--repeats", repeats, "The least of so many")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::Json report;
    std::shared_ptr<const obliq::Scene> common;
    for (const obliq::Axis& axis : obliq::axes())
      if (only.empty() || only == axis.name)
        report["axes"][axis.name] = obliq::measure(axis, repeats, common);
    if (only.empty() || only == "limits") report["limits"] = obliq::limits(repeats);
    if (report.empty()) throw std::runtime_error("--only: found \"" + only + "\"; allowed: see --help");
    obliq::write_text(out, report.dump(2) + "\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scaling_bench: %s\n", error.what());
    return 1;
  }
}
