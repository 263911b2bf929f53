#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "server/accuracy/sampling_case.h"
#include "server/loading/scene_loading.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/radar/unsampled.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

constexpr int kFirstSide = 512;
constexpr int kProbeWedges = 8;

struct Pixels {
  int columns;
  int rows;
  std::int64_t count() const { return std::int64_t{columns} * rows; }
};

class PixelSearch {
 public:
  PixelSearch(const std::shared_ptr<const Scene>& scene, const RadarConfig& radar, const PixelLimits& limits,
              const Progress& progress)
      : scene_(scene),
        radar_(radar),
        limits_(limits),
        progress_(progress),
        pose_(place_radar(scene->world(), radar)) {
    const int n = wedge_count(radar.settings.azimuth_bins);
    const int probes = std::min(n, kProbeWedges);
    for (int k = 0; k < probes; ++k) probe_.push_back(static_cast<int>((k + 0.5) * n / probes));
    for (int k = 0; k < n; ++k) all_.push_back(k);
  }

  /// First both sides on a part of the wedges, then each side alone, but no fewer than one a bin; the whole
  /// frame has the last word.
  Pixels run() {
    const RadarSettings& s = radar_.settings;
    int side = kFirstSide;
    while (side < std::max(s.azimuth_bins, s.range_bins)) side *= 2;
    while (side > 1 && Pixels{side, side}.count() > limits_.most_pixels) side /= 2;
    Pixels pixels{side, side};
    while (!good(pixels, probe_)) pixels = more(pixels);
    const auto shrink = [&](int Pixels::*of, int least) {
      for (Pixels fewer = pixels; fewer.*of / 2 >= least; pixels = fewer) {
        fewer.*of /= 2;
        if (!good(fewer, probe_)) return;
      }
    };
    shrink(&Pixels::columns, s.azimuth_bins);
    shrink(&Pixels::rows, s.range_bins);
    while (!good(pixels, all_)) pixels = more(pixels);
    return pixels;
  }
  double share() const { return share_; }

 private:
  bool good(const Pixels& pixels, const std::vector<int>& wedges) {
    RadarSettings settings = sharp_settings(radar_.settings);
    settings.pixel_columns = pixels.columns;
    settings.pixel_rows = pixels.rows;
    const PlanResult planned =
        plan_frame(scene_, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), pose_);
    if (!planned.plan) throw InputError("radar \"" + radar_.name + "\": " + all_text(planned.errors));
    FrameStats total;
    RenderOptions options;
    options.threads = limits_.threads;
    options.on_wedge = [&](Wedge&& wedge) { total.add(wedge.stats); };
    for (std::size_t k = 0; k < wedges.size(); ++k) {
      if (progress_)
        progress_("looking for pixels", static_cast<double>(k) / static_cast<double>(wedges.size()));
      render_wedges(*planned.plan, {wedges[k] * kWedgeAzimuthBins, 1}, options);
    }
    if (progress_) progress_("looking for pixels", 1);
    share_ = total.unsampled_share();
    return !is_undersampled(total);
  }

  /// Twice as many along the shorter side, or along both.
  Pixels more(Pixels pixels) const {
    const Pixels tried = pixels;
    const bool square = pixels.columns == pixels.rows;
    if (square || pixels.columns < pixels.rows) pixels.columns = std::min(kMostSide, 2 * pixels.columns);
    if (square || tried.rows < tried.columns) pixels.rows = std::min(kMostSide, 2 * pixels.rows);
    if (pixels.count() == tried.count() || pixels.count() > limits_.most_pixels) refuse(tried);
    return pixels;
  }

  [[noreturn]] void refuse(const Pixels& tried) const {
    const std::string text = fmt::format(
        "radar \"{}\": frustum.quality: found \"oblique\", but {} x {} pixels, the most that {}, leave "
        "{:.1f} % of the lit bins without a sample; allowed: a scene where they leave at most {:.0f} % "
        "(fewer bins, a larger radar.r_min_m), or frustum.quality = \"standard\", the sweep",
        radar_.name, tried.columns, tried.rows,
        tried.columns == kMostSide ? "frustum.pixels may be" : "server.max_pixels allows", 100 * share_,
        100 * kMostUnsampled);
    throw InputError(text);
  }

  const std::shared_ptr<const Scene>& scene_;
  const RadarConfig& radar_;
  PixelLimits limits_;
  const Progress& progress_;
  Pose pose_;
  std::vector<int> probe_;
  std::vector<int> all_;
  double share_ = 0;
};

}  // namespace

void find_pixels(const std::shared_ptr<const Scene>& scene, RadarConfig& radar, const PixelLimits& limits,
                 const Say& say, const Progress& progress) {
  if (!radar.finds_pixels) return;
  PixelSearch search(scene, radar, limits, progress);
  const Pixels found = search.run();
  radar.settings.pixel_columns = found.columns;
  radar.settings.planes_per_bin = 0;
  radar.settings.pixel_rows = found.rows;
  const std::string text = fmt::format(
      "radar \"{}\": frustum.quality \"oblique\": {} x {} pixels leave {:.1f} % of the lit bins without a "
      "sample",
      radar.name, found.columns, found.rows, 100 * search.share());
  say(text);
}

}  // namespace obliq
