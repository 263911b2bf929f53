#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace obliq::wire {

/// One quantity per bin, or the samples of pulse trains; the numbers are those of the protobuf enumeration
/// PlaneKind. Free ones: ADD_A_MESSAGE.md.
enum class Plane : std::uint8_t {
  iq = 0,
  power = 1,
  count = 2,
  state = 3,
  video = 4,
  pulses = 5,
  material = 6,
  building = 7,
  height = 8,
  returns = 9,
  target = 10
};
constexpr int kPlanes = 11;

/// A set of planes, bit n for plane n.
using PlaneSet = std::uint16_t;
constexpr PlaneSet kAllPlanes = 0x0F;     ///< of a client that names none: all but video
constexpr PlaneSet kLabelPlanes = 0x3C0;  ///< what the ground is: material, building, height, returns
constexpr PlaneSet kTargetPlane = 0x400;  ///< which target is the strongest in the bin
constexpr PlaneSet kBinPlanes = 0x1F | kLabelPlanes | kTargetPlane;
constexpr PlaneSet kPulsesPlane = 0x20;  ///< what a receiver gives out pulse by pulse
constexpr PlaneSet kEveryPlane = kBinPlanes | kPulsesPlane;
constexpr PlaneSet plane_bit(Plane plane) {
  return static_cast<PlaneSet>(1u << static_cast<unsigned>(plane));
}

/// Bytes per bin: iq and, of each pulse, pulses 8 (two float32), power 8 (float64), count 4 (uint32), state
/// 1, video 2 (uint16; sent with 8 bits it is 1), material 1, building and height 4 (float32), returns 1,
/// target 4 (uint32).
std::uint32_t bytes_per_bin(Plane plane);
/// The same of all planes of a set.
std::uint32_t bytes_per_bin(PlaneSet planes);

const char* plane_name(Plane plane);
/// "iq, power, count, state", as far as they are in the set.
std::string plane_names(PlaneSet planes);

/// "0 (iq), 1 (power), ..." of every plane.
std::string numbered_planes();

/// Nothing for a number that is no plane.
std::optional<Plane> plane_from_number(int number);

/// Complex values, in either of two encodings.
constexpr bool is_complex(Plane plane) { return plane == Plane::iq || plane == Plane::pulses; }

/// A rectangle of bins: azimuth is the slow index, range the fast one.
struct Rectangle {
  std::uint32_t first_azimuth = 0;
  std::uint32_t n_azimuth = 0;
  std::uint32_t first_range = 0;
  std::uint32_t n_range = 0;
};

}  // namespace obliq::wire
