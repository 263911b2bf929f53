#include "server/output/picture_canvas.h"

#include <cairo.h>
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

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

/// All of the picture in libpng's hands; false when it could not be written. Nothing in here has a
/// destructor: libpng leaves by longjmp.
bool encode(png_structp png, png_infop info, std::FILE* file, const std::uint32_t* pixels, int width,
            int height, int stride, std::uint8_t* row) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < height; ++y) {
    const std::uint32_t* from = pixels + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = 0; x < width; ++x) {
      row[3 * x] = static_cast<std::uint8_t>(from[x] >> 16);
      row[3 * x + 1] = static_cast<std::uint8_t>(from[x] >> 8);
      row[3 * x + 2] = static_cast<std::uint8_t>(from[x]);
    }
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return true;
}

/// Writes 8-bit RGB out of 0x00RRGGBB words, rows `stride` words apart. Compressed lightly: speckle does not
/// become smaller by trying harder, only later. Throws InputError that names the file.
void write_png(const std::filesystem::path& path, const std::uint32_t* pixels, int width, int height,
               int stride) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  // A failing write is reported once, by us.
  const auto quiet = [](png_structp png, png_const_charp) { png_longjmp(png, 1); };
  const auto silent = [](png_structp, png_const_charp) {};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, quiet, silent);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  std::vector<std::uint8_t> row(3 * static_cast<std::size_t>(width));
  errno = 0;
  bool good = file && info && encode(png, info, file.get(), pixels, width, height, stride, row.data());
  png_destroy_write_struct(&png, &info);
  good = file && std::fclose(file.release()) == 0 && good;
  if (!good)
    throw InputError(path.string() + ": cannot be written (" +
                     (errno != 0 ? std::strerror(errno) : "libpng gave no reason") + ")");
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
