#include "server/output/ground_map_png.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/output/ground_map.h"
#include "server/output/picture_canvas.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

constexpr int kMargin = 60;       // for labels around the map
constexpr int kLeastWidth = 800;  // the caption has no less
constexpr double kLeastSpan_dB = 10;

/// Whether the picture makes up for the range: of an ideal map, that is not normalised.
bool is_compensated(const wire::FrameDescriptor& d, const BinLevels& levels) {
  return !levels.of_video && !d.settings().range_normalisation() && is_ideal(d.settings());
}

/// The levels of a picture: those of the bins with the display's range compensation.
std::vector<float> shown_levels(const wire::FrameDescriptor& d, const BinLevels& levels, int n_range) {
  std::vector<float> shown = levels.db;
  if (!is_compensated(d, levels)) return shown;
  std::vector<float> compensation(static_cast<std::size_t>(n_range));
  for (std::size_t i = 0; i < compensation.size(); ++i) {
    const double r_m = d.range_start_m() + (static_cast<double>(i) + 0.5) * d.range_spacing_m();
    compensation[i] = static_cast<float>(40 * std::log10(r_m));
  }
  for (std::size_t bin = 0; bin < shown.size(); ++bin)
    if (shown[bin] != BinLevels::kNoValue) shown[bin] += compensation[bin % compensation.size()];
  return shown;
}

/// Of the map's pixels, so that each bin counts by the ground that it covers.
std::optional<DbRange> range_of(const GroundMap& map, const std::vector<float>& shown) {
  constexpr std::size_t kEvery = 7;  // a sample of the pixels says as much as all of them
  std::vector<float> values;
  for (std::size_t pixel = 0; pixel < map.bin.size(); pixel += kEvery)
    if (map.is_bin(pixel) && shown[map.bin[pixel]] != BinLevels::kNoValue)
      values.push_back(shown[map.bin[pixel]]);
  if (values.empty()) return std::nullopt;
  const auto percentile = [&](double p) {
    const auto k = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return static_cast<double>(values[static_cast<std::size_t>(k)]);
  };
  const double low = std::floor(percentile(0.05));
  return DbRange{low, std::max(std::ceil(percentile(0.997)), low + kLeastSpan_dB)};
}

/// The colour of each bin.
std::vector<std::uint32_t> bin_colours(const BinBlock& bins, const BinLevels& levels,
                                       const std::vector<float>& shown, const DbRange& range, bool ideal) {
  std::uint32_t greys[256];
  for (int k = 0; k < 256; ++k) greys[k] = packed(grey_of(k / 255.0));
  const float low = static_cast<float>(range.low);
  const float scale = static_cast<float>(255 / (range.high - range.low));
  std::vector<std::uint32_t> colours(shown.size());
  for (std::size_t bin = 0; bin < shown.size(); ++bin) {
    const bool has_value = shown[bin] != BinLevels::kNoValue;
    switch (!ideal && has_value ? static_cast<std::uint8_t>(BinState::sampled)
                                : state_of(bins, levels, bin)) {
      case static_cast<std::uint8_t>(BinState::sampled):
        break;
      case static_cast<std::uint8_t>(BinState::not_sampled):
        colours[bin] = packed(kNotSampled);
        continue;
      case static_cast<std::uint8_t>(BinState::shadow):
      case static_cast<std::uint8_t>(BinState::nearer_than_ground):
      case kUnknownState:
        colours[bin] = packed(kShadow);
        continue;
      default:  // no surface, and what a later server may say
        colours[bin] = packed(kNoSurface);
        continue;
    }
    const float level = std::clamp((shown[bin] - low) * scale, 0.0f, 255.0f);
    colours[bin] =
        shown[bin] == BinLevels::kNoValue ? packed(kShadow) : greys[static_cast<std::size_t>(level + 0.5f)];
  }
  return colours;
}

/// Each bin's mean with those that share its pixel, so that a picture coarser than the bins loses no bright
/// point.
void soften_ranges(std::vector<std::uint32_t>& colours, int n_range, int bins_a_pixel) {
  const int before = (bins_a_pixel - 1) / 2;
  std::vector<std::uint32_t> row(static_cast<std::size_t>(n_range));
  for (std::size_t start = 0; start < colours.size(); start += row.size()) {
    std::copy_n(colours.begin() + static_cast<std::ptrdiff_t>(start), row.size(), row.begin());
    for (int i = 0; i < n_range; ++i) {
      const int first = std::max(0, i - before);
      const int end = std::min(n_range, i - before + bins_a_pixel);
      std::uint32_t red = 0, green = 0, blue = 0;
      for (int k = first; k < end; ++k) {
        const std::uint32_t c = row[static_cast<std::size_t>(k)];
        red += c >> 16;
        green += c >> 8 & 0xff;
        blue += c & 0xff;
      }
      const auto n = static_cast<std::uint32_t>(end - first);
      colours[start + static_cast<std::size_t>(i)] = red / n << 16 | green / n << 8 | blue / n;
    }
  }
}

