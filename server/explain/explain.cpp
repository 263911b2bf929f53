#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "server/explain/explanation.h"
#include "server/explain/radar_rows.h"
#include "server/explain/scene_facts.h"
#include "server/explain/table.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/radar/unsampled.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/scene_memory.h"
#include "terrain/base/errors.h"
#include "terrain/base/process.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"
#include "terrain/grid_area.h"

namespace obliq {
namespace {

constexpr int kTimings = 3;  ///< of a frame; the quickest counts
/// Cells of half the size are tried up to this many nodes, and half of the memory that is free.
constexpr double kMostFineNodes = 0x1p25;

/// A world with its ray-tracing structure, ready to render.
struct LoadedScene {
  std::shared_ptr<World> world;
  std::shared_ptr<const Scene> scene;
  Pose pose;
  std::shared_ptr<const FramePlan> own;   ///< the scene's own frustum
  std::shared_ptr<const FramePlan> fine;  ///< the comparison's source
  Costs costs;
};

class Experiment {
 public:
  Experiment(const ExplainInput& input, const Progress& progress)
      : input_(input),
        progress_(progress),
        source_(comparison_source(input.settings, input.materials)),
        wall_source_(ray_source(input.settings, PlateKind::nearest)) {}

  Explanation run() {
    if (!(input_.settings.power_w > 0))
      fail("found radar.power_w = 0, which lights no bin; allowed to explain: more than 0");
    begin("loading terrain");
    LoadedScene loaded = load(input_.world);
    if (input_.on_loaded) input_.on_loaded(*loaded.world);
    measure_scene(loaded);
    compare_speckle(loaded);
    time_again(loaded);
    compare_materials(loaded);
    compare_buildings(loaded);
    loaded = {};  // one world at a time
    compare_earths();
    compare_cells();
    begin("the scene once more, for its time");
    loaded = load(input_.world);
    time_again(loaded);
    std::ranges::stable_sort(result_.comparisons, {}, &Comparison::ingredient);
    for (Comparison& c : result_.comparisons) judge(c, result_);
    tell("done", 1);
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("radar \"" + input_.radar + "\": " + why);
  }
  void tell(const std::string& what, double fraction) const {
    if (progress_) progress_(what, fraction);
  }
  void begin(const std::string& what) {
    step_ = fmt::format("[{}/{}] {}", steps_ + 1, all_steps_, what);
    tell(step_, static_cast<double>(steps_++) / all_steps_);
  }

  LoadedScene load(const WorldSpec& spec) {
    LoadedScene loaded;
    const auto start = std::chrono::steady_clock::now();
    loaded.world = std::make_shared<World>(load_world(spec, [this](std::string_view, double fraction) {
      tell(step_, (steps_ - 1 + fraction) / all_steps_);
    }));
    loaded.costs.load_s = seconds_since(start);
    build(loaded, input_.materials);
    return loaded;
  }

  static void take_down(LoadedScene& loaded) {
    loaded.own = loaded.fine = nullptr;
    loaded.scene = nullptr;
  }

  /// Builds and plans again from its world.
  void build(LoadedScene& loaded, const std::vector<Material>& materials) {
    take_down(loaded);  // the old one's memory goes first
    loaded.scene = std::make_shared<const Scene>(loaded.world, materials, input_.threads, input_.rays);
    loaded.costs.grid_bytes = grid_bytes(*loaded.world);
    loaded.costs.building_bytes = building_bytes(loaded.world->buildings);
    if (needs_tracer(*loaded.scene, input_.settings.frustum)) {
      const EmbreeTracer& tracer = loaded.scene->tracer();
      loaded.costs.build_s = tracer.build_s();
      loaded.costs.tracer_bytes = tracer.bytes();
    }
    std::vector<FieldError> errors;
    const auto pose = place_antenna(*loaded.world, input_.pose, errors);
    if (!pose) fail(all_text(errors));
    loaded.pose = *pose;
    loaded.own = plan(loaded, input_.settings);
    if (!loaded.own->looks_at().extent().any) fail("no known ground in its sector");
    if (columns_factor_ == 0) columns_factor_ = columns_factor(input_.settings, loaded.world->grid.cell_m);
    loaded.fine = plan(loaded, comparison(source_, kComparisonDensity));
  }

