#include "server/control/quality_presets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/control/planes_per_bin.h"

namespace obliq {
namespace {

constexpr std::array kPresets{
    QualityPreset{"paper", "oblique", "nearest", 2048, 2048, 0, 0, 64, false,
                  "The paper's own sampling, of the same bits since 2026-11, for comparison."},
    QualityPreset{"oblique", "oblique", "spread", 2048, 2048, 0, 0, 64, true,
                  "The oblique frustum, traced by Embree, with enough pixels to leave at most 3 % of the lit "
                  "bins without a sample; the number is found when the scene is loaded."},
    QualityPreset{"draft", "sweep", "spread", 0, 0, 1, 2, 64, false, "Fastest; for interactive pictures."},
    QualityPreset{"standard", "sweep", "spread", 0, 0, 2, 2, 64, false, "For everyday use."},
    QualityPreset{"reference", "sweep", "spread", 0, 0, 8, 2, 0, false, "To judge the others against."},
};

/// Within the limits of frustum.pixel_columns and pixel_rows.
int pixels_for_bins(double per_bin, int bins) {
  return static_cast<int>(std::lround(std::clamp(per_bin * bins, 1.0, double{kMostPlanes})));
}

/// Sets a key to what a short form stands for, unless the same layer or a later one names the key itself.
bool put(ConfigNode& table, std::string_view key, ConfigNode node) {
  node.key = key;
  ConfigNode* there = table.find(key);
  if (there == nullptr) {
    table.items.push_back(std::move(node));
  } else if (there->layer < node.layer) {
    *there = std::move(node);
  } else {
    return false;
  }
  return true;
}

bool put(ConfigNode& table, std::string_view key, Value value, const ConfigNode& quality) {
  ConfigNode node = quality;
  node.value = std::move(value);
  node.raw.clear();
  return put(table, key, std::move(node));
}

/// pixels = 512 or [512, 256] becomes pixel_columns and pixel_rows.
void split_pixels(ConfigNode& frustum) {
  const ConfigNode* found = frustum.find("pixels");
  if (found == nullptr) return;
  const ConfigNode pixels = *found;
  for (const std::string_view side : {"pixel_columns", "pixel_rows"})
    if (const ConfigNode* named = frustum.find(side); named != nullptr && named->layer == pixels.layer)
      return;
  const bool pair = pixels.kind == ConfigNode::Kind::array && pixels.items.size() == 2;
  if (!pair && pixels.kind != ConfigNode::Kind::value) return;
  std::erase_if(frustum.items, [](const ConfigNode& n) { return n.key == "pixels"; });
  put(frustum, "pixel_columns", pair ? pixels.items[0] : pixels);
  put(frustum, "pixel_rows", pair ? pixels.items[1] : pixels);
}

bool is_zero(const ConfigNode& node) {
  const auto* number = std::get_if<std::int64_t>(&node.value);
  return number != nullptr && *number == 0;
}

/// Of a table that names its columns itself: planes_per_bin is 0, unless a later layer than theirs names it.
void end_planes(ConfigNode& frustum) {
  const ConfigNode& columns = *frustum.find("pixel_columns");
  const ConfigNode* planes = frustum.find("planes_per_bin");
  if (planes != nullptr &&
      (planes->layer > columns.layer || !std::holds_alternative<std::int64_t>(planes->value)))
    return;  // the reader refuses what is not a number
  ConfigNode none = columns;
  none.key = "planes_per_bin";
  none.value = std::int64_t{0};
  std::erase_if(frustum.items, [](const ConfigNode& n) { return n.key == "planes_per_bin"; });
  frustum.items.push_back(std::move(none));
}

}  // namespace

int QualityPreset::columns_for(int azimuth_bins) const {
  return columns > 0 ? columns : pixels_for_bins(columns_per_bin, azimuth_bins);
}

int QualityPreset::rows_for(int range_bins) const {
  return rows > 0 ? rows : pixels_for_bins(rows_per_bin, range_bins);
}

int QualityPreset::planes_for(int azimuth_bins) const {
  return kind == "sweep" ? (columns_for(azimuth_bins) + azimuth_bins - 1) / std::max(azimuth_bins, 1) : 0;
}

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

Frustum resolved_frustum(ConfigNode table, int azimuth_bins, int range_bins) {
  split_pixels(table);
  // 0 is as if it were not named.
  std::erase_if(table.items, [](const ConfigNode& n) { return n.key == "planes_per_bin" && is_zero(n); });
  Frustum frustum{std::move(table), {}};
  const ConfigNode* found = frustum.table.find("quality");
  const auto* name = found != nullptr ? std::get_if<std::string>(&found->value) : nullptr;
  const QualityPreset* preset = name != nullptr ? find_quality(*name) : nullptr;
  if (preset != nullptr) {
    const ConfigNode quality = *found;
    std::erase_if(frustum.table.items, [](const ConfigNode& n) { return n.key == "quality"; });
    put(frustum.table, "kind", std::string(preset->kind), quality);
    put(frustum.table, "plates", std::string(preset->plates), quality);
    put(frustum.table, "sub_columns", std::int64_t{preset->sub_columns}, quality);
    put(frustum.table, "planes_per_bin", std::int64_t{preset->planes_for(azimuth_bins)}, quality);
    const bool columns =
        put(frustum.table, "pixel_columns", std::int64_t{preset->columns_for(azimuth_bins)}, quality);
    const bool rows = put(frustum.table, "pixel_rows", std::int64_t{preset->rows_for(range_bins)}, quality);
    frustum.finds_pixels = preset->searched && columns && rows;
    if (!columns) end_planes(frustum.table);
  } else if (frustum.table.find("pixel_columns") != nullptr || frustum.table.find("pixel_rows") != nullptr) {
    frustum.finds_pixels = false;
    if (frustum.table.find("pixel_columns") != nullptr) end_planes(frustum.table);
  }
  return frustum;
}

}  // namespace obliq
