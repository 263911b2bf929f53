#pragma once
#include "server/output/ground_map.h"
#include "server/output/map_projection.h"
#include "server/output/picture_canvas.h"

namespace obliq {

/// Draws over a map what a display has: the sector's outline, range rings with their slant ranges, bearings,
/// the antenna. left, top: of the map in the picture, a pixel of it to a pixel.
void draw_overlay(PictureCanvas& canvas, const MapProjection& projection, const GroundMap& map, double left,
                  double top);

/// The largest of 1, 2, 5, 10... that is no larger.
double round_step(double most);
/// "12.5 km", or "850 m".
std::string distance_text(double metres);

}  // namespace obliq
