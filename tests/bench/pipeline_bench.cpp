// Benchmarks of the pipeline's stages and of whole frames: obliq_bench [--benchmark_filter=...].
// The scene is the paper's swath (120 degrees, 3.7 to 37 km, 1024 x 1024 bins) over seeded hills, or over a
// real elevation model when OBLIQ_BENCH_SCENE names a scene file. Rates are per second of wall time on all
// threads of one frame; compare figures of one run only.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <thread>
#include <vector>

#include "server/control/scene_file.h"
#include "server/radar/echo/echo_bins.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

struct Setting {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> traced;  ///< of the same world: Embree answers all rays
  Pose pose;
  RadarSettings settings;

  Setting(World loaded, const std::vector<Material>& materials, const PoseSettings& at) {
    const auto world = std::make_shared<const World>(std::move(loaded));
    scene = std::make_shared<const Scene>(world, materials, 0);
    traced = std::make_shared<const Scene>(world, materials, 0, RayMethod::embree);
    traced->tracer();  // not while a frame is timed
    if (needs_tracer(*scene, FrustumKind::oblique)) scene->tracer();
    std::vector<FieldError> errors;
    pose = place_antenna(*world, at, errors).value();
  }
};

Setting hills() {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 40000, 30);
  spec.terrain.shape.height_m = 800;
  return {load_world(spec), test::two_materials(), test::settings_over_origin(3000)};
}

Setting from_file(const char* path) {
  const SceneConfig config = load_scene_file(path, {});
  Setting setting(load_world(config.world), config.materials, config.radars.at(0).pose);
  setting.settings = config.radars.at(0).settings;
  return setting;
}

const Setting& setting() {
  static const Setting value = [] {
    const char* path = std::getenv("OBLIQ_BENCH_SCENE");
    return path ? from_file(path) : hills();
  }();
  return value;
}

std::shared_ptr<const FramePlan> plan_of(FrustumKind kind, SpeckleKind speckle = SpeckleKind::ground,
                                         PlateKind plates = PlateKind::nearest,
                                         RayMethod rays = RayMethod::march) {
  RadarSettings settings = setting().settings;
  settings.frustum = kind;
  settings.speckle = speckle;
  settings.plates = plates;
  return plan_frame(rays == RayMethod::march ? setting().scene : setting().traced, test::snapshot(settings),
                    setting().pose)
      .plan;
}

