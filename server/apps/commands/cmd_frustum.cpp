// `obliq frustum`: camera values and step sizes, for a scene or in the paper's simplification.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "server/loading/scene_loading.h"
#include "server/radar/frame_plan.h"
#include "server/radar/geometry/perspective_frustum.h"
#include "server/radar/narrow_bins.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kPaperHeight_m = 1000;  // of Figure 6
constexpr int kPaperPixels = 2048;

struct FrustumArguments {
  SceneArguments scene;
  std::string radar;
  bool flat_check = false;
  bool figure6 = false;
};

/// The paper's Figure 6: r_max 10 to 100 km, r_min = r_max / 10, antenna at 1 km, 2048 rows, as CSV.
void print_figure6() {
  std::printf("r_max_m,symmetric_far_m,symmetric_near_m,oblique_far_m,oblique_near_m\n");
  for (int km = 10; km <= 100; ++km) {
    const double r_max = km * 1000.0;
    const StepSizes s = flat_steps(FrustumKind::symmetric, kPaperHeight_m, r_max / 10, r_max, kPaperPixels);
    const StepSizes o = flat_steps(FrustumKind::oblique, kPaperHeight_m, r_max / 10, r_max, kPaperPixels);
    std::printf("%.0f,%.9g,%.9g,%.9g,%.9g\n", r_max, s.far_m, s.near_m, o.far_m, o.near_m);
  }
}

void print_flat_check() {
  std::printf(
      "Slant-range step between pixel rows over flat ground: antenna at 1 km, 2048 rows, r_min = r_max / "
      "10\n");
  std::printf("%10s %12s %12s %12s %12s\n", "r_max", "symmetric", "", "oblique", "");
  std::printf("%10s %12s %12s %12s %12s\n", "km", "far m", "near m", "far m", "near m");
  for (const double km : {10.0, 37.0, 100.0}) {
    const StepSizes s = flat_steps(FrustumKind::symmetric, kPaperHeight_m, km * 100, km * 1000, kPaperPixels);
    const StepSizes o = flat_steps(FrustumKind::oblique, kPaperHeight_m, km * 100, km * 1000, kPaperPixels);
    std::printf("%10.0f %12.4g %12.4g %12.4g %12.4g\n", km, s.far_m, s.near_m, o.far_m, o.near_m);
  }
}

void print_camera(const FramePlan& plan) {
  const PerspectiveFrustum& f = plan.looks_at().camera();
  const double pitch = f.pitch_rad / kDegree_rad;
  if (f.kind == FrustumKind::symmetric)
    std::printf(
        "  pitch %.4f deg (eq. 6), fields of view %.4f x %.4f deg (eqs. 8, 9), D_n %.2f m, D_f %.2f m\n",
        pitch, f.theta_rad / kDegree_rad, f.phi_rad / kDegree_rad, f.near_m, f.far_m);
  else
    std::printf(
        "  pitch %.0f deg, kappa = D_n %.2f m (eq. 22), D_f %.2f m, sensor %.2f x %.2f m (eqs. 25, 27), "
        "elongation nu "
        "%.2f m (eq. 26), lens shift psi %.2f m (eq. 28)\n",
        pitch, f.near_m, f.far_m, f.right_m - f.left_m, f.top_m - f.bottom_m, f.elongation_m, f.lens_shift_m);
  const double top = plan.looks_at().box().kappa_m;
  const double bottom = plan.looks_at().box().antenna_above_bottom_m;
  if (top > 0) {
    const StepSizes steps = slant_range_steps(f, top);
    std::printf("  slant-range step at the terrain top:    far %10.4g m, near %10.4g m\n", steps.far_m,
                steps.near_m);
  }
  const StepSizes steps = slant_range_steps(f, bottom);
  std::printf("  slant-range step at the terrain bottom: far %10.4g m, near %10.4g m", steps.far_m,
              steps.near_m);
  if (f.kind == FrustumKind::oblique) std::printf(" (%.3g times coarser)", bottom / top);
  std::printf("\n");
}

void print_sweep(const FramePlan& plan) {
  const RadarSettings& s = plan.settings();
  const RadarSettings narrow = narrow_frame(s);
  const int columns = sweep_columns_per_bin(narrow) * narrow.azimuth_bins;
  const double column_rad = s.sector_deg * kDegree_rad / columns;
  std::printf("sweep, %d vertical planes, %d an azimuth bin, more where buildings are\n", columns,
              columns / s.azimuth_bins);
  std::printf("  exact in range; planes %.4g deg apart: %.4g m at r_min, %.4g m at r_max\n",
              column_rad / kDegree_rad, column_rad * s.r_min_m, column_rad * s.r_max_m);
}

void print_scene(const SceneConfig& config, const FrustumArguments& arguments) {
  const RadarConfig& radar = choose_radar(config, arguments.radar);
  const auto world = load_world_with_report(config);
  const auto scene = std::make_shared<const Scene>(world, config.materials, config.threads);
  const Pose pose = place_radar(*world, radar);
  bool first = true;
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    RadarSettings settings = radar.settings;
    settings.frustum = kind;
    const std::string name = frustum_name(kind);
    const PlanResult result =
        plan_frame(scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), pose);
    if (!result.plan) {
      std::printf("%s: not possible here\n", name.c_str());
      for (const FieldError& error : result.errors) std::printf("  %s\n", error.text().c_str());
      continue;
    }
    const FramePlan& plan = *result.plan;
    if (!plan.looks_at().extent().any)
      throw InputError("radar \"" + radar.name + "\": no known ground in its sector");
    if (first) {
      const SectorBox& box = plan.looks_at().box();
      std::printf(
          "sector box: antenna %.2f m above its bottom, ground and roofs rise %.2f m; ground range %.1f to "
          "%.1f m\n",
          box.antenna_above_bottom_m, box.height_m, box.g_min_m, box.g_max_m);
      first = false;
    }
    if (kind == FrustumKind::sweep) {
      print_sweep(plan);
      continue;
    }
    std::printf("%s, %d x %d pixels\n", name.c_str(), settings.pixel_columns, settings.pixel_rows);
    print_camera(plan);
  }
}

void run(const FrustumArguments& arguments) {
  if (arguments.figure6) return print_figure6();
  if (arguments.flat_check) return print_flat_check();
  if (arguments.scene.file.empty())
    throw InputError("frustum: found no scene file; allowed: SCENE, --flat-check or --figure6");
  if (auto config = open_scene(arguments.scene)) {
    say_notes(*config);
    meet_accuracy(*config, say_on_terminal, terminal_progress());
    config->accuracy = {};  // done
    say_accuracy_is_ignored(*config, "frustum");
    print_scene(*config, arguments);
  }
}

}  // namespace

void add_frustum(CLI::App& app) {
  CLI::App* command = app.add_subcommand("frustum", "Print camera values and range steps of the frusta");
  auto arguments = std::make_shared<FrustumArguments>();
  add_scene_arguments(*command, "SCENE", arguments->scene);
  command->get_option("SCENE")->required(false);
  add_radar_argument(*command, arguments->radar);
  command->add_flag("--flat-check", arguments->flat_check,
                    "Step sizes over flat ground, the paper's simplification");
  command->add_flag("--figure6", arguments->figure6, "The paper's Figure 6 as CSV");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
