#include "proto/plane.h"

namespace obliq::wire {

std::uint32_t bytes_per_bin(Plane plane) {
  switch (plane) {
    case Plane::iq:
    case Plane::pulses:
    case Plane::power:
      return 8;
    case Plane::count:
    case Plane::building:
    case Plane::height:
    case Plane::target:
      return 4;
    case Plane::state:
    case Plane::material:
    case Plane::returns:
      return 1;
    case Plane::video:
      return 2;
  }
  return 0;
}

std::uint32_t bytes_per_bin(PlaneSet planes) {
  std::uint32_t bytes = 0;
  for (int i = 0; i < kPlanes; ++i) {
    const auto plane = static_cast<Plane>(i);
    if (planes & plane_bit(plane)) bytes += bytes_per_bin(plane);
  }
  return bytes;
}

const char* plane_name(Plane plane) {
  switch (plane) {
    case Plane::iq:
      return "iq";
    case Plane::power:
      return "power";
    case Plane::count:
      return "count";
    case Plane::state:
      return "state";
    case Plane::video:
      return "video";
    case Plane::pulses:
      return "pulses";
    case Plane::material:
      return "material";
    case Plane::building:
      return "building";
    case Plane::height:
      return "height";
    case Plane::returns:
      return "returns";
    case Plane::target:
      return "target";
  }
  return "?";
}

std::string plane_names(PlaneSet planes) {
  std::string names;
  for (int i = 0; i < kPlanes; ++i) {
    const auto plane = static_cast<Plane>(i);
    if (planes & plane_bit(plane)) names += (names.empty() ? "" : ", ") + std::string(plane_name(plane));
  }
  return names;
}

std::string numbered_planes() {
  std::string planes;
  for (int i = 0; i < kPlanes; ++i)
    if (const auto plane = plane_from_number(i))
      planes += (planes.empty() ? "" : ", ") + std::to_string(i) + " (" + plane_name(*plane) + ")";
  return planes;
}

std::optional<Plane> plane_from_number(int number) {
  if (number < 0 || number >= kPlanes || ((kEveryPlane >> number) & 1) == 0) return std::nullopt;
  return static_cast<Plane>(number);
}

}  // namespace obliq::wire
