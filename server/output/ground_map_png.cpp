#include "server/output/ground_map_png.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/output/frame_json.h"
#include "terrain/constants.h"
#include "terrain/errors.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPictureSide = 1400;  ///< longer side of the map in the picture, pixels
constexpr int kMargin = 46;
constexpr int kCaption = 92;

struct Colour {
  double red, green, blue;
};
constexpr Colour kPaper{0.06, 0.07, 0.08};
constexpr Colour kInk{0.82, 0.86, 0.84};
constexpr Colour kGrid{0.25, 0.62, 0.55};
constexpr Colour kShadow{0, 0, 0};
constexpr Colour kNotSampled{0.10, 0.13, 0.32};
constexpr Colour kNoSurface{0.24, 0.17, 0.10};

struct Surface {
  explicit Surface(int width, int height)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)) {}
  ~Surface() { cairo_surface_destroy(surface); }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  cairo_surface_t* surface;
};

std::uint32_t packed(const Colour& c) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

/// Brightness of a map pixel in dB with the display's range compensation; NaN-free: callers check for a
/// value.
double shown_db(const GroundMap& map, std::size_t pixel, bool compensate) {
  const double db = static_cast<double>(map.magnitude_db[pixel]);
  return compensate ? db + 40 * std::log10(static_cast<double>(map.slant_range_m[pixel])) : db;
}

/// Grey with a hint of phosphor.
Colour grey(double level) { return {level * 0.96, level, level * 0.94}; }

class Picture {
 public:
  Picture(const GroundMap& map, const wire::FrameDescriptor& d, const wire::FrameSummary& s)
      : map_(map),
        d_(d),
        s_(s),
        scale_(std::min(static_cast<double>(kPictureSide) / std::max(map.width, map.height), 4.0)),
        map_width_(static_cast<int>(std::ceil(map.width * scale_))),
        map_height_(static_cast<int>(std::ceil(map.height * scale_))),
        width_(std::max(map_width_, 760) + 2 * kMargin),
        height_(map_height_ + 2 * kMargin + kCaption),
        left_((width_ - map_width_) / 2),
        surface_(width_, height_),
        compensate_(!d.settings().range_normalisation()) {
    find_grey_range();
  }