  /// What is compared are sharp echoes: beam and receiver have rows of their own.
  std::shared_ptr<const FramePlan> plan(const LoadedScene& loaded, const RadarSettings& settings) const {
    const auto snapshot =
        std::make_shared<const SettingsSnapshot>(SettingsSnapshot{sharp_settings(settings), 1});
    const PlanResult planned = plan_frame(loaded.scene, snapshot, loaded.pose);
    if (!planned.plan) fail(all_text(planned.errors));
    return planned.plan;
  }

  RadarSettings comparison(SampleKind source, Density density) const {
    density.columns *= columns_factor_;
    return comparison_settings(input_.settings, source, density);
  }

  std::vector<double> power(const FramePlan& frame) const {
    return render_sample(frame, wedges_, input_.threads, 1, false).power_w;
  }
  std::vector<double> power_by(const LoadedScene& loaded, SampleKind source, Density density) const {
    return power(*plan(loaded, comparison(source, density)));
  }

  /// Largest differences from the same scene at other densities.
  PowerChange noise_of(const LoadedScene& loaded, SampleKind source,
                       const std::vector<double>& power_w) const {
    PowerChange noise;
    for (const Density& density : kOtherDensities)
      noise = larger_of(noise, power_change(power_w, power_by(loaded, source, density), ranges_));
    return noise;
  }

  /// Time of the scene's own frame, states included, as the user gets it.
  WedgePlanes own_frame(LoadedScene& loaded) const {
    WedgePlanes planes = render_sample(*loaded.own, wedges_, input_.threads, kTimings, true);
    loaded.costs.frame_s = planes.frame_s;
    loaded.costs.spread_s = planes.spread_s;
    return planes;
  }

  /// The machine drifts while the changes are timed: the scene's own time, taken again, tells how much.
  void time_again(LoadedScene& loaded) {
    const Costs first = result_.costs;
    own_frame(loaded);
    const double slowest_s =
        std::max(first.frame_s + first.spread_s, loaded.costs.frame_s + loaded.costs.spread_s);
    result_.costs.frame_s = std::min(first.frame_s, loaded.costs.frame_s);
    result_.costs.spread_s = slowest_s - result_.costs.frame_s;
  }

  void measure_scene(LoadedScene& loaded) {
    begin("the scene as it is");
    wedges_ = even_wedges(input_.settings);
    ranges_ = range_bins_of(loaded.fine->bins());
    probes_.emplace(*loaded.fine, wedges_);
    note_facts(loaded);
    all_steps_ +=
        static_cast<int>(materials_used(*loaded.world).size()) + (result_.facts.buildings > 0 ? 2 : 0);
    power_w_ = power(*loaded.fine);
    if (std::ranges::none_of(power_w_, [](double w) { return w > 0; }))
      fail("found no power in the bins; allowed: visible, reflecting ground in sector and range");
    result_.unsampled = unsampled_warning(own_frame(loaded).stats, input_.settings);
    result_.costs = loaded.costs;
    loaded.costs.load_s = 0;  // what is made of this world from now on is not loaded again

    begin("sampling noise");
    result_.measurement_noise = noise_of(loaded, source_, power_w_);
    if (!loaded.world->buildings.list.empty()) measure_walls(loaded);
    RadarSettings own = input_.settings;
    own.range_normalisation = false;
    own.power_w = 1;
    own.gain_db = 0;
    result_.radar = radar_rows(
        input_.settings, air_view(loaded.own->looks_at()),
        measure_radar_powers({loaded.scene, loaded.pose, input_.radar, wedges_, input_.threads}, own));
    result_.frustum_noise = power_change(power_w_, power(*plan(loaded, own)), ranges_);
  }

  /// Rays may not see from where the sweep does.
  void measure_walls(const LoadedScene& loaded) {
    try {
      wall_power_w_ = power_by(loaded, wall_source_, kComparisonDensity);
      result_.wall_noise = noise_of(loaded, wall_source_, wall_power_w_);
    } catch (const InputError& error) {
      wall_fault_ = error.what();
    }
  }

  void note_facts(const LoadedScene& loaded) {
    SceneFacts& f = result_.facts;
    f = facts_of(input_, *loaded.own);
    f.threads = threads_of(input_.threads);
    f.measured_azimuth_bins = azimuth_bins_in(wedges_);
    f.ground_points = probes_->size();
    f.columns = kComparisonDensity.columns * columns_factor_;
  }

