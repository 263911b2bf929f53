#pragma once
// Places and heights from the command line and from files.
#include <string>
#include <vector>

namespace obliq {

/// Two numbers of a place, latitude and longitude or bearing and range, and a height where there is one.
struct GivenPoint {
  double first = 0;
  double second = 0;
  double height_m = 0;
  bool has_height = false;
};

/// "34.1,-118.2" or "34.1,-118.2,250". Throws InputError "WHERE: found ...; allowed: ...".
GivenPoint parse_point(const std::string& text, const std::string& where);

/// One point a line; empty lines and those that begin with # are passed by, and so is a first line that
/// begins with no number. "-": standard input. Throws InputError with FILE:LINE.
std::vector<GivenPoint> read_points(const std::string& path);

}  // namespace obliq
