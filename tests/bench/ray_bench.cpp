// What a frame costs beyond its rays: ray_bench SCENE.toml [--set KEY=VALUE] [--json FILE] renders the
// scene's frame and traces the same rays alone, each by a march and by Embree (run.rays), in turn, and prints
// them with their ratios. With --peer FOLDER it leaves the rays and what they meet there and then traces them
// once for each line that it reads: peers.py has other ray tracers do the same, in turn.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "server/control/scene_file.h"
#include "server/loading/scene_loading.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/first_hits.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "terrain/base/errors.h"
#include "terrain/buildings/building_mesh.h"
#include "tests/support/refine_hit.h"
#include "tests/support/scene_mesh.h"

namespace obliq {
namespace {

constexpr double kAllowedOverhead = 1.35;  // frame over bare trace

struct Arguments {
  std::string scene;
  std::string peer;
  std::string json;
  bool march = false;
  LoadOptions options;
  int threads = 2;
  int repeats = 15;
};

/// All rays of a frame, in the order and the batches in which the frame traces them.
struct Rays {
  struct WedgeRays {
    AzimuthRange range;
    std::size_t first, end;  // of its batches
  };
  std::vector<std::unique_ptr<RayBatch>> batches;
  std::vector<WedgeRays> wedges;
  std::size_t n = 0;

  explicit Rays(const FramePlan& plan) {
    const int n_azimuth = plan.settings().azimuth_bins;
    for (int first = 0; first < n_azimuth; first += kWedgeAzimuthBins) {
      const AzimuthRange range{first, std::min(kWedgeAzimuthBins, n_azimuth - first)};
      const std::size_t begin = batches.size();
      const auto source = make_ray_source(plan.looks_at(), range);
      for (auto batch = std::make_unique<RayBatch>(); source->generate(*batch);
           batch = std::make_unique<RayBatch>()) {
        n += static_cast<std::size_t>(batch->n);
        batches.push_back(std::move(batch));
      }
      wedges.push_back({range, begin, batches.size()});
    }
  }
};

struct Spent {
  double wall_ms;
  double cpu_ms;  // of all threads: what others do on the machine moves it less
};

Spent spent(const std::function<void()>& work) {
  const std::clock_t cpu = std::clock();
  const auto start = std::chrono::steady_clock::now();
  work();
  const double wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return {wall_ms, 1000.0 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
}

/// work(k) for k in [0, n), on so many threads.
template <typename Work>
void share_out(std::size_t n, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t k = next++; k < n; k = next++) work(k);
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(run);
  run();
}

using Hits = std::array<RoughHit, kBatch>;

/// The same frame in scenes of the same world with both methods.
struct Plans {
  std::shared_ptr<const FramePlan> march;
  std::shared_ptr<const FramePlan> embree;
};

/// Bare trace by Embree, of batches of rays in any order; take(batch, hits) on the tracing thread.
template <typename Take>
void trace(const FramePlan& plan, const Rays& rays, int threads, const Take& take) {
  share_out(rays.batches.size(), threads, [&](std::size_t k) {
    const RayBatch& batch = *rays.batches[k];
    Hits hits;
    plan.scene().tracer().trace(plan.sector().antenna_m, batch.dir_x.data(), batch.dir_y.data(),
                                batch.dir_z.data(), batch.n, hits.data(), batch.packet_order.data());
    take(k, hits);
  });
}

/// The same by a march.
template <typename Take>
void march(const FramePlan& plan, const Rays& rays, int threads, const Take& take) {
  share_out(rays.wedges.size(), threads, [&](std::size_t wedge) {
    FirstHits tracer(plan.looks_at(), rays.wedges[wedge].range);
    Hits hits;
    for (std::size_t k = rays.wedges[wedge].first; k < rays.wedges[wedge].end; ++k) {
      tracer.trace(*rays.batches[k], hits.data());
      take(k, hits);
    }
  });
}

void forget(std::size_t, const Hits&) {}

void whole_frame(const FramePlan& plan, int threads) {
  RenderOptions options;
  options.threads = threads;
  options.on_wedge = [](Wedge&&) {};
  render_wedges(plan, {0, plan.settings().azimuth_bins}, options);
}

/// Triangles numbered in the order of scene_mesh.h.
class MeshNumbers {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  explicit MeshNumbers(const World& world) : world_(world) {
    const HeightGrid& grid = world.grid;
    of_cell_.assign(grid.y_m.size(), kNone);
    for (int j = 0; j + 1 < grid.nz; ++j)
      for (int i = 0; i + 1 < grid.nx; ++i)
        if (grid.cell_known(i, j)) of_cell_[grid.index(i, j)] = 2 * known_cells_++;
    const BuildingMesh mesh = mesh_of(world.buildings);
    first_of_face_.resize(world.buildings.building_of_face.size());
    for (std::uint32_t t = static_cast<std::uint32_t>(mesh.triangles.size()); t-- > 0;)
      first_of_face_[mesh.triangle_face[t]] = t;
  }