  static Comparison named(Ingredient ingredient, const std::string& name, const std::string& change) {
    Comparison c;
    c.ingredient = ingredient;
    c.name = name;
    c.change = change;
    return c;
  }
  void keep(Comparison c) { result_.comparisons.push_back(std::move(c)); }

  void compare_speckle(LoadedScene& loaded) {
    begin("speckle");
    const bool is_ground = resolved_speckle(input_.settings) != SpeckleKind::geometric;
    const bool sweeps = input_.settings.frustum == FrustumKind::sweep;
    Comparison c = named(Ingredient::speckle, "speckle",
                         sweeps      ? "geometric, with oblique rays"
                         : is_ground ? "geometric"
                                     : "ground");
    try {
      const auto frame = [&](SpeckleKind kind) {
        RadarSettings settings = input_.settings;
        settings.frustum = wall_source_.frustum;
        settings.speckle = kind;
        return render_sample(*plan(loaded, settings), wedges_, input_.threads, kTimings, true);
      };
      const WedgePlanes ground = frame(SpeckleKind::ground);
      const WedgePlanes geometric = frame(SpeckleKind::geometric);
      result_.ground_speckle = measure_speckle(ground);
      result_.geometric_speckle = measure_speckle(geometric);
      RangeBins ranges = ranges_;
      ranges.range_normalisation = input_.settings.range_normalisation;
      c.power = power_change(ground.power_w, geometric.power_w, ranges);
      c.costs = result_.costs;
      c.costs.build_s = 0;  // nothing is built again
      c.costs.frame_s = is_ground ? geometric.frame_s : ground.frame_s;
      c.costs.load_s = 0;
    } catch (const InputError& error) {
      c.reason = error.what();
    }
    keep(std::move(c));
  }

  void compare_materials(LoadedScene& loaded) {
    for (const std::uint8_t id : materials_used(*loaded.world)) {
      Comparison c = named(Ingredient::material, "material " + input_.materials[id].name, "as terrain");
      begin(c.name + ", " + c.change);
      c.material = id;
      c.on_buildings = std::ranges::any_of(loaded.world->buildings.list,
                                           [&](const Building& building) { return building.material == id; });
      std::vector<Material> materials = input_.materials;
      materials[id] = materials[0];
      build(loaded, materials);
      finish(c, loaded, power_w_);
      keep(std::move(c));
    }
  }

  void compare_buildings(LoadedScene& loaded) {
    if (loaded.world->buildings.list.empty()) return;
    const auto compare = [&](Ingredient ingredient, const std::string& name, const std::string& change) {
      Comparison c = named(ingredient, name, change);
      begin(name + ", " + change);
      const bool walls = ingredient == Ingredient::walls;
      if (walls) c.reason = wall_fault_;
      if (c.reason.empty()) {
        build(loaded, input_.materials);
        finish(c, loaded, walls ? wall_power_w_ : power_w_);
      }
      keep(std::move(c));
    };
    // No one else holds this world between two scenes: it may be changed.
    take_down(loaded);
    loaded.world->buildings.walls = false;  // roofs that hang in the air
    compare(Ingredient::walls, "building walls", "roofs only");
    take_down(loaded);
    loaded.world->buildings = {};
    compare(Ingredient::buildings, "buildings", "none");
  }

  /// Compares the scene's bins, and its ground where it may have moved.
  void finish(Comparison& c, LoadedScene& loaded, const std::vector<double>& against_w) {
    const bool walls = c.ingredient == Ingredient::walls;
    c.power = power_change(
        against_w, walls ? power_by(loaded, wall_source_, kComparisonDensity) : power(*loaded.fine), ranges_);
    own_frame(loaded);
    c.costs = loaded.costs;
  }

  /// Loads a changed world and compares it; what cannot be loaded or rendered becomes the reason.
  void compare_world(Comparison& c, const WorldSpec& spec, const std::vector<double>& against_w,
                     const GroundProbes& probes, LoadedScene* kept = nullptr) {
    begin(c.name + ", " + c.change);
    try {
      LoadedScene loaded = load(spec);
      finish(c, loaded, against_w);
      c.shift = probes.shift_in(*loaded.world, loaded.pose);
      c.source_error = loaded.world->report.source_error;
      if (kept) *kept = std::move(loaded);
    } catch (const InputError& error) {
      c.reason = error.what();
    }
  }

