#include <cairo.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "server/output/describe_frame.h"
#include "server/output/picture_caption.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kFont = 12;
constexpr double kRingGap_px = 18;  // labels of rings that are nearer to each other would touch

class Overlay {
 public:
  Overlay(PictureCanvas& canvas, const MapProjection& projection, const GroundMap& map, double left,
          double top)
      : canvas_(canvas),
        projection_(projection),
        map_(map),
        left_(left),
        top_(top),
        sector_(projection.sector()) {}

  void draw() {
    draw_bearings();
    draw_outline();
    draw_rings();
    draw_antenna();
  }

 private:
  struct Point {
    double x, y;
  };

  Point on_picture(MapProjection::Place place) const {
    const double sine = std::sin(map_.up_rad);
    const double cosine = std::cos(map_.up_rad);
    const double right = place.east_m * cosine - place.north_m * sine;
    const double ahead = place.east_m * sine + place.north_m * cosine;
    return {left_ + (right - map_.left_m) / map_.pixel_m, top_ + (map_.top_m - ahead) / map_.pixel_m};
  }
  Point at(double bearing, double slant_m) const { return on_picture(projection_.place(bearing, slant_m)); }
  double end() const { return sector_.start_rad + sector_.width_rad; }
  /// Where the rings have their labels: at the right edge, or all round between two bearings.
  double label_bearing() const { return sector_.all_round() ? end() - kPi / 12 : end(); }

  void arc(double slant_m) {
    const int steps = std::max(2, static_cast<int>(std::ceil(sector_.width_rad / (kPi / 90))));
    cairo_t* c = canvas_.cairo();
    cairo_new_sub_path(c);
    for (int i = 0; i <= steps; ++i) {
      const Point p = at(sector_.start_rad + sector_.width_rad * i / steps, slant_m);
      cairo_line_to(c, p.x, p.y);
    }
  }

