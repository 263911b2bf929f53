#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "server/frontier/frontier_table.h"
#include "server/frontier/log_axis.h"
#include "server/output/picture_canvas.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kWidth = 1000;
constexpr double kHeight = 950;
constexpr double kPngScale = 1.6;  // sharp at the width of a README on a fine screen
constexpr double kNoneBand = 26;   // height of the strip that holds values of zero

// Okabe and Ito's palette, told apart by the colour-blind.
constexpr Colour kWhite{1, 1, 1};
constexpr Colour kText{0.13, 0.14, 0.16};
constexpr Colour kSoft{0.42, 0.44, 0.47};
constexpr Colour kRule{0.88, 0.89, 0.90};

Colour colour_of(FrustumKind kind) {
  switch (kind) {
    case FrustumKind::symmetric:
      return {0.55, 0.55, 0.55};
    case FrustumKind::oblique:
      return {0.835, 0.369, 0};
    default:
      return {0, 0.620, 0.451};
  }
}

struct Measure {
  const char* title;
  double FrontierRow::*value;
  double factor;  ///< from the row's number to the label's
  const char* unit;
};
constexpr Measure kMeasures[4] = {
    {"Power error E", &FrontierRow::power_error, 1, ""},
    {"Median error of a bin, dB", &FrontierRow::median_db, 1, ""},
    {"Gaps: lit bins without a return", &FrontierRow::gap_fraction, 100, " %"},
    {"False light: dark bins with one", &FrontierRow::false_light_fraction, 100, " %"},
};

/// Whether a row has that measure at all: none where nothing is lit, no decibels where no lit bin is filled.
bool has(const FrontierRow& row, const Measure& measure) {
  if (measure.value == &FrontierRow::false_light_fraction) return true;
  return measure.value == &FrontierRow::median_db ? row.has_decibels() : row.lit > 0;
}

struct Box {
  double x, y, width, height;
};

class Plot {
 public:
  Plot(cairo_t* context, const FrontierHeader& header, const std::vector<FrontierRow>& rows)
      : c_(context), header_(header) {
    for (const FrontierRow& row : rows)
      if (row.returns == Returns::all && row.possible()) rows_.push_back(row);
  }

  void draw() {
    ink(kWhite);
    cairo_paint(c_);
    cairo_set_line_join(c_, CAIRO_LINE_JOIN_ROUND);
    ink(kText);
    face(true);
    text(32, 42, 23, "What a frame costs, and how wrong it is", 0);
    face(false);
    ink(kSoft);
    text(32, 65, 13.5, header_.scene + ": " + header_.view, 0);
    text(32, 84, 13.5, machine_text(header_), 0);
    legend();
    const double width = 428;
    const double height = 306;
    for (int k = 0; k < 4; ++k)
      panel({68 + (k % 2) * (width + 56), 196 + (k / 2) * (height + 76), width, height}, kMeasures[k]);
  }