  std::uint32_t triangle(const glm::dvec3& antenna_m, const glm::dvec3& direction,
                         const RoughHit& hit) const {
    const HeightGrid& grid = world_.grid;
    if (hit.kind == RoughHit::Kind::none) return kNone;
    if (hit.kind == RoughHit::Kind::building)
      return 2 * known_cells_ + first_of_face_[hit.face] + hit.triangle;
    const auto exact = test::refine_hit(world_, antenna_m, direction, hit);
    if (!exact) return kNone;
    const double u = (exact->position_m.x - grid.x0_m) / grid.cell_m;
    const double v = (exact->position_m.z - grid.z0_m) / grid.cell_m;
    const int i = std::clamp(static_cast<int>(u), 0, grid.nx - 2);
    const int j = std::clamp(static_cast<int>(v), 0, grid.nz - 2);
    return of_cell_[grid.index(i, j)] + (u - i + (v - j) > 1 ? 1u : 0u);
  }

 private:
  const World& world_;
  std::vector<std::uint32_t> of_cell_;  // [nx * nz], its first triangle
  std::vector<std::uint32_t> first_of_face_;
  std::uint32_t known_cells_ = 0;
};

template <typename Value>
void write_values(const std::string& path, const std::vector<Value>& values) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(Value)));
  file.close();
  if (!file) throw InputError(path + ": cannot be written");
}

/// What all rays meet: range.f32: [n], infinite for none; triangle.u32: [n]. Our own rays.f32 beside it:
/// [n][6] origin and direction, and mesh.ply, the scene's triangles. With --march the first two, named march.
void leave_rays(const Plans& plans, const Rays& rays, const Arguments& arguments) {
  const FramePlan& plan = *plans.embree;
  const glm::vec3 origin(plan.sector().antenna_m);
  std::vector<std::size_t> first{0};
  for (const auto& batch : rays.batches) first.push_back(first.back() + static_cast<std::size_t>(batch->n));
  std::vector<float> ray(6 * rays.n);
  std::vector<float> range(rays.n);
  std::vector<std::uint32_t> triangle(rays.n);
  const MeshNumbers numbers(plan.scene().world());
  const auto take = [&](std::size_t b, const Hits& hits) {
    const RayBatch& batch = *rays.batches[b];
    for (std::size_t packed = 0; packed < static_cast<std::size_t>(batch.n); ++packed) {
      const std::size_t k = batch.packet_order[packed];
      const glm::dvec3 direction(batch.dir_x[k], batch.dir_y[k], batch.dir_z[k]);
      const std::size_t at = first[b] + packed;
      for (int c = 0; c < 3; ++c) {
        ray[6 * at + static_cast<std::size_t>(c)] = origin[c];
        ray[6 * at + 3 + static_cast<std::size_t>(c)] = static_cast<float>(direction[c]);
      }
      range[at] =
          hits[k].kind == RoughHit::Kind::none ? std::numeric_limits<float>::infinity() : hits[k].distance_m;
      triangle[at] = numbers.triangle(plan.sector().antenna_m, direction, hits[k]);
    }
  };
  const std::string folder = arguments.peer + (arguments.march ? "/march." : "/");
  if (arguments.march) {
    march(*plans.march, rays, 1, take);
  } else {
    trace(plan, rays, 1, take);
    write_values(folder + "rays.f32", ray);
    test::write_scene_mesh(plan.scene().world(), folder + "mesh.ply");
  }
  write_values(folder + "range.f32", range);
  write_values(folder + "triangle.u32", triangle);
}

/// One trace for each line of the standard input.
void serve_peer(const Plans& plans, const Rays& rays, const Arguments& arguments) {
  leave_rays(plans, rays, arguments);
  if (arguments.march) {
    std::printf("ready 0 obliq, a march\n");
  } else {
    std::printf("ready %.3f obliq, %s\n", plans.embree->scene().tracer().build_s(),
                EmbreeTracer::version().c_str());
  }
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    const Spent run = spent([&] {
      if (arguments.march) {
        march(*plans.march, rays, arguments.threads, forget);
      } else {
        trace(*plans.embree, rays, arguments.threads, forget);
      }
    });
    std::printf("%.3f %.3f\n", run.wall_ms, run.cpu_ms);
    std::fflush(stdout);
  }
}

/// Several runs of one thing.
struct Times {
  std::vector<double> wall_ms;
  std::vector<double> cpu_ms;

