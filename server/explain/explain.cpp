#include "server/explain/explain.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "server/explain/advice.h"
#include "server/explain/table.h"
#include "server/explain/verdict.h"
#include "server/radar/frame_plan.h"
#include "server/radar/unsampled.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/scene_memory.h"
#include "terrain/base/errors.h"
#include "terrain/base/seconds.h"
#include "terrain/base/text.h"
#include "terrain/grid_area.h"

namespace obliq {
namespace {

constexpr int kTimings = 3;  ///< of a frame; the quickest counts
constexpr double kStandardEarth = 4.0 / 3;
/// Cells of half the size are tried up to this many nodes, and half of the memory that is free.
constexpr double kMostFineNodes = 0x1p25;

/// A world with its ray-tracing structure, ready to render.
struct Stage {
  std::shared_ptr<World> world;
  std::shared_ptr<const Scene> scene;
  Pose pose;
  std::shared_ptr<const FramePlan> own;   ///< the scene's own frustum
  std::shared_ptr<const FramePlan> fine;  ///< the comparison's source
  Costs costs;
};

class Experiment {
 public:
  Experiment(const ExplainInput& input, const Progress& progress) : input_(input), progress_(progress) {}

  Explanation run() {
    if (!(input_.settings.power_w > 0))
      throw InputError("radar \"" + input_.radar +
                       "\": found radar.power_w = 0, which lights no bin; allowed to explain: more than 0");
    begin("loading terrain");
    Stage stage = load(input_.world);
    if (input_.on_loaded) input_.on_loaded(*stage.world);
    measure_scene(stage);
    compare_speckle(stage);
    time_again(stage);
    compare_materials(stage);
    compare_buildings(stage);
    stage = {};  // one world at a time
    compare_earths();
    compare_cells();
    begin("the scene once more, for its time");
    stage = load(input_.world);
    time_again(stage);
    std::ranges::stable_sort(result_.comparisons, {}, &Comparison::ingredient);
    for (Comparison& c : result_.comparisons) judge(c, result_);
    tell("done", 1);
    return std::move(result_);
  }

 private:
  void tell(const std::string& what, double fraction) const {
    if (progress_) progress_(what, fraction);
  }
  void begin(const std::string& what) {
    step_ = fmt::format("[{}/{}] {}", steps_ + 1, all_steps_, what);
    tell(step_, static_cast<double>(steps_++) / all_steps_);
  }

  Stage load(const WorldSpec& spec) {
    Stage stage;
    const auto start = std::chrono::steady_clock::now();
    stage.world = std::make_shared<World>(load_world(spec, [this](std::string_view, double fraction) {
      tell(step_, (steps_ - 1 + fraction) / all_steps_);
    }));
    stage.costs.load_s = seconds_since(start);
    build(stage, input_.materials);
    return stage;
  }

  static void take_down(Stage& stage) {
    stage.own = stage.fine = nullptr;
    stage.scene = nullptr;
  }

  /// Builds and plans anew from the stage's world.
  void build(Stage& stage, const std::vector<Material>& materials) {
    take_down(stage);  // the old one's memory goes first
    stage.scene = std::make_shared<const Scene>(stage.world, materials, input_.threads, input_.rays);
    stage.costs.grid_bytes = grid_bytes(*stage.world);
    stage.costs.building_bytes = building_bytes(stage.world->buildings);
    if (needs_tracer(*stage.scene, input_.settings.frustum)) {
      const EmbreeTracer& tracer = stage.scene->tracer();
      stage.costs.build_s = tracer.build_s();
      stage.costs.tracer_bytes = tracer.bytes();
    }
    std::vector<FieldError> errors;
    const auto pose = place_antenna(*stage.world, input_.pose, errors);
    if (!pose) throw InputError("radar \"" + input_.radar + "\": " + all_text(errors));
    stage.pose = *pose;
    stage.own = plan(stage, input_.settings);
    if (!stage.own->extent().any)
      throw InputError("radar \"" + input_.radar + "\": no known ground in its sector");
    if (columns_factor_ == 0) columns_factor_ = columns_factor(input_.settings, stage.world->grid.cell_m);
    stage.fine = plan(stage, comparison(kComparisonSource, kComparisonDensity));
  }