 private:
  void ink(const Colour& c, double alpha = 1) { cairo_set_source_rgba(c_, c.red, c.green, c.blue, alpha); }
  void face(bool bold) {
    cairo_select_font_face(c_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  }

  double text(double x, double y, double size, const std::string& words, double align) {
    cairo_set_font_size(c_, size);
    cairo_text_extents_t box;
    cairo_text_extents(c_, words.c_str(), &box);
    cairo_move_to(c_, x - align * box.x_advance, y);
    cairo_show_text(c_, words.c_str());
    return box.x_advance;
  }

  // ---- Marks ----

  void circle(double x, double y, double radius) {
    cairo_new_path(c_);
    cairo_arc(c_, x, y, radius, 0, 2 * kPi);
  }

  /// One corner up; every other one is nearer by that factor.
  void polygon(double x, double y, double radius, int corners, double inner = 1) {
    cairo_new_path(c_);
    for (int k = 0; k < corners; ++k) {
      const double r = k % 2 == 0 ? radius : inner * radius;
      cairo_line_to(c_, x + r * std::sin(2 * kPi * k / corners), y - r * std::cos(2 * kPi * k / corners));
    }
    cairo_close_path(c_);
  }
  void triangle(double x, double y) { polygon(x, y, 5.2, 3); }
  void star(double x, double y, double radius) { polygon(x, y, radius, 10, 0.42); }

  /// Full for plates that spread (and the sweep), hollow for nearest bins.
  void fill_mark(const Colour& colour, bool hollow) { outlined(hollow ? kWhite : colour, colour, 1.8); }
  void outlined(const Colour& inside, const Colour& outline, double width) {
    ink(inside);
    cairo_fill_preserve(c_);
    ink(outline);
    cairo_set_line_width(c_, width);
    cairo_stroke(c_);
  }

  void mark(const FrontierRow& row, double x, double y) {
    const Colour colour = colour_of(row.sampling.kind);
    if (row.sampling.cell_m != header_.scene_cell_m) {
      triangle(x, y);
      fill_mark(colour, true);
    } else if (is_paper_sampling(row.sampling)) {
      star(x, y, 11.5);
      outlined(colour, kWhite, 1.2);
    } else {
      circle(x, y, 4.6);
      fill_mark(colour, row.sampling.plates == PlateKind::nearest);
    }
  }

  void legend() {
    const double y = 118;
    double x = 32;
    face(true);
    for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
      if (std::ranges::none_of(rows_, [&](const auto& r) { return r.sampling.kind == kind; })) continue;
      circle(x + 6, y - 5, 5.5);
      ink(colour_of(kind));
      cairo_fill(c_);
      x += 18 + text(x + 18, y, 14, frustum_name(kind), 0) + 22;
    }
    face(false);
    x = 32;
    const double at = y + 21.5;
    const auto entry = [&](const char* words, const Colour& colour, bool hollow) {
      fill_mark(colour, hollow);
      ink(kText);
      x += 16 + text(x + 16, y + 26, 13, words, 0) + 18;
    };
    if (std::ranges::any_of(rows_, [&](const auto& r) { return is_scene_paper(r); })) {
      x += 5;
      star(x + 5, at, 10);
      entry(" the paper's setting, 2048 x 2048", colour_of(FrustumKind::oblique), false);
    }
    circle(x + 5, at, 4.6);
    entry("nearest bin", kSoft, true);
    circle(x + 5, at, 4.6);
    entry("spread over bins, or sweep", kSoft, false);
    if (std::ranges::any_of(rows_,
                            [&](const auto& r) { return r.sampling.cell_m != header_.scene_cell_m; })) {
      triangle(x + 5, at + 1);
      entry("coarser ground grid", kSoft, true);
    }
    ink(kSoft);
    text(kWidth - 36, y, 13.5, "lower left is better: quicker and closer to the truth", 1);
  }

  // ---- Panels ----

  struct Axes {
    Box box;
    LogAxis time;
    LogAxis error;
    bool zeros;     ///< some values are 0 and lie in a strip of their own
    bool all_zero;  ///< then the axis means nothing

    double x(double ms) const { return box.x + time.place(ms) * box.width; }
    double y(double value) const {
      const double floor = box.y + box.height;
      if (!(value > 0)) return floor - kNoneBand / 2;
      const double top = box.height - (zeros ? kNoneBand : 0);
      return box.y + (1 - error.place(value)) * top;
    }
  };

  void panel(const Box& box, const Measure& measure) {
    std::vector<double> times;
    std::vector<double> values;
    std::size_t shown = 0;
    for (const FrontierRow& row : rows_) {
      times.push_back(row.frame_ms);
      if (!has(row, measure)) continue;
      ++shown;
      if (row.*measure.value > 0) values.push_back(row.*measure.value);
    }
    const Axes axes{box, LogAxis(times, 1), LogAxis(values, 1), values.size() < shown, values.empty()};
    grid(axes, measure);
    face(true);
    ink(kText);
    text(box.x, box.y - 11, 14.5, measure.title, 0);
    face(false);
    if (rows_.empty()) return;
    lines(axes, measure);
    for (const bool paper : {false, true})  // the star on top
      for (const FrontierRow& row : rows_)
        if (paper == is_scene_paper(row) && has(row, measure))
          mark(row, axes.x(row.frame_ms), axes.y(row.*measure.value));
  }

  bool is_scene_paper(const FrontierRow& row) const {
    return is_paper_sampling(row.sampling) && row.sampling.cell_m == header_.scene_cell_m;
  }