void draw_pixels(PictureCanvas& canvas, const GroundMap& map, const std::vector<std::uint32_t>& colours,
                 int left, int top) {
  for (int y = 0; y < map.height; ++y) {
    std::uint32_t* out = canvas.row(top + y) + left;
    const std::uint32_t* bin = &map.bin[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width)];
    for (int x = 0; x < map.width; ++x)
      if (bin[x] < GroundMap::kNoGround) out[x] = colours[bin[x]];
  }
  canvas.pixels_done();
}

/// As one writes it by hand: "√W m²".
std::string written(std::string unit) {
  const auto put = [&](const std::string& plain, const std::string& nice) {
    if (const auto at = unit.find(plain); at != std::string::npos) unit.replace(at, plain.size(), nice);
  };
  put("sqrt(W)", "√W");
  put("m^2", "m²");
  put("m^4", "m⁴");
  return unit;
}

std::string quantity_text(const BinLevels& levels, bool compensated) {
  std::string text = levels.of_video ? "video" : levels.of_power ? "power" : "|I&Q|";
  if (compensated) text += levels.of_power ? " × r⁴" : " × r²";
  return text + ", dB re " +
         written(compensated ? levels.unit + (levels.of_power ? " m^4" : " m^2") : levels.unit);
}

/// What a bin is that stays black.
std::string dark_text(const BinBlock& bins) {
  if (bins.state.empty()) return "no echo";
  const auto nearer = static_cast<std::uint8_t>(BinState::nearer_than_ground);
  return std::ranges::find(bins.state, nearer) == bins.state.end() ? "shadow"
                                                                   : "shadow, no ground at this range";
}

}  // namespace

std::optional<DbRange> write_ground_map_png(const std::filesystem::path& path, const wire::FrameDescriptor& d,
                                            const wire::FrameSummary& summary, const BinBlock& bins,
                                            const PictureOptions& options) {
  const MapProjection projection(d);
  GroundMapRequest request;
  request.up_rad = options.up == MapUp::north ? 0 : d.pose().bearing_deg() * kDegree_rad;
  request.side = options.side;
  request.with_antenna = true;
  const GroundMap map = map_to_ground(projection, bins.n_azimuth, bins.n_range, request);
  const BinLevels levels = bin_levels(d, bins);
  const std::vector<float> shown = shown_levels(d, levels, bins.n_range);
  const std::optional<DbRange> range = options.db_range ? options.db_range : range_of(map, shown);
  const DbRange scale = range.value_or(DbRange{});
  std::vector<std::uint32_t> colours = bin_colours(bins, levels, shown, scale, is_ideal(d.settings()));
  const double bins_a_pixel = std::min<double>(map.pixel_m / d.range_spacing_m(), bins.n_range);
  if (bins_a_pixel >= 1.5) soften_ranges(colours, bins.n_range, static_cast<int>(std::lround(bins_a_pixel)));

  const int width = std::max(map.width, kLeastWidth) + 2 * kMargin;
  const PictureCaption caption({.frame = d,
                                .summary = summary,
                                .time = options.time,
                                .range = scale,
                                .has_echoes = range.has_value(),
                                .quantity = quantity_text(levels, is_compensated(d, levels)),
                                .dark = dark_text(bins),
                                .up_rad = request.up_rad,
                                .pixel_m = map.pixel_m},
                               width - kMargin);
  const int top = kMargin / 2;
  const int caption_top = top + map.height + kMargin;
  PictureCanvas canvas(width, caption_top + static_cast<int>(std::ceil(caption.height())));
  const int left = (width - map.width) / 2;
  draw_pixels(canvas, map, colours, left, top);
  draw_overlay(canvas, projection, map, left, top);
  caption.draw(canvas, kMargin / 2.0, caption_top);
  canvas.save(path);
  return range;
}

std::optional<DbRange> SteadyScale::next(const wire::FrameDescriptor& descriptor) {
  if (given_) return given_;
  std::string settings = descriptor.settings().SerializeAsString();
  if (settings != settings_) kept_.reset();
  settings_ = std::move(settings);
  return kept_;
}

}  // namespace obliq