  void compare_earths() {
    constexpr double kFlat = std::numeric_limits<double>::infinity();
    const SceneFacts& facts = result_.facts;
    const bool flat = !std::isfinite(facts.radius_factor);
    WorldSpec spec = input_.world;

    // A flat scene is compared with the standard earth, and that one's refraction with it.
    Comparison curvature = named(Ingredient::curvature, "earth curvature", "");
    curvature.adds = flat;
    curvature.value = spec.radius_factor = flat ? kStandardEarth : kFlat;
    curvature.change = flat ? "with k = " + short_number(spec.radius_factor, 4) : "flat earth";
    LoadedScene curved;
    compare_world(curvature, spec, power_w_, *probes_, flat ? &curved : nullptr);

    Comparison refraction = named(Ingredient::refraction, "refraction", "");
    refraction.adds = flat || facts.radius_factor == 1;
    refraction.value = spec.radius_factor = facts.radius_factor == 1 ? kStandardEarth : 1;
    const std::string k = "k = " + short_number(spec.radius_factor, 4);
    refraction.change = flat ? k + ", not 4/3" : (facts.radius_factor == 1 ? "with " : "vacuum, ") + k;
    if (!flat) {
      compare_world(refraction, spec, power_w_, *probes_);
    } else if (!curvature.reason.empty()) {
      refraction.reason = curvature.reason;
    } else {
      const std::vector<double> standard_w = power(*curved.fine);
      const GroundProbes probes(*curved.fine, wedges_);
      curved = {};
      compare_world(refraction, spec, standard_w, probes);
    }
    keep(std::move(curvature));
    keep(std::move(refraction));
  }

  void compare_cells() {
    const SceneFacts& facts = result_.facts;
    for (const double factor : {2.0, 0.5}) {
      WorldSpec spec = input_.world;
      const double cell_m = round_to_quantum_m(factor * facts.cell_m);
      spec.terrain.cell_m = cell_m;
      Comparison c = named(Ingredient::cell_size, factor > 1 ? "cell size x 2" : "cell size x 1/2",
                           "cells of " + short_number(cell_m, 4) + " m");
      c.value = cell_m;
      c.power_counts = facts.flat_plates.empty();
      const double growth = facts.cell_m * facts.cell_m / (cell_m * cell_m);
      const double needed = growth * static_cast<double>(result_.costs.bytes());
      const auto free = static_cast<double>(bytes_in_line("/proc/meminfo", "MemAvailable:"));
      if (factor < 1 && growth * static_cast<double>(facts.nodes) > kMostFineNodes) {
        c.reason = fmt::format("{:.0f} million nodes are more than the {:.0f} that are tried",
                               growth * static_cast<double>(facts.nodes) / 1e6, kMostFineNodes / 1e6);
      } else if (factor < 1 && free > 0 && needed > free / 2) {
        c.reason = fmt::format("needs about {:.0f} MB of memory, {:.0f} are free", needed / 1e6, free / 1e6);
      } else {
        compare_world(c, spec, power_w_, *probes_);
      }
      keep(std::move(c));
    }
  }

  const ExplainInput& input_;
  const Progress& progress_;
  SampleKind source_;       ///< of the comparisons
  SampleKind wall_source_;  ///< of that without walls: they exist as triangles alone, which rays see
  std::string wall_fault_;  ///< why those rays cannot look from here; empty: they can
  Explanation result_;
  std::vector<AzimuthRange> wedges_;
  RangeBins ranges_;
  std::optional<GroundProbes> probes_;
  std::vector<double> power_w_;       ///< of the scene as it is, by the comparison's source
  std::vector<double> wall_power_w_;  ///< the same by the source for walls
  int columns_factor_ = 0;            // of the scene as it is
  int steps_ = 0;                     // begun, for the progress
  std::string step_;                  // the newest
  int all_steps_ =
      9;  // loading, scene, noise, speckle, two earths, two cells, scene; then materials and buildings
};

}  // namespace

Explanation explain_scene(const ExplainInput& input, const Progress& progress) {
  return Experiment(input, progress).run();
}

}  // namespace obliq