  void draw() {
    draw_pixels();
    std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface_.surface), cairo_destroy);
    c_ = context.get();
    cairo_select_font_face(c_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    draw_rings();
    draw_bearings();
    draw_caption();
    c_ = nullptr;
  }

  void save(const std::filesystem::path& path) {
    const cairo_status_t status = cairo_surface_write_to_png(surface_.surface, path.c_str());
    if (status != CAIRO_STATUS_SUCCESS)
      throw InputError(path.string() + ": cannot be written (" + cairo_status_to_string(status) + ")");
  }

 private:
  void find_grey_range() {
    std::vector<double> values;
    for (std::size_t pixel = 0; pixel < map_.magnitude_db.size(); ++pixel)
      if (map_.magnitude_db[pixel] != GroundMap::kNoValue)
        values.push_back(shown_db(map_, pixel, compensate_));
    if (values.empty()) return;
    const auto percentile = [&](double p) {
      const auto k = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + k, values.end());
      return values[static_cast<std::size_t>(k)];
    };
    black_db_ = percentile(0.05);
    white_db_ = std::max(percentile(0.997), black_db_ + 10);
  }

  bool without_states() const {
    return std::ranges::find(map_.state, GroundMap::kUnknown) != map_.state.end();
  }

  Colour colour_of(std::size_t pixel) const {
    switch (map_.state[pixel]) {
      case GroundMap::kOutside:
        return kPaper;
      case static_cast<std::uint8_t>(BinState::not_sampled):
        return kNotSampled;
      case static_cast<std::uint8_t>(BinState::shadow):
      case GroundMap::kUnknown:
      case static_cast<std::uint8_t>(BinState::nearer_than_ground):
        return kShadow;
      case static_cast<std::uint8_t>(BinState::sampled):
        break;
      default:  // no surface, and what a later server may say
        return kNoSurface;
    }
    if (map_.magnitude_db[pixel] == GroundMap::kNoValue) return kShadow;
    const double level = (shown_db(map_, pixel, compensate_) - black_db_) / (white_db_ - black_db_);
    return grey(0.06 + 0.94 * std::clamp(level, 0.0, 1.0));
  }

  void draw_pixels() {
    cairo_surface_flush(surface_.surface);
    unsigned char* data = cairo_image_surface_get_data(surface_.surface);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.surface));
    const std::uint32_t paper = packed(kPaper);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        std::uint32_t value = paper;
        const int mx = x - left_;
        const int my = y - kMargin;
        if (mx >= 0 && my >= 0 && mx < map_width_ && my < map_height_) value = averaged(mx, my);
        std::memcpy(data + static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x) * 4, &value, 4);
      }
    }
    cairo_surface_mark_dirty(surface_.surface);
  }

  /// Mean colour of the map pixels under a picture pixel, so that shrinking loses no bright point.
  std::uint32_t averaged(int mx, int my) const {
    const auto range = [&](int at, int limit) {
      const int from = std::min(limit - 1, static_cast<int>(at / scale_));
      const int to = std::clamp(static_cast<int>(std::ceil((at + 1) / scale_)), from + 1, limit);
      return std::pair(from, to);
    };
    const auto [x0, x1] = range(mx, map_.width);
    const auto [y0, y1] = range(my, map_.height);
    Colour sum{0, 0, 0};
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const Colour c = colour_of(static_cast<std::size_t>(y) * static_cast<std::size_t>(map_.width) +
                                   static_cast<std::size_t>(x));
        sum = {sum.red + c.red, sum.green + c.green, sum.blue + c.blue};
      }
    const double n = static_cast<double>(x1 - x0) * (y1 - y0);
    return packed({sum.red / n, sum.green / n, sum.blue / n});
  }

  void ink(const Colour& c, double alpha) { cairo_set_source_rgba(c_, c.red, c.green, c.blue, alpha); }

  void text(double x, double y, double size, const std::string& words, double align) {
    cairo_set_font_size(c_, size);
    cairo_text_extents_t box;
    cairo_text_extents(c_, words.c_str(), &box);
    cairo_move_to(c_, x - align * box.width, y);
    cairo_show_text(c_, words.c_str());
  }

  double x_of(double right_m) const { return left_ + (right_m - map_.left_m) / map_.pixel_m * scale_; }
  double y_of(double ahead_m) const { return kMargin + (map_.top_m - ahead_m) / map_.pixel_m * scale_; }

  double ground_range_m(double slant_m) const {
    return std::sqrt(std::max(0.0, slant_m * slant_m - map_.antenna_above_m * map_.antenna_above_m));
  }

  /// A round step that gives three to seven rings.
  static double ring_step(double span) {
    const double power = std::pow(10.0, std::floor(std::log10(span / 3)));
    for (const double factor : {5.0, 2.0, 1.0})
      if (span / (factor * power) >= 3) return factor * power;
    return power;
  }

  void draw_rings() {
    const double r_min = d_.range_start_m();
    const double r_max = r_min + d_.range_spacing_m() * d_.settings().range_bins();
    const double step = ring_step(r_max);
    const double start = d_.azimuth_start_deg() * kDegree_rad - map_.up_rad;
    const double sector = d_.azimuth_width_deg() * d_.settings().azimuth_bins() * kDegree_rad;
    cairo_set_line_width(c_, 1);
    for (double r = step; r <= r_max * 1.0001; r += step) {
      if (r < r_min) continue;
      const double g = ground_range_m(r) / map_.pixel_m * scale_;
      ink(kGrid, 0.55);
      cairo_new_sub_path(c_);
      cairo_arc(c_, x_of(0), y_of(0), g, start - kPi / 2, start + sector - kPi / 2);
      cairo_stroke(c_);
      char label[32];
      std::snprintf(label, sizeof label, step >= 1000 ? "%.0f km" : "%.1f km", r / 1000);
      const double at = start + sector;
      ink(kGrid, 0.95);
      text(x_of(0) + g * std::sin(at) + 5, y_of(0) - g * std::cos(at) + 4, 12, label, 0);
    }
  }

  void draw_bearings() {
    const double r_min = d_.range_start_m();
    const double r_max = r_min + d_.range_spacing_m() * d_.settings().range_bins();
    const double start_deg = d_.azimuth_start_deg();
    const double end_deg = start_deg + d_.azimuth_width_deg() * d_.settings().azimuth_bins();
    const double step = end_deg - start_deg > 90 ? 30 : end_deg - start_deg > 30 ? 15 : 5;
    const double inner = ground_range_m(r_min) / map_.pixel_m * scale_;
    const double outer = ground_range_m(r_max) / map_.pixel_m * scale_;
    for (double b = std::ceil(start_deg / step) * step; b <= end_deg + 1e-9; b += step) {
      const double at = b * kDegree_rad - map_.up_rad;
      const double s = std::sin(at);
      const double c = std::cos(at);
      ink(kGrid, 0.35);
      cairo_move_to(c_, x_of(0) + inner * s, y_of(0) - inner * c);
      cairo_line_to(c_, x_of(0) + outer * s, y_of(0) - outer * c);
      cairo_stroke(c_);
      char label[16];
      std::snprintf(label, sizeof label, "%03.0f°", std::fmod(b + 720, 360));
      ink(kInk, 0.9);
      text(x_of(0) + (outer + 14) * s, y_of(0) - (outer + 14) * c + 4, 12, label, 0.5);
    }
  }

  void swatch(double x, double y, const Colour& colour, const char* label) {
    ink(colour, 1);
    cairo_rectangle(c_, x, y, 14, 14);
    cairo_fill_preserve(c_);
    ink(kInk, 0.5);
    cairo_stroke(c_);
    ink(kInk, 0.9);
    text(x + 20, y + 12, 12, label, 0);
  }

  void draw_caption() {
    const double y = kMargin * 2 + map_height_ - 4;
    char line[512];
    const std::string kind = enum_word(wire::FrustumKind_Name(d_.settings().frustum()));
    const std::string reference = enum_word(wire::HeightReference_Name(d_.pose().height_reference()));
    ink(kInk, 1);
    const bool sweep = d_.settings().frustum() == wire::SWEEP;
    const std::string columns = std::to_string(d_.settings().pixel_columns());
    const std::string sampling =
        sweep ? "sweep, " + columns + " azimuths"
              : kind + " frustum " + columns + " x " + std::to_string(d_.settings().pixel_rows()) + " px";
    char looks[48];
    if (sweep) {
      std::snprintf(looks, sizeof looks, "%.0f planes", static_cast<double>(s_.rays()));
    } else {
      std::snprintf(looks, sizeof looks, "%.1f M rays", static_cast<double>(s_.rays()) / 1e6);
    }
    std::snprintf(line, sizeof line, "%s · radar %s · %s · %d x %d bins · %.4g GHz", d_.scene_name().c_str(),
                  d_.radar().c_str(), sampling.c_str(), d_.settings().azimuth_bins(),
                  d_.settings().range_bins(), d_.settings().frequency_ghz());
    text(kMargin, y + 16, 14, line, 0);
    std::snprintf(line, sizeof line,
                  "antenna %.5f, %.5f at %.0f m above the %s · bearing %.1f° · %s up · %.1f–%.1f km slant · "
                  "%s · coverage %.1f %%",
                  d_.pose().latitude_deg(), d_.pose().longitude_deg(), d_.pose().height_m(),
                  reference.c_str(), d_.pose().bearing_deg(), map_.up_rad == 0 ? "north" : "bearing",
                  d_.range_start_m() / 1000,
                  (d_.range_start_m() + d_.range_spacing_m() * d_.settings().range_bins()) / 1000, looks,
                  100 * s_.coverage());
    ink(kInk, 0.85);
    text(kMargin, y + 38, 12, line, 0);
    const double bar_y = y + 56;
    for (int k = 0; k < 200; ++k) {
      ink(grey(0.06 + 0.94 * k / 199.0), 1);
      cairo_rectangle(c_, kMargin + k, bar_y, 1.5, 14);
      cairo_fill(c_);
    }
    std::snprintf(line, sizeof line, "%.0f dB of %s%s", white_db_ - black_db_,
                  map_.of_power ? "power" : "|I&Q|", compensate_ ? " x r²" : "");
    ink(kInk, 0.9);
    text(kMargin + 208, bar_y + 12, 12, line, 0);
    swatch(kMargin + 350, bar_y, kShadow, without_states() ? "no echo" : "shadow, altitude hole");
    swatch(kMargin + 520, bar_y, kNotSampled, "not sampled");
    swatch(kMargin + 630, bar_y, kNoSurface, "no known ground");
  }

  const GroundMap& map_;
  const wire::FrameDescriptor& d_;
  const wire::FrameSummary& s_;
  double scale_;
  int map_width_;
  int map_height_;
  int width_;
  int height_;
  int left_;
  Surface surface_;
  bool compensate_;
  double black_db_ = 0;
  double white_db_ = 10;
  cairo_t* c_ = nullptr;
};

}  // namespace

void write_ground_map_png(const std::filesystem::path& path, const GroundMap& map,
                          const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary) {
  Picture picture(map, descriptor, summary);
  picture.draw();
  picture.save(path);
}

}  // namespace obliq