  /// The unit vector from one place to another; up where they are the same.
  static Point direction(Point from, Point to) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    return length > 0 ? Point{(to.x - from.x) / length, (to.y - from.y) / length} : Point{0, -1};
  }

  void draw_outline() {
    arc(sector_.r_max_m);
    arc(sector_.r_min_m);
    if (!sector_.all_round()) {
      for (const double bearing : {sector_.start_rad, end()}) {
        const Point inner = at(bearing, sector_.r_min_m);
        const Point outer = at(bearing, sector_.r_max_m);
        cairo_move_to(canvas_.cairo(), inner.x, inner.y);
        cairo_line_to(canvas_.cairo(), outer.x, outer.y);
      }
    }
    canvas_.stroke(kGrid, 1.1, 0.9);
  }

  /// Beside the right edge; in the middle of it where the sector goes all round.
  void ring_label(double slant_m) {
    const Point p = at(label_bearing(), slant_m);
    const std::string words = distance_text(slant_m);
    if (sector_.all_round()) {
      canvas_.label(p.x, p.y, words, kFont, kInk);
      return;
    }
    const Point along = direction(at(end(), sector_.r_min_m), at(end(), sector_.r_max_m));
    const Point away{-along.y, along.x};  // clockwise of the edge, y pointing down
    const double gap = std::abs(away.x) * (PictureCanvas::text_width(words, kFont) / 2 + 6) +
                       std::abs(away.y) * (kFont / 2 + 4) + 3;
    canvas_.label(p.x + away.x * gap, p.y + away.y * gap, words, kFont, kInk);
  }

  void draw_rings() {
    const double span_m = sector_.r_max_m - sector_.r_min_m;
    const double step_m = round_step(std::max(span_m, sector_.r_max_m / 4) / 3);
    const Point inner = at(label_bearing(), sector_.r_min_m);
    const Point outer = at(label_bearing(), sector_.r_max_m);
    std::vector<double> labels = {sector_.r_max_m};
    const auto far = [](Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y) >= kRingGap_px; };
    const bool inner_label = sector_.r_min_m > 0 && far(inner, outer) && far(inner, on_picture({0, 0}));
    if (inner_label) labels.push_back(sector_.r_min_m);
    for (double r = (std::floor(sector_.r_min_m / step_m) + 1) * step_m; r < sector_.r_max_m * 0.9999;
         r += step_m) {
      const Point p = at(label_bearing(), r);
      if (inner_label ? !far(p, inner) : !far(p, on_picture({0, 0}))) continue;
      arc(r);
      canvas_.stroke(kGrid, 1, 0.8);
      if (far(p, outer)) labels.push_back(r);
    }
    for (const double r : labels) ring_label(r);
  }

  void draw_bearings() {
    const double degrees = sector_.width_rad / kDegree_rad;
    const double step_deg = degrees > 90 ? 30 : degrees > 30 ? 15 : degrees > 8 ? 5 : degrees > 2 ? 1 : 0;
    if (step_deg == 0) return;
    const double start_deg = sector_.start_rad / kDegree_rad;
    const double end_deg = start_deg + degrees;
    const double last_deg = sector_.all_round() ? end_deg - step_deg / 2 : end_deg + 1e-6;
    for (double b = std::ceil(start_deg / step_deg - 1e-6) * step_deg; b <= last_deg; b += step_deg) {
      const Point inner = at(b * kDegree_rad, sector_.r_min_m);
      const Point outer = at(b * kDegree_rad, sector_.r_max_m);
      cairo_move_to(canvas_.cairo(), inner.x, inner.y);
      cairo_line_to(canvas_.cairo(), outer.x, outer.y);
      canvas_.stroke(kGrid, 0.8, 0.4);
      const Point out = direction(on_picture({0, 0}), outer);
      const std::string words = fmt::format("{:03.0f}°", compass_deg(b));
      canvas_.label(outer.x + 20 * out.x, outer.y + 14 * out.y, words, kFont, kInk);
    }
  }

  /// A triangle that points along the sector; an arrow towards it, with the distance, where it is off the
  /// map.
  void draw_antenna() {
    const Point p = on_picture({0, 0});
    const double middle = sector_.start_rad + sector_.width_rad / 2;
    const Point ahead = direction(p, at(middle, sector_.r_max_m));
    const bool inside =
        p.x >= left_ - 1 && p.x <= left_ + map_.width + 1 && p.y >= top_ - 1 && p.y <= top_ + map_.height + 1;
    if (inside) {
      triangle(p, ahead, 10);
      return;
    }
    const Point foot = at(middle, sector_.r_min_m);
    triangle({foot.x - 12 * ahead.x, foot.y - 12 * ahead.y}, {-ahead.x, -ahead.y}, 7);
    const double away_m = std::hypot(foot.x - p.x, foot.y - p.y) * map_.pixel_m;
    canvas_.label(foot.x - 34 * ahead.x, foot.y - 34 * ahead.y,
                  "antenna " + distance_text(std::round(away_m / 10) * 10), kFont, kInk);
  }

  void triangle(Point p, Point ahead, double size) {
    cairo_t* c = canvas_.cairo();
    cairo_move_to(c, p.x + size * ahead.x, p.y + size * ahead.y);
    cairo_line_to(c, p.x - 0.6 * size * ahead.x - 0.6 * size * ahead.y,
                  p.y - 0.6 * size * ahead.y + 0.6 * size * ahead.x);
    cairo_line_to(c, p.x - 0.6 * size * ahead.x + 0.6 * size * ahead.y,
                  p.y - 0.6 * size * ahead.y - 0.6 * size * ahead.x);
    cairo_close_path(c);
    canvas_.ink(kWarning);
    cairo_fill_preserve(c);
    canvas_.ink({0, 0, 0}, 0.8);
    cairo_set_line_width(c, 1.2);
    cairo_stroke(c);
  }

  PictureCanvas& canvas_;
  const MapProjection& projection_;
  const GroundMap& map_;
  double left_;
  double top_;
  MapSector sector_;
};

}  // namespace

void draw_overlay(PictureCanvas& canvas, const MapProjection& projection, const GroundMap& map, double left,
                  double top) {
  Overlay(canvas, projection, map, left, top).draw();
}

double round_step(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (most >= factor * power) return factor * power;
  return power;
}

std::string distance_text(double metres) {
  return metres >= 1000 ? fmt::format("{:.4g} km", metres / 1000) : fmt::format("{:.4g} m", metres);
}

}  // namespace obliq