  std::shared_ptr<const FramePlan> plan(const Stage& stage, const RadarSettings& settings) const {
    const auto snapshot = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1});
    const PlanResult planned = plan_frame(stage.scene, snapshot, stage.pose);
    if (!planned.plan) throw InputError("radar \"" + input_.radar + "\": " + all_text(planned.errors));
    return planned.plan;
  }

  RadarSettings comparison(SampleKind source, Density density) const {
    density.columns *= columns_factor_;
    return comparison_settings(input_.settings, source, density);
  }

  std::vector<double> power(const FramePlan& frame) const {
    return render_sample(frame, wedges_, input_.threads, 1, false).power_w;
  }
  std::vector<double> power_by(const Stage& stage, SampleKind source, Density density) const {
    return power(*plan(stage, comparison(source, density)));
  }

  /// Largest differences from the same scene at other densities.
  PowerChange noise_of(const Stage& stage, SampleKind source, const std::vector<double>& power_w) const {
    PowerChange noise;
    for (const Density& density : kOtherDensities)
      noise = larger_of(noise, power_change(power_w, power_by(stage, source, density), ranges_));
    return noise;
  }

  /// Time of the scene's own frame, states included, as the user gets it.
  WedgePlanes own_frame(Stage& stage) const {
    WedgePlanes planes = render_sample(*stage.own, wedges_, input_.threads, kTimings, true);
    stage.costs.frame_s = planes.frame_s;
    stage.costs.spread_s = planes.spread_s;
    return planes;
  }

  /// The machine drifts while the changes are timed: the scene's own time, taken again, tells how much.
  void time_again(Stage& stage) {
    const Costs first = result_.costs;
    own_frame(stage);
    const double slowest_s =
        std::max(first.frame_s + first.spread_s, stage.costs.frame_s + stage.costs.spread_s);
    result_.costs.frame_s = std::min(first.frame_s, stage.costs.frame_s);
    result_.costs.spread_s = slowest_s - result_.costs.frame_s;
  }

  void measure_scene(Stage& stage) {
    begin("the scene as it is");
    wedges_ = even_wedges(input_.settings);
    ranges_ = range_bins_of(stage.fine->bins());
    probes_.emplace(*stage.fine, wedges_);
    note_facts(stage);
    all_steps_ +=
        static_cast<int>(materials_used(*stage.world).size()) + (result_.facts.buildings > 0 ? 2 : 0);
    power_w_ = power(*stage.fine);
    if (std::ranges::none_of(power_w_, [](double w) { return w > 0; }))
      throw InputError("radar \"" + input_.radar +
                       "\": found no power in the bins; allowed: a scene with visible, "
                       "reflecting ground in sector and range");
    result_.unsampled = unsampled_warning(own_frame(stage).stats, input_.settings);
    result_.costs = stage.costs;
    stage.costs.load_s = 0;  // what is made of this world from now on is not loaded again

    begin("sampling noise");
    result_.measurement_noise = noise_of(stage, kComparisonSource, power_w_);
    if (!stage.world->buildings.list.empty()) {
      wall_power_w_ = power_by(stage, kWallSource, kComparisonDensity);
      result_.wall_noise = noise_of(stage, kWallSource, wall_power_w_);
    }
    RadarSettings own = input_.settings;
    own.range_normalisation = false;
    own.power_w = 1;
    own.gain_db = 0;
    result_.frustum_noise = power_change(power_w_, power(*plan(stage, own)), ranges_);
  }

