#pragma once
#include <optional>
#include <string_view>

namespace obliq {

constexpr double kStorey_m = 3.0;  ///< OpenStreetMap's rule of thumb for building:levels

/// A building height as people write it, in metres: "12.5", "12,5 m", "40 ft", "40'", "12'6\"",
/// "12 ft 6 in", "3 storeys". A bare number is multiplied by metres_per_bare_unit. Nothing for anything else.
std::optional<double> parse_height_m(std::string_view text, double metres_per_bare_unit);

}  // namespace obliq
