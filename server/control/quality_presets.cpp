#include "server/control/quality_presets.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace obliq {
namespace {

constexpr double kMostPixels = 16384;  // the limit of frustum.pixel_columns and pixel_rows

constexpr std::array kPresets{
    QualityPreset{"paper", "oblique", "nearest", 2048, 2048, 0, 0, false,
                  "The paper's own sampling, bit for bit, for comparison.",
                  "529 ms; E 0.75, median 1.7 dB, gaps 45 %, 277 of 1,815 buildings missed"},
    QualityPreset{"oblique", "oblique", "spread", 2048, 2048, 0, 0, true,
                  "The oblique frustum, traced by Embree, with enough pixels to leave at most 3 % of the lit "
                  "bins without a sample; the number is found when the scene is loaded.",
                  "pixels as found"},
    QualityPreset{"draft", "sweep", "spread", 0, 0, 1, 2, false, "Fastest; for interactive pictures.",
                  "370 ms; E 0.011, median 0.043 dB, gaps 1.8 %, no building missed"},
    QualityPreset{"standard", "sweep", "spread", 0, 0, 2, 2, false, "For everyday use.",
                  "497 ms; E 0.0068, median 0.012 dB, gaps 0.81 %, no building missed"},
    QualityPreset{"reference", "sweep", "spread", 0, 0, 8, 2, false, "To judge the others against.",
                  "1491 ms; E 0.0014, median 0.0008 dB, gaps 0.09 %, no building missed"},
};

ConfigNode text_node(std::string_view key, std::string_view text, const ConfigNode& quality) {
  ConfigNode node = quality;
  node.key = key;
  node.value = std::string(text);
  node.raw.clear();
  return node;
}

ConfigNode pixel_node(std::string_view key, int pixels, double per_bin, bool searched,
                      const ConfigNode& quality) {
  ConfigNode node = text_node(key, "", quality);
  node.value = std::int64_t{pixels};
  node.per_bin = pixels > 0 ? 0 : per_bin;
  node.searched = searched;
  return node;
}

}  // namespace

std::span<const QualityPreset> quality_presets() { return kPresets; }

const QualityPreset* find_quality(std::string_view name) {
  const auto found = std::ranges::find(kPresets, name, &QualityPreset::name);
  return found != kPresets.end() ? &*found : nullptr;
}

std::span<const Choice> quality_choices() {
  static const auto choices = [] {
    std::array<Choice, kPresets.size()> names;
    std::ranges::transform(kPresets, names.begin(), [](const QualityPreset& p) { return Choice{p.name}; });
    return names;
  }();
  return choices;
}

std::vector<ConfigNode> quality_nodes(const QualityPreset& preset, const ConfigNode& quality) {
  return {text_node("kind", preset.kind, quality), text_node("plates", preset.plates, quality),
          pixel_node("pixel_columns", preset.columns, preset.columns_per_bin, preset.searched, quality),
          pixel_node("pixel_rows", preset.rows, preset.rows_per_bin, preset.searched, quality)};
}

int pixels_for_bins(double per_bin, int bins) {
  return static_cast<int>(std::lround(std::clamp(per_bin * bins, 1.0, kMostPixels)));
}

}  // namespace obliq