  void note_facts(const Stage& stage) {
    SceneFacts& f = result_.facts;
    const World& world = *stage.world;
    f.scene = input_.scene;
    f.radar = input_.radar;
    f.settings = input_.settings;
    f.materials = input_.materials;
    f.radius_factor = world.frame.radius_factor();
    f.earth_factor = std::isfinite(f.radius_factor) ? f.radius_factor : kStandardEarth;
    f.height_m =
        world.frame.geodetic_from_world(stage.pose.antenna).height_m - stage.own->extent().median_height_m;
    f.range_spacing_m = stage.own->bins().range_spacing_m;
    f.cell_m = world.grid.cell_m;
    f.nodes = world.grid.y_m.size();
    f.source_error = world.report.source_error;
    f.buildings = world.buildings.list.size();
    f.sizes = median_sizes(world.buildings);
    if (f.buildings > 0) f.building_material = world.buildings.list.front().material;
    f.flat_plates = flat_plates_used(world, f.materials);
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

  void compare_speckle(Stage& stage) {
    begin("speckle");
    const auto frame = [&](SpeckleKind kind) {
      RadarSettings settings = input_.settings;
      settings.speckle = kind;
      return render_sample(*plan(stage, settings), wedges_, input_.threads, kTimings, true);
    };
    const WedgePlanes ground = frame(SpeckleKind::ground);
    const WedgePlanes geometric = frame(SpeckleKind::geometric);
    result_.ground_speckle = measure_speckle(ground);
    result_.geometric_speckle = measure_speckle(geometric);
    const bool is_ground = input_.settings.speckle == SpeckleKind::ground;
    Comparison c = named(Ingredient::speckle, "speckle", is_ground ? "geometric" : "ground");
    RangeBins ranges = ranges_;
    ranges.range_normalisation = input_.settings.range_normalisation;
    c.power = power_change(ground.power_w, geometric.power_w, ranges);
    c.costs = result_.costs;
    c.costs.build_s = 0;  // nothing is made anew
    c.costs.frame_s = is_ground ? geometric.frame_s : ground.frame_s;
    c.costs.load_s = 0;
    keep(std::move(c));
  }

  void compare_materials(Stage& stage) {
    for (const std::uint8_t id : materials_used(*stage.world)) {
      Comparison c = named(Ingredient::material, "material " + input_.materials[id].name, "as terrain");
      begin(c.name + ", " + c.change);
      c.material = id;
      c.on_buildings = std::ranges::any_of(stage.world->buildings.list,
                                           [&](const Building& building) { return building.material == id; });
      std::vector<Material> materials = input_.materials;
      materials[id] = materials[0];
      build(stage, materials);
      finish(c, stage, power_w_);
      keep(std::move(c));
    }
  }

  void compare_buildings(Stage& stage) {
    if (stage.world->buildings.list.empty()) return;
    const auto compare = [&](Ingredient ingredient, const std::string& name, const std::string& change) {
      Comparison c = named(ingredient, name, change);
      begin(name + ", " + change);
      build(stage, input_.materials);
      finish(c, stage, ingredient == Ingredient::walls ? wall_power_w_ : power_w_);
      keep(std::move(c));
    };
    // No one else holds this world between two scenes: it may be changed.
    take_down(stage);
    stage.world->buildings = without_walls(stage.world->buildings);
    compare(Ingredient::walls, "building walls", "roofs only");
    take_down(stage);
    stage.world->buildings = {};
    compare(Ingredient::buildings, "buildings", "none");
  }

  /// Compares the stage's bins, and its ground where it may have moved.
  void finish(Comparison& c, Stage& stage, const std::vector<double>& against_w) {
    const bool walls = c.ingredient == Ingredient::walls;
    c.power = power_change(
        against_w, walls ? power_by(stage, kWallSource, kComparisonDensity) : power(*stage.fine), ranges_);
    own_frame(stage);
    c.costs = stage.costs;
  }

  /// Loads a changed world and compares it; what cannot be loaded or rendered becomes the reason.
  void compare_world(Comparison& c, const WorldSpec& spec, const std::vector<double>& against_w,
                     const GroundProbes& probes, Stage* kept = nullptr) {
    begin(c.name + ", " + c.change);
    try {
      Stage stage = load(spec);
      finish(c, stage, against_w);
      c.shift = probes.shift_in(*stage.world, stage.pose);
      c.source_error = stage.world->report.source_error;
      if (kept) *kept = std::move(stage);
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
    Stage curved;
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
      const auto free = static_cast<double>(available_bytes());
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
