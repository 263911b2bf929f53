#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "server/output/ground_map.h"
#include "server/output/map_projection.h"
#include "server/output/picture_canvas.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// The two ends of a picture's grey scale, in dB.
struct DbRange {
  double low = 0;
  double high = 1;
};

constexpr Colour kShadow{0, 0, 0};
constexpr Colour kNotSampled{0.13, 0.17, 0.42};
constexpr Colour kNoSurface{0.28, 0.20, 0.12};

/// Grey with a hint of phosphor; level 0 to 1. The darkest is told from a shadow.
Colour grey_of(double level);

/// "2024-05-01 12:00:00.0 UTC".
std::string utc_text(std::int64_t utc_ns);

/// What a picture says in words: the frame, its place and time, warnings, the scale, what the colours mean,
/// north, a length.
class PictureCaption {
 public:
  struct Facts {
    const wire::FrameDescriptor& frame;
    const wire::FrameSummary& summary;
    std::string time;  ///< empty: the pose's own, where it has one
    DbRange range;
    bool has_echoes = true;  ///< something is drawn in grey
    std::string quantity;    ///< of the scale: "|I&Q| × r², dB re sqrt(W) m²"
    std::string dark;        ///< what black means
    double up_rad = 0;
    double pixel_m = 1;
  };
  PictureCaption(const Facts& facts, double width);

  double height() const;
  void draw(PictureCanvas& canvas, double left, double top) const;

 private:
  void draw_legend(PictureCanvas& canvas, double left, double top) const;
  void draw_north(PictureCanvas& canvas, double x, double y) const;
  void draw_length(PictureCanvas& canvas, double right, double y) const;

  Facts facts_;
  double width_;
  std::string title_;
  std::vector<std::string> lines_;
  std::vector<std::string> warnings_;
};

/// Draws over a map what a display has: the sector's outline, range rings with their slant ranges, bearings,
/// the antenna. left, top: of the map in the picture, a pixel of it to a pixel.
void draw_overlay(PictureCanvas& canvas, const MapProjection& projection, const GroundMap& map, double left,
                  double top);

/// The largest of 1, 2, 5, 10... that is no larger.
double round_step(double most);
/// "12.5 km", or "850 m".
std::string distance_text(double metres);

}  // namespace obliq
