#pragma once
// What every configurable value has in common, wherever it is set: a key, a unit, limits, a place to live.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq {

// The enumerations that a key may have, each declared where its section or parameter lives.
enum class FrustumKind;
enum class PlateKind;
enum class ScanMode;
enum class SpeckleKind;
enum class BeamPattern;
enum class ElevationPattern;
enum class PulseKind;
enum class PulseWindow;
enum class Polarisation;
enum class HeightReference;
enum class SyntheticKind;
enum class ScatteringModel;
enum class RayMethod : std::uint8_t;
enum class LogFormat;
enum class LogLevel;
enum class TruthRole;
enum class RadarMode;
enum class DopplerWindow;

/// A value between its source and its place. Enumerations go by name.
using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string, std::vector<double>>;

/// Where a value lives. An optional number is "auto" where it is empty.
using Slot =
    std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::optional<double>*, std::string*,
                 std::vector<double>*, FrustumKind*, PlateKind*, ScanMode*, SpeckleKind*, Polarisation*,
                 BeamPattern*, ElevationPattern*, PulseKind*, PulseWindow*, HeightReference*, SyntheticKind*,
                 ScatteringModel*, RayMethod*, LogFormat*, LogLevel*, TruthRole*, RadarMode*, DopplerWindow*>;

/// An interval. NaN is in none; an infinity only where a closed end is infinite.
struct Limits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = true;
  bool high_open = true;

  bool contains(long double x) const;  ///< wide enough for every 64-bit integer
};
constexpr Limits closed(double low, double high) { return {low, high, false, false}; }
constexpr Limits from(double low) { return {low, std::numeric_limits<double>::infinity(), false, false}; }
constexpr Limits above(double low, double high) { return {low, high, true, false}; }

constexpr Limits kAny{};

/// Numbers in a value that is a list.
constexpr std::size_t kMostNumbers = 16;

/// When a change of a key's text in the scene file takes effect in a daemon that runs.
enum class Change {
  live,    ///< with the next frame
  reload,  ///< at SIGHUP
  restart
};
std::string_view change_name(Change change);

/// One name of an enumeration; its index in the list is the enumerator's value.
struct Choice {
  std::string_view name;
  std::string_view wire_name = {};  ///< of the protobuf enumerator, where there is one
  bool retired = false;             ///< recordings have it; not allowed any more
};

struct Key {
  std::string_view name;  ///< dotted, as in a scene file: "radar.r_max_m"
  std::string_view unit;  ///< empty: a pure number, a name, a yes or no
  Limits limits = {};
  std::span<const Choice> choices = {};
  std::string_view summary = {};  ///< one sentence
};

/// Puts a value in its place if its type fits; otherwise changes nothing and returns what would fit. Integers
/// serve as real numbers; lengths and speeds may be texts with a unit: "9842 ft", "80nmi", "250kt". Limits
/// are left to check().
std::optional<FieldError> store(const Key& key, const Slot& slot, const Value& value);

/// Compares what is in place with the limits.
std::optional<FieldError> check(const Key& key, const Slot& slot);

/// It is "auto".
bool is_left_open(const Slot& slot);

/// What is in place.
Value load(const Key& key, const Slot& slot);

/// "number", "integer", "boolean", "text" or "choice".
std::string_view type_name(const Slot& slot);

/// What the key accepts, in words: "number above 0, at most 360 deg".
std::string allowed_text(const Key& key, const Slot& slot);

/// The same of limits alone ("above 0, at most 360 deg", "any") and of names ("\"a\" | \"b\"").
std::string limits_text(const Limits& limits, std::string_view unit);
std::string choices_text(std::span<const Choice> choices);

/// The value as a scene file has it; numbers are the shortest that read back to the same bits.
std::string toml_text(const Value& value);
std::string toml_number(double value);
std::string toml_string(std::string_view text);
std::string toml_key(std::string_view name);  ///< bare where it can be, else quoted

}  // namespace obliq