  void rule(double x0, double y0, double x1, double y1, double width) {
    cairo_set_line_width(c_, width);
    cairo_move_to(c_, x0, y0);
    cairo_line_to(c_, x1, y1);
    cairo_stroke(c_);
  }

  void grid(const Axes& axes, const Measure& measure) {
    const Box& b = axes.box;
    const double floor = b.y + b.height;
    face(false);
    const auto line = [&](const std::string& label, double x0, double y0, double x1, double y1) {
      ink(kRule, label.empty() ? 0.5 : 1);
      rule(x0, y0, x1, y1, 1);
      ink(kSoft);
    };
    for (const auto& [value, label] : axes.time.ticks(1, "")) {
      const double x = axes.x(value);
      line(label, x, b.y, x, floor);
      if (!label.empty()) text(x, floor + 18, 12.5, label, 0.5);
    }
    for (const auto& [value, label] : axes.error.ticks(measure.factor, measure.unit)) {
      if (axes.all_zero) break;
      const double y = axes.y(value);
      line(label, b.x, y, b.x + b.width, y);
      if (!label.empty()) text(b.x - 7, y + 4.5, 12.5, label, 1);
    }
    if (axes.zeros) {
      ink(kRule, 0.55);
      cairo_rectangle(c_, b.x, floor - kNoneBand, b.width, kNoneBand);
      cairo_fill(c_);
      ink(kSoft);
      text(b.x - 7, floor - kNoneBand / 2 + 4.5, 12.5, "none", 1);
    }
    ink(kSoft);
    rule(b.x, floor, b.x + b.width, floor, 1.2);
    text(b.x + b.width, floor + 36, 12.5, "time of a whole frame, ms", 1);
  }

  /// Joins, for each kind and way with plates, the samplings over the scene's ground that none of the same is
  /// both quicker and better than.
  void lines(const Axes& axes, const Measure& measure) {
    for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep})
      for (const PlateKind plates : {PlateKind::nearest, PlateKind::spread}) {
        std::vector<const FrontierRow*> series;
        for (const FrontierRow& row : rows_)
          if (has(row, measure) && row.sampling.kind == kind && row.sampling.plates == plates &&
              row.sampling.cell_m == header_.scene_cell_m)
            series.push_back(&row);
        std::ranges::sort(series, {}, [](const FrontierRow* row) { return row->frame_ms; });
        ink(colour_of(kind), 0.55);
        cairo_set_line_width(c_, 2);
        const double dashes[] = {5, 4};
        cairo_set_dash(c_, dashes, plates == PlateKind::nearest ? 2 : 0, 0);
        cairo_new_path(c_);
        double best = std::numeric_limits<double>::infinity();
        for (const FrontierRow* row : series) {
          if (row->*measure.value >= best) continue;
          best = row->*measure.value;
          cairo_line_to(c_, axes.x(row->frame_ms), axes.y(best));
        }
        cairo_stroke(c_);
        cairo_set_dash(c_, nullptr, 0, 0);
      }
  }

  cairo_t* c_;
  const FrontierHeader& header_;
  std::vector<FrontierRow> rows_;
};

void draw_on(cairo_surface_t* surface, double scale, const std::filesystem::path& path,
             const FrontierHeader& header, const std::vector<FrontierRow>& rows, bool png) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> owned(surface, cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface), cairo_destroy);
  cairo_scale(context.get(), scale, scale);
  Plot(context.get(), header, rows).draw();
  cairo_status_t status = cairo_status(context.get());
  if (status == CAIRO_STATUS_SUCCESS && png) status = cairo_surface_write_to_png(surface, path.c_str());
  cairo_surface_finish(surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS)
    throw InputError(path.string() + ": cannot be written (" + cairo_status_to_string(status) + ")");
}

}  // namespace

void draw_frontier(const std::filesystem::path& folder, const FrontierHeader& header,
                   const std::vector<FrontierRow>& rows) {
  const auto svg = folder / "frontier.svg";
  const auto png = folder / "frontier.png";
  draw_on(cairo_svg_surface_create(svg.c_str(), kWidth, kHeight), 1, svg, header, rows, false);
  draw_on(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kWidth * kPngScale),
                                     static_cast<int>(kHeight * kPngScale)),
          kPngScale, png, header, rows, true);
}

}  // namespace obliq
