#pragma once
// What `obliq explain` has found out about one radar of a scene: plain values, for text, Markdown and CSV
// alike.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/explain/measurement.h"
#include "server/explain/row.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/targets/target.h"
#include "server/scene/ray_method.h"
#include "terrain/base/parallel.h"
#include "terrain/dem/source_error.h"
#include "terrain/world_spec.h"

namespace obliq {

enum class Ingredient { curvature, refraction, cell_size, walls, corners, buildings, material, speckle };

/// Time and memory of one scene.
struct Costs {
  double load_s = 0;    ///< terrain and buildings; 0: not loaded again
  double build_s = 0;   ///< the ray-tracing structure
  double frame_s = 0;   ///< a frame with the scene's own frustum, scaled up from the wedges
  double spread_s = 0;  ///< how much its repetitions differed; of the scene: from first to last in the run
  std::uint64_t grid_bytes = 0;
  std::uint64_t building_bytes = 0;
  std::uint64_t tracer_bytes = 0;

  std::uint64_t bytes() const { return grid_bytes + building_bytes + tracer_bytes; }
};

enum class Verdict {
  needed,
  not_needed,
  beyond_measure,  ///< a change that this measurement's own sampling noise could make up
  not_measured,
};

/// The scene with one ingredient changed, against the scene as it is.
struct Comparison {
  Ingredient ingredient = Ingredient::curvature;
  std::string name;    ///< "earth curvature"
  std::string change;  ///< "flat earth"
  std::string reason;  ///< why it was not measured; empty: it was
  double value = 0;    ///< the changed number: k, or the cell in metres
  std::uint8_t material = 0;
  bool on_buildings = false;  ///< a material that buildings have
  bool power_counts = true;   ///< false: the change in power says more about the cutting than about the scene
  PowerChange power;
  std::optional<GroundShift> shift;  ///< where the ground moves
  Costs costs;
  std::optional<SourceError> source_error;  ///< of a changed grid
  bool adds = false;                        ///< the scene leaves the ingredient out; the change puts it in
  Verdict verdict = Verdict::not_measured;
  bool below_frustum_noise = false;  ///< single bins of the scene's own frustum do not show it
  std::string threshold;             ///< from where on it matters, with the formula
  std::string advice;                ///< the verdict in words
};

/// What the closed forms need to know of the scene.
struct SceneFacts {
  std::string scene;
  std::string radar;
  RadarSettings settings;
  std::vector<Material> materials;
  double radius_factor = 1;       ///< k of the scene; may be infinite
  double earth_factor = 4.0 / 3;  ///< the finite k that curvature and refraction are judged with
  double height_m = 0;            ///< antenna above the sector's median ground
  double range_spacing_m = 0;
  double cell_m = 0;
  std::uint64_t nodes = 0;
  SourceError source_error;
  std::uint64_t buildings = 0;
  BuildingSizes sizes;
  std::uint8_t building_material = 1;
  std::vector<std::string> flat_plates;  ///< names of the materials in use that are
  int threads = 0;
  int measured_azimuth_bins = 0;
  std::size_t ground_points = 0;
  int columns = 0;  ///< of the comparisons, an azimuth bin
};

struct Explanation {
  SceneFacts facts;
  Costs costs;
  PowerChange measurement_noise;          ///< the comparison source against itself at another density
  std::optional<PowerChange> wall_noise;  ///< the same of the rays that walls are compared with
  PowerChange frustum_noise;              ///< the scene's own frustum against the comparison source
  std::string unsampled;  ///< where too many lit bins hold no sample: how many, and what would mend it
  SpeckleMeasure ground_speckle;
  SpeckleMeasure geometric_speckle;
  std::vector<Comparison> comparisons;
  std::vector<ReportRow> radar;  ///< what is between echoes and display
};

/// For a terminal of 100 columns.
std::string plain_report(const Explanation& explanation);
std::string markdown_report(const Explanation& explanation);
/// A header line, then a line for the scene, for each of the two noises and for every comparison; RFC 4180.
std::string csv_report(const Explanation& explanation);

// Tables of sentences: a row more is one more line there, with the values that it names.

/// What the scene is and how it was measured.
std::vector<ReportRow> scene_rows(const Explanation& explanation);
/// What each part of the radar does in this scene's bins, by closed forms and the bins' measured power.
/// `power_of` gives the bins of the wedges for other settings of the radar.
std::vector<ReportRow> radar_rows(const RadarSettings& settings, const AirView& air,
                                  const std::function<std::vector<double>(const RadarSettings&)>& power_of);
/// What its mode makes of Doppler; none of a map.
std::vector<ReportRow> doppler_rows(const FramePlan& plan);
/// What water returns; none of a scene without any.
std::vector<ReportRow> sea_rows(const FramePlan& plan, const AirView& air);
/// What rasters of gamma say of the ground; none where the scene has none.
std::vector<ReportRow> raster_rows(const FramePlan& plan);
/// What a house's wall returns with the ground before it; none where the scene has no corners.
std::vector<ReportRow> corner_rows(const FramePlan& plan);
/// From where on the ingredient matters: a closed form with this scene's own numbers.
std::string threshold_text(const Comparison& comparison, const Explanation& explanation);

/// Frame times that differ by less are not told apart: a twentieth, or what repetitions of any of them and
/// the scene itself from the first to the last measurement differed by. In whole milliseconds, rounded up.
double frame_repeats_within_s(const Explanation& all);

/// Completes a comparison: verdict, threshold and advice.
void judge(Comparison& comparison, const Explanation& all);
/// Sets verdict and below_frustum_noise from the numbers.
void decide(Comparison& comparison, const Explanation& all);

/// Of the lit bins: by more than 1 dB, gone or new.
constexpr double kNoticeableShare = 0.01;

struct ExplainInput {
  std::string scene;
  std::string radar;
  WorldSpec world;
  std::vector<Material> materials;
  RadarSettings settings;
  PoseSettings pose;
  int threads = 0;  ///< 0: all cores
  RayMethod rays = RayMethod::march;
  TargetsPtr targets = nullptr;  ///< null: none
  std::vector<std::string> target_names{};
  std::function<void(const World&)> on_loaded{};  ///< told of the scene as it is, before anything is changed
};

/// The first of its targets, by the radar equation; there are some.
std::vector<ReportRow> target_rows(const FramePlan& plan, const AirView& air, const ExplainInput& input);

/// Renders some wedges of the scene as it is and with one ingredient after the other changed, one changed
/// world in memory at a time. Throws InputError when the scene itself cannot be loaded or rendered; a change
/// that cannot is a comparison with a reason.
Explanation explain_scene(const ExplainInput& input, const Progress& progress = {});

}  // namespace obliq