/// Hands wedges to `threads` threads; work(range, thread).
template <typename Work>
void over_wedges(const FramePlan& plan, int threads, const Work& work) {
  std::atomic<int> next{0};
  const int n = wedge_count(plan.settings().azimuth_bins);
  const auto run = [&] {
    for (int index = next++; index < n; index = next++) {
      const int first = index * kWedgeAzimuthBins;
      work(AzimuthRange{first, std::min(kWedgeAzimuthBins, plan.settings().azimuth_bins - first)});
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(run);
  run();
}

int threads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

void WholeFrame(benchmark::State& state) {
  const auto plan =
      plan_of(static_cast<FrustumKind>(state.range(0)), static_cast<SpeckleKind>(state.range(1)),
              static_cast<PlateKind>(state.range(2)), static_cast<RayMethod>(state.range(3)));
  double rays = 0;
  for (auto _ : state) {
    RenderOptions options;
    options.on_wedge = [&](Wedge&& wedge) { rays += static_cast<double>(wedge.stats.rays); };
    render_wedges(*plan, {0, plan->settings().azimuth_bins}, options);
  }
  state.counters["Mray/s"] = benchmark::Counter(rays / 1e6, benchmark::Counter::kIsRate);
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void RayGeneration(benchmark::State& state) {
  const auto plan = plan_of(static_cast<FrustumKind>(state.range(0)));
  std::atomic<std::uint64_t> rays{0};
  for (auto _ : state) {
    over_wedges(*plan, threads(), [&](AzimuthRange range) {
      const auto batch = std::make_unique<RayBatch>();
      std::uint64_t n = 0;
      for (const auto source = make_ray_source(plan->looks_at(), range); source->generate(*batch);)
        n += static_cast<std::uint64_t>(batch->n);
      rays += n;
    });
  }
  state.counters["Mray/s"] =
      benchmark::Counter(static_cast<double>(rays.load()) / 1e6, benchmark::Counter::kIsRate);
}

/// The frame's samples, neither scattered nor binned.
void find_samples(benchmark::State& state, const FramePlan& plan) {
  std::atomic<std::uint64_t> found{0}, cast{0};
  for (auto _ : state) {
    over_wedges(plan, threads(), [&](AzimuthRange range) {
      const auto batch = std::make_unique<SampleBatch>();
      FrameStats stats;
      std::uint64_t n = 0;
      for (const auto source = make_sample_source(plan.looks_at(), range, nullptr);
           source->fill(*batch, stats);)
        n += static_cast<std::uint64_t>(batch->n);
      found += n;
      cast += stats.rays;
    });
  }
  state.counters["Msample/s"] =
      benchmark::Counter(static_cast<double>(found.load()) / 1e6, benchmark::Counter::kIsRate);
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(cast.load()), benchmark::Counter::kAvgIterations);
}

/// From rays to samples: generation, trace, refinement and, with spread plates, their walks. With the states
/// asked for, the profiles that perspective plates use cost a frame nothing more.
void Samples(benchmark::State& state) {
  find_samples(state, *plan_of(static_cast<FrustumKind>(state.range(0)), SpeckleKind::ground,
                               static_cast<PlateKind>(state.range(1))));
}

std::shared_ptr<const FramePlan> sweep_plan(std::int64_t planes_per_bin) {
  RadarSettings settings = setting().settings;
  settings.frustum = FrustumKind::sweep;
  settings.pixel_columns = static_cast<int>(planes_per_bin) * settings.azimuth_bins;
  return plan_frame(setting().scene, test::snapshot(settings), setting().pose).plan;
}

/// The sweep alone: planes marched.
void Sweep(benchmark::State& state) { find_samples(state, *sweep_plan(state.range(0))); }

void WholeSweepFrame(benchmark::State& state) {
  const auto plan = sweep_plan(state.range(0));
  for (auto _ : state) {
    RenderOptions options;
    options.on_wedge = [](Wedge&&) {};
    render_wedges(*plan, {0, plan->settings().azimuth_bins}, options);
  }
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// A frame of open sea on one thread: 0: as its material, 1: with a state's mean, 2: with texture too.
void OpenSea(benchmark::State& state) {
  static const auto scene = [] {
    std::vector<Material> materials = test::two_materials();
    materials[0].model = ScatteringModel::sea;
    materials[0].gamma = 1e-4;
    return test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 40000, 60)), materials);
  }();
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.sea.state = state.range(0) > 0 ? 3 : 0;
  settings.sea.shape = state.range(0) > 1 ? 1 : 0;
  settings.atmosphere.wind_m_s = 8;
  const auto plan =
      plan_frame(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), 1000)).plan;
  for (auto _ : state) {
    RenderOptions options;
    options.threads = 1;
    options.on_wedge = [](Wedge&&) {};
    render_wedges(*plan, {0, plan->settings().azimuth_bins}, options);
  }
}

