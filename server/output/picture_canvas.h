#pragma once
using cairo_t = struct _cairo;
using cairo_surface_t = struct _cairo_surface;
#include <cstdint>
#include <filesystem>
#include <string>

namespace obliq {

struct Colour {
  double red, green, blue;
};
constexpr Colour kPaper{0.055, 0.065, 0.075};
constexpr Colour kInk{0.86, 0.90, 0.88};
constexpr Colour kFaint{0.60, 0.66, 0.64};
constexpr Colour kGrid{0.30, 0.95, 0.80};
constexpr Colour kWarning{1.0, 0.74, 0.30};

/// 0x00RRGGBB.
std::uint32_t packed(const Colour& colour);

/// A picture in memory: pixels, and lines and words over them that can be read on black and on white.
class PictureCanvas {
 public:
  PictureCanvas(int width, int height);
  ~PictureCanvas();
  PictureCanvas(const PictureCanvas&) = delete;
  PictureCanvas& operator=(const PictureCanvas&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  /// The pixels' row; after the last use call pixels_done().
  std::uint32_t* row(int y);
  void pixels_done();

  cairo_t* cairo() { return context_; }
  void ink(const Colour& colour, double alpha = 1);
  /// Strokes the current path: a line of `width` over a broader dark one.
  void stroke(const Colour& colour, double width, double alpha = 1);
  void fill_box(double x, double y, double width, double height);

  static double text_width(const std::string& words, double size, bool bold = false);
  /// align: the part of the words that is left of x.
  void text(double x, double y, const std::string& words, double size, double align = 0, bool bold = false);
  /// Words on a dark plate, their middle at x, y.
  void label(double x, double y, const std::string& words, double size, const Colour& colour);

  /// Throws InputError.
  void save(const std::filesystem::path& path);

 private:
  int width_;
  int height_;
  cairo_surface_t* surface_;
  cairo_t* context_;
};

}  // namespace obliq