  void add(const Spent& run) {
    wall_ms.insert(std::upper_bound(wall_ms.begin(), wall_ms.end(), run.wall_ms), run.wall_ms);
    cpu_ms.insert(std::upper_bound(cpu_ms.begin(), cpu_ms.end(), run.cpu_ms), run.cpu_ms);
  }
  double least_ms() const { return wall_ms.front(); }
  double median_ms() const { return wall_ms[wall_ms.size() / 2]; }
  double least_cpu_ms() const { return cpu_ms.front(); }

  nlohmann::ordered_json report() const {
    return {{"least_ms", least_ms()}, {"median_ms", median_ms()}, {"least_cpu_ms", least_cpu_ms()}};
  }
};

void measure_overhead(const Plans& plans, const Rays& rays, const Arguments& arguments) {
  const int threads = arguments.threads;
  struct Run {
    const char* key;
    const char* name;
    std::function<void()> work;
    Times times;
  };
  std::vector<Run> runs{
      {"trace", "trace by Embree", [&] { trace(*plans.embree, rays, threads, forget); }, {}},
      {"march", "march", [&] { march(*plans.march, rays, threads, forget); }, {}},
      {"frame", "whole frame", [&] { whole_frame(*plans.march, threads); }, {}},
      {"embree_frame", "all by Embree", [&] { whole_frame(*plans.embree, threads); }, {}}};
  for (int k = 0; k <= arguments.repeats; ++k) {
    for (Run& run : runs) {
      const Spent one = spent(run.work);
      if (k > 0) run.times.add(one);  // memory is new at first
    }
  }
  const Times& bare = runs.front().times;
  std::printf("%.2f M rays, %d threads, %s, %d repeats in turn\n", static_cast<double>(rays.n) / 1e6, threads,
              EmbreeTracer::version().c_str(), arguments.repeats);
  std::printf("%-16s %10s %10s %14s %12s %14s\n", "", "least ms", "median ms", "least CPU ms", "over trace",
              "of CPU time");
  nlohmann::ordered_json report{{"rays", rays.n},
                                {"threads", threads},
                                {"tracer", EmbreeTracer::version()},
                                {"repeats", arguments.repeats}};
  for (const Run& run : runs) {
    std::printf("%-16s %10.1f %10.1f %14.1f %12.2f %14.2f\n", run.name, run.times.least_ms(),
                run.times.median_ms(), run.times.least_cpu_ms(), run.times.least_ms() / bare.least_ms(),
                run.times.least_cpu_ms() / bare.least_cpu_ms());
    report[run.key] = run.times.report();
  }
  std::printf("(target for a whole frame: at most %.2f of the trace by Embree)\n", kAllowedOverhead);
  if (arguments.json.empty()) return;
  report["frame_over_trace"] = runs[2].times.least_ms() / bare.least_ms();
  report["target"] = kAllowedOverhead;
  std::ofstream file(arguments.json);
  file << report.dump(1) << "\n";
  file.close();
  if (!file) throw InputError("--json: found " + arguments.json + ", which cannot be written");
}

void run(const Arguments& arguments) {
  const SceneConfig config = load_scene_file(arguments.scene, arguments.options);
  const RadarConfig& radar = choose_radar(config, "");
  if (radar.settings.frustum == FrustumKind::sweep)
    throw InputError("frustum.kind: found \"sweep\"; allowed: \"symmetric\" or \"oblique\", which have rays");
  const auto world = std::make_shared<const World>(load_world(config.world));
  const auto settings = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{radar.settings, 1});
  const auto plan = [&](RayMethod method) {
    const auto scene = std::make_shared<const Scene>(world, config.materials, arguments.threads, method);
    if (needs_tracer(*scene, radar.settings.frustum)) scene->tracer();  // not while a frame is timed
    const PlanResult planned = plan_frame(scene, settings, place_radar(*world, radar));
    if (!planned.plan) throw InputError(all_text(planned.errors));
    return planned.plan;
  };
  const Plans plans{plan(RayMethod::march), plan(RayMethod::embree)};
  const Rays rays(*plans.march);
  if (arguments.peer.empty()) {
    measure_overhead(plans, rays, arguments);
  } else {
    serve_peer(plans, rays, arguments);
  }
}

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  obliq::Arguments arguments;
  CLI::App app("What a ray tracing frame costs beyond its rays");
  app.add_option("SCENE", arguments.scene, "Scene file")->required();
  app.add_option("--set", arguments.options.set, "KEY=VALUE, beats the scene file");
  app.add_option("--threads", arguments.threads, "Of the frame and of the trace")->check(CLI::PositiveNumber);
  app.add_option("--repeats", arguments.repeats, "Of frame and trace, in turn")->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "File for the figures")->type_name("FILE");
  app.add_option("--peer", arguments.peer, "Folder for rays and hits; then a trace for each line read")
      ->type_name("FOLDER");
  app.add_flag("--march", arguments.march, "With --peer: a march answers the rays, not Embree");
  CLI11_PARSE(app, argc, argv);
  try {
    obliq::run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ray_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