/// Scattering and binning of made-up samples spread over one wedge.
void Binning(benchmark::State& state) {
  const auto plan = plan_of(FrustumKind::oblique, static_cast<SpeckleKind>(state.range(0)));
  const ScatteringTable scattering(plan->scene().materials(), plan->looks_at().wavelength_m());
  const SpeckleField speckle(plan->scene().world(), plan->sector().antenna_m, plan->looks_at().wavelength_m(),
                             plan->bins().range_spacing_m, plan->bins().azimuth_width_rad, 1);
  const auto samples = std::make_unique<SampleBatch>();
  samples->n = kBatch;
  BinBlock block(0, kWedgeAzimuthBins, plan->bins().n_range);
  double binned = 0;
  for (auto _ : state) {
    EchoBins bins(plan->looks_at(), scattering, speckle, {0, kWedgeAzimuthBins});
    for (int batch = 0; batch < 32; ++batch) {
      for (int k = 0; k < kBatch; ++k) {
        const auto s = static_cast<std::size_t>(k);
        const double r =
            plan->bins().r_min_m + (batch * kBatch + k) * (plan->bins().r_max_m - 4000) / (32 * kBatch);
        samples->azimuth_bin[s] = k % kWedgeAzimuthBins;
        samples->slant_range_m[s] = r;
        samples->solid_angle_sr[s] = 1e-7;
        samples->cos_incidence[s] = 0.3;
        samples->x_m[s] = r * 0.8;
        samples->z_m[s] = r * 0.5 + k % kWedgeAzimuthBins * 20.0;
        samples->face[s] = kNoFace;
        samples->material[s] = 0;
      }
      binned += static_cast<double>(bins.add(*samples));
    }
    bins.write(block);
    benchmark::DoNotOptimize(block.iq.data());
  }
  state.counters["Msample/s"] = benchmark::Counter(binned / 1e6, benchmark::Counter::kIsRate);
}

/// All profiles of a frame, whole, as spread plates need them; states need less.
void Profiles(benchmark::State& state) {
  const auto plan = plan_of(FrustumKind::oblique);
  for (auto _ : state) {
    over_wedges(*plan, threads(), [&](AzimuthRange range) {
      benchmark::DoNotOptimize(
          WedgeVisibility(plan->looks_at(), range).whole_marks(range.first).visible.data());
    });
  }
}

void PlanFrame(benchmark::State& state) {
  RadarSettings settings = setting().settings;
  settings.frustum = FrustumKind::oblique;
  const SettingsPtr snapshot = test::snapshot(settings);
  for (auto _ : state) benchmark::DoNotOptimize(plan_frame(setting().scene, snapshot, setting().pose).plan);
}

constexpr auto kOblique = static_cast<std::int64_t>(FrustumKind::oblique);
constexpr auto kSymmetric = static_cast<std::int64_t>(FrustumKind::symmetric);
constexpr auto kGround = static_cast<std::int64_t>(SpeckleKind::ground);
constexpr auto kGeometric = static_cast<std::int64_t>(SpeckleKind::geometric);
constexpr auto kSpread = static_cast<std::int64_t>(PlateKind::spread);
constexpr auto kNearest = static_cast<std::int64_t>(PlateKind::nearest);
constexpr auto kMarch = static_cast<std::int64_t>(RayMethod::march);
constexpr auto kEmbree = static_cast<std::int64_t>(RayMethod::embree);

BENCHMARK(OpenSea)->ArgName("sea")->DenseRange(0, 2)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(PlanFrame)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(RayGeneration)
    ->ArgName("frustum")
    ->Arg(kSymmetric)
    ->Arg(kOblique)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(Binning)->ArgName("speckle")->Arg(kGround)->Arg(kGeometric)->Unit(benchmark::kMillisecond);
BENCHMARK(Profiles)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Samples)
    ->ArgNames({"frustum", "plates"})
    ->ArgsProduct({{kSymmetric, kOblique}, {kSpread, kNearest}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(Sweep)
    ->ArgName("planes_per_bin")
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(WholeSweepFrame)
    ->ArgName("planes_per_bin")
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(WholeFrame)
    ->ArgNames({"frustum", "speckle", "plates", "rays"})
    ->ArgsProduct({{kSymmetric, kOblique}, {kGround}, {kSpread, kNearest}, {kMarch}})
    ->ArgsProduct({{kSymmetric, kOblique}, {kGround}, {kNearest}, {kEmbree}})
    ->Args({kOblique, kGeometric, kNearest, kMarch})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace obliq

int main(int argc, char** argv) {
  benchmark::AddCustomContext("tracer", obliq::EmbreeTracer::version());
  benchmark::AddCustomContext("threads", std::to_string(obliq::threads()));
  benchmark::AddCustomContext("frustum", "0 symmetric, 1 oblique");
  benchmark::AddCustomContext("speckle", "0 ground, 1 geometric");
  benchmark::AddCustomContext("plates", "0 spread, 1 nearest");
  benchmark::AddCustomContext("rays", "0 march, 1 embree");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
