#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "server/explain/explanation.h"
#include "server/explain/loaded_scene.h"
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

constexpr double kStandardEarth = 4.0 / 3;
constexpr int kTimings = 3;  ///< of a frame; the quickest counts
/// Cells of half the size are tried up to this many nodes, and half of the memory that is free.
constexpr double kMostFineNodes = 0x1p25;

class Experiment {
 public:
  Experiment(const ExplainInput& input, const Progress& progress)
      : input_(input),
        progress_(progress),
        source_(comparison_source(input.settings, input.materials)),
        wall_source_(ray_source(input.settings, PlateKind::nearest)),
        runs_(choose_azimuths(input.settings.azimuth_bins, kMeasuredAzimuths)),
        ranges_(range_bins(input.settings)) {
    ranges_.range_normalisation = false;
  }

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

  /// Builds and plans again from its world.
  void build(LoadedScene& loaded, const std::vector<Material>& materials) {
    loaded.take_down();  // the old one's memory goes first
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
    loaded.own = plan(loaded, sharp_settings(input_.settings));
    if (!loaded.own->looks_at().extent().any) fail("no known ground in its sector");
  }

  std::shared_ptr<const FramePlan> plan(const LoadedScene& loaded, const RadarSettings& settings) const {
    const PlanResult planned = plan_frame(
        loaded.scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), loaded.pose);
    if (!planned.plan) fail(all_text(planned.errors));
    return planned.plan;
  }

  std::vector<double> power(const LoadedScene& loaded, const RadarSettings& settings) const {
    return render_sample(*plan(loaded, settings), runs_, input_.threads, 1, false).power_w;
  }
  /// What is compared are sharp echoes: beam and receiver have rows of their own.
  std::vector<double> power_by(const LoadedScene& loaded, SampleKind source,
                               Density density = kComparisonDensity) const {
    density.columns *= columns_factor_;
    return power(loaded, comparison_settings(sharp_settings(input_.settings), source, density));
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
    WedgePlanes planes = render_sample(*loaded.own, runs_, input_.threads, kTimings, true);
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
    probes_.emplace(*loaded.own, runs_);
    columns_factor_ = columns_factor(input_.settings, loaded.world->grid.cell_m);
    note_facts(*loaded.own);
    all_steps_ += static_cast<int>(materials_used(*loaded.world).size()) +
                  (result_.facts.buildings > 0 ? 2 : 0) +
                  (result_.facts.buildings > 0 && loaded.world->buildings.corners ? 1 : 0);
    power_w_ = power_by(loaded, source_);
    if (std::ranges::none_of(power_w_, [](double w) { return w > 0; }))
      fail("found no power in the bins; allowed: visible, reflecting ground in sector and range");
    result_.unsampled = unsampled_warning(own_frame(loaded).stats, input_.settings);
    result_.costs = loaded.costs;
    loaded.costs.load_s = 0;  // what is made of this world from now on is not loaded again

    begin("sampling noise");
    result_.measurement_noise = noise_of(loaded, source_, power_w_);
    try {
      if (result_.facts.buildings > 0) {
        wall_power_w_ = power_by(loaded, wall_source_);
        result_.wall_noise = noise_of(loaded, wall_source_, wall_power_w_);
      }
    } catch (const InputError& error) {
      wall_fault_ = error.what();  // rays may not see from where the sweep does
    }
    const auto power_of = [&](const RadarSettings& settings) { return power(loaded, settings); };
    result_.radar = radar_rows(input_.settings, air_view(loaded.own->looks_at()), power_of);
    const auto planned = plan(loaded, input_.settings);
    append(result_.radar, sea_rows(*planned, air_view(loaded.own->looks_at())));
    append(result_.radar, raster_rows(*planned));
    append(result_.radar, doppler_rows(*planned));
    append(result_.radar, corner_rows(*planned));
    if (input_.targets)
      append(result_.radar, target_rows(*planned, air_view(loaded.own->looks_at()), input_));
    RadarSettings own = sharp_settings(input_.settings);
    own.range_normalisation = false;
    own.power_w = 1;
    own.gain_db = 0;
    result_.frustum_noise = power_change(power_w_, power_of(own), ranges_);
  }

  void note_facts(const FramePlan& own) {
    const World& world = own.scene().world();
    SceneFacts& f = result_.facts;
    f.scene = input_.scene;
    f.radar = input_.radar;
    f.settings = input_.settings;
    f.materials = input_.materials;
    f.radius_factor = world.frame.radius_factor();
    f.earth_factor = std::isfinite(f.radius_factor) ? f.radius_factor : kStandardEarth;
    f.height_m = world.frame.geodetic_from_world(own.pose().antenna).height_m -
                 own.looks_at().extent().median_height_m;
    f.range_spacing_m = ranges_.spacing_m;
    f.cell_m = world.grid.cell_m;
    f.nodes = world.grid.y_m.size();
    f.source_error = world.report.source_error;
    f.buildings = world.buildings.list.size();
    f.sizes = median_sizes(world.buildings);
    if (f.buildings > 0) f.building_material = world.buildings.list.front().material;
    f.flat_plates = flat_plates(f.materials);
    f.threads = thread_count(input_.threads);
    f.measured_azimuth_bins = azimuth_count(runs_);
    f.ground_points = probes_->size();
    f.columns = kComparisonDensity.columns * columns_factor_;
  }

  /// Keeps what `measure` finds out; what cannot be loaded or rendered becomes the reason.
  template <class Measure>
  void compare(Ingredient ingredient, const std::string& name, const std::string& change, Measure&& measure) {
    Comparison c;
    c.ingredient = ingredient;
    c.name = name;
    c.change = change;
    begin(name + ", " + change);
    try {
      measure(c);
    } catch (const InputError& error) {
      c.reason = error.what();
    }
    result_.comparisons.push_back(std::move(c));
  }

  void compare_speckle(const LoadedScene& loaded) {
    const bool is_ground = resolved_speckle(input_.settings) != SpeckleKind::geometric;
    const bool sweeps = input_.settings.frustum == FrustumKind::sweep;
    const std::string change = sweeps ? "geometric, with oblique rays" : is_ground ? "geometric" : "ground";
    compare(Ingredient::speckle, "speckle", change, [&](Comparison& c) {
      const auto frame = [&](SpeckleKind kind) {
        RadarSettings settings = sharp_settings(input_.settings);
        settings.frustum = wall_source_.frustum;
        settings.speckle = kind;
        return render_sample(*plan(loaded, settings), runs_, input_.threads, kTimings, true);
      };
      const WedgePlanes ground = frame(SpeckleKind::ground);
      const WedgePlanes geometric = frame(SpeckleKind::geometric);
      result_.ground_speckle = measure_speckle(ground);
      result_.geometric_speckle = measure_speckle(geometric);
      c.power = power_change(ground.power_w, geometric.power_w, range_bins(input_.settings));
      c.costs = result_.costs;
      c.costs.load_s = c.costs.build_s = 0;  // nothing is loaded or built again
      c.costs.frame_s = is_ground ? geometric.frame_s : ground.frame_s;
    });
  }

  void compare_materials(LoadedScene& loaded) {
    for (const std::uint8_t id : materials_used(*loaded.world))
      compare(
          Ingredient::material, "material " + input_.materials[id].name, "as terrain", [&](Comparison& c) {
            c.material = id;
            c.on_buildings = std::ranges::any_of(loaded.world->buildings.list, [&](const Building& building) {
              return building.material == id;
            });
            std::vector<Material> materials = input_.materials;
            materials[id] = materials[0];
            build(loaded, materials);
            finish(c, loaded, power_w_);
          });
  }

  /// No one else holds this world between two scenes: it may be changed.
  void compare_buildings(LoadedScene& loaded) {
    Buildings& buildings = loaded.world->buildings;
    if (buildings.list.empty()) return;
    if (buildings.corners)
      compare(Ingredient::corners, "corners of walls", "none", [&](Comparison& c) {
        loaded.take_down();
        buildings.corners = false;
        build(loaded, input_.materials);
        finish(c, loaded, power_w_);
        buildings.corners = true;
      });
    compare(Ingredient::walls, "building walls", "roofs only", [&](Comparison& c) {
      if (!wall_fault_.empty()) throw InputError(wall_fault_);
      loaded.take_down();
      loaded.world->buildings.walls = false;  // roofs that hang in the air
      build(loaded, input_.materials);
      finish(c, loaded, wall_power_w_);
    });
    compare(Ingredient::buildings, "buildings", "none", [&](Comparison& c) {
      loaded.take_down();
      loaded.world->buildings = {};
      build(loaded, input_.materials);
      finish(c, loaded, power_w_);
    });
  }

  void finish(Comparison& c, LoadedScene& loaded, const std::vector<double>& against_w) {
    const SampleKind source = c.ingredient == Ingredient::walls ? wall_source_ : source_;
    c.power = power_change(against_w, power_by(loaded, source), ranges_);
    own_frame(loaded);
    c.costs = loaded.costs;
  }

  /// Loads a changed world and compares its bins and where its ground has moved.
  LoadedScene compare_world(Comparison& c, const WorldSpec& spec, const std::vector<double>& against_w,
                            const GroundProbes& probes) {
    LoadedScene loaded = load(spec);
    finish(c, loaded, against_w);
    c.shift = probes.shift_in(*loaded.world, loaded.pose);
    c.source_error = loaded.world->report.source_error;
    return loaded;
  }

  void compare_earths() {
    const double k = result_.facts.radius_factor;
    const bool flat = !std::isfinite(k);
    WorldSpec spec = input_.world;

    // A flat scene is compared with the standard earth, and that one's refraction with it.
    spec.radius_factor = flat ? kStandardEarth : std::numeric_limits<double>::infinity();
    const std::string curved_as = flat ? "with k = " + short_number(spec.radius_factor, 4) : "flat earth";
    LoadedScene curved;
    compare(Ingredient::curvature, "earth curvature", curved_as, [&](Comparison& c) {
      c.adds = flat;
      c.value = spec.radius_factor;
      LoadedScene loaded = compare_world(c, spec, power_w_, *probes_);
      if (flat) curved = std::move(loaded);
    });
    spec.radius_factor = k == 1 ? kStandardEarth : 1;
    const std::string other_k = "k = " + short_number(spec.radius_factor, 4);
    const std::string refracted_as = flat ? other_k + ", not 4/3" : (k == 1 ? "with " : "vacuum, ") + other_k;
    compare(Ingredient::refraction, "refraction", refracted_as, [&](Comparison& c) {
      c.adds = flat || k == 1;
      c.value = spec.radius_factor;
      if (!flat) {
        compare_world(c, spec, power_w_, *probes_);
        return;
      }
      if (!curved.own) throw InputError(result_.comparisons.back().reason);
      const std::vector<double> standard_w = power_by(curved, source_);
      const GroundProbes probes(*curved.own, runs_);
      curved = {};
      compare_world(c, spec, standard_w, probes);
    });
  }

  void compare_cells() {
    const SceneFacts& facts = result_.facts;
    for (const double factor : {2.0, 0.5}) {
      WorldSpec spec = input_.world;
      const double cell_m = round_to_quantum_m(factor * facts.cell_m);
      spec.terrain.cell_m = cell_m;
      compare(Ingredient::cell_size, factor > 1 ? "cell size x 2" : "cell size x 1/2",
              "cells of " + short_number(cell_m, 4) + " m", [&](Comparison& c) {
                c.value = cell_m;
                c.power_counts = facts.flat_plates.empty();
                if (factor < 1) check_room(facts.cell_m * facts.cell_m / (cell_m * cell_m));
                compare_world(c, spec, power_w_, *probes_);
              });
    }
  }

  /// Throws InputError where a grid that is so many times as large is too large.
  void check_room(double growth) const {
    const double nodes = growth * static_cast<double>(result_.facts.nodes);
    if (nodes > kMostFineNodes)
      throw InputError(fmt::format("{:.0f} million nodes are more than the {:.0f} that are tried",
                                   nodes / 1e6, kMostFineNodes / 1e6));
    const double needed = growth * static_cast<double>(result_.costs.bytes());
    const auto free = static_cast<double>(bytes_in_line("/proc/meminfo", "MemAvailable:"));
    if (free > 0 && needed > free / 2)
      throw InputError(
          fmt::format("needs about {:.0f} MB of memory, {:.0f} are free", needed / 1e6, free / 1e6));
  }

  const ExplainInput& input_;
  const Progress& progress_;
  SampleKind source_;       ///< of the comparisons
  SampleKind wall_source_;  ///< of that without walls: they exist as triangles alone, which rays see
  std::string wall_fault_;  ///< why those rays cannot look from here; empty: they can
  Explanation result_;
  AzimuthRuns runs_;
  RangeBins ranges_;  ///< of planes without range normalisation
  std::optional<GroundProbes> probes_;
  std::vector<double> power_w_;       ///< of the scene as it is, by the comparison's source
  std::vector<double> wall_power_w_;  ///< the same by the source for walls
  int columns_factor_ = 1;            // of the scene as it is
  int steps_ = 0;                     // begun, for the progress
  std::string step_;                  // the newest
  // Loading, scene, noise, speckle, two earths, two cells, scene; then materials and buildings.
  int all_steps_ = 9;
};

}  // namespace

Explanation explain_scene(const ExplainInput& input, const Progress& progress) {
  return Experiment(input, progress).run();
}

}  // namespace obliq
