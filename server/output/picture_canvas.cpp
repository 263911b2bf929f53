#include "server/output/picture_canvas.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>

#include "server/output/png_file.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalo = 2.4;       // broader than a line by so much
constexpr double kHaloAlpha = 0.7;  // dark enough to part a line from white ground
constexpr double kPlateAlpha = 0.72;

void choose_face(cairo_t* context, double size, bool bold) {
  cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, size);
}

void rounded_box(cairo_t* c, double x, double y, double width, double height, double radius) {
  cairo_new_sub_path(c);
  cairo_arc(c, x + width - radius, y + radius, radius, -kPi / 2, 0);
  cairo_arc(c, x + width - radius, y + height - radius, radius, 0, kPi / 2);
  cairo_arc(c, x + radius, y + height - radius, radius, kPi / 2, kPi);
  cairo_arc(c, x + radius, y + radius, radius, kPi, 3 * kPi / 2);
  cairo_close_path(c);
}

}  // namespace

std::uint32_t packed(const Colour& c) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

PictureCanvas::PictureCanvas(int width, int height)
    : width_(width),
      height_(height),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      context_(cairo_create(surface_)) {
  if (cairo_surface_status(surface_) != CAIRO_STATUS_SUCCESS) {
    cairo_destroy(context_);
    cairo_surface_destroy(surface_);
    throw std::bad_alloc();
  }
  ink(kPaper);
  cairo_paint(context_);
  cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
}

PictureCanvas::~PictureCanvas() {
  cairo_destroy(context_);
  cairo_surface_destroy(surface_);
}

std::uint32_t* PictureCanvas::row(int y) {
  cairo_surface_flush(surface_);
  return reinterpret_cast<std::uint32_t*>(cairo_image_surface_get_data(surface_) +
                                          static_cast<std::ptrdiff_t>(y) *
                                              cairo_image_surface_get_stride(surface_));
}

void PictureCanvas::pixels_done() { cairo_surface_mark_dirty(surface_); }

void PictureCanvas::ink(const Colour& c, double alpha) {
  cairo_set_source_rgba(context_, c.red, c.green, c.blue, alpha);
}

void PictureCanvas::stroke(const Colour& colour, double width, double alpha) {
  ink({0, 0, 0}, kHaloAlpha * alpha);
  cairo_set_line_width(context_, width + kHalo);
  cairo_stroke_preserve(context_);
  ink(colour, alpha);
  cairo_set_line_width(context_, width);
  cairo_stroke(context_);
}

void PictureCanvas::fill_box(double x, double y, double width, double height) {
  cairo_rectangle(context_, x, y, width, height);
  cairo_fill(context_);
}

double PictureCanvas::text_width(const std::string& words, double size, bool bold) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> none(
      cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(none.get()), cairo_destroy);
  choose_face(context.get(), size, bold);
  cairo_text_extents_t box;
  cairo_text_extents(context.get(), words.c_str(), &box);
  return box.x_advance;
}

void PictureCanvas::text(double x, double y, const std::string& words, double size, double align, bool bold) {
  choose_face(context_, size, bold);
  if (align != 0) {
    cairo_text_extents_t box;
    cairo_text_extents(context_, words.c_str(), &box);
    x -= align * box.x_advance;
  }
  cairo_move_to(context_, x, y);
  cairo_show_text(context_, words.c_str());
}

void PictureCanvas::label(double x, double y, const std::string& words, double size, const Colour& colour) {
  const double width = text_width(words, size) + 8;
  const double height = size + 5;
  rounded_box(context_, x - width / 2, y - height / 2, width, height, 3);
  ink({0, 0, 0}, kPlateAlpha);
  cairo_fill(context_);
  ink(colour);
  text(x, y + 0.36 * size, words, size, 0.5);
}

void PictureCanvas::save(const std::filesystem::path& path) {
  const int stride = cairo_image_surface_get_stride(surface_) / static_cast<int>(sizeof(std::uint32_t));
  write_png(path, row(0), width_, height_, stride);
}

}  // namespace obliq
