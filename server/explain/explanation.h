#pragma once
// What `obliq explain` has found out about one radar of a scene: plain values, for text, Markdown and CSV
// alike.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/explain/measurement.h"
#include "server/explain/power_change.h"
#include "server/explain/variants.h"
#include "terrain/dem/source_error.h"

namespace obliq {

enum class Ingredient { curvature, refraction, cell_size, walls, buildings, material, speckle };

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
  std::vector<std::string> flat_plates;  ///< names of the materials in use that are flat plates
  int threads = 0;
  int measured_azimuth_bins = 0;
  std::size_t ground_points = 0;
  int columns = 0;  ///< of the comparisons, an azimuth bin
};

struct Explanation {
  SceneFacts facts;
  Costs costs;
  PowerChange measurement_noise;  ///< the comparison source against itself at another density
  PowerChange wall_noise;         ///< the same of the source that walls are compared with
  PowerChange frustum_noise;      ///< the scene's own frustum against the comparison source
  std::string unsampled;  ///< where too many lit bins hold no sample: how many, and what would mend it
  SpeckleMeasure ground_speckle;
  SpeckleMeasure geometric_speckle;
  std::vector<Comparison> comparisons;
};

}  // namespace obliq
