#pragma once
#include <string>
#include <vector>

#include "server/radar/targets/route.h"
#include "server/radar/targets/target.h"
#include "terrain/base/errors.h"

namespace obliq {

/// What targets of one kind have in common.
struct TargetType {
  std::string name;
  TargetSize size;
  std::vector<std::string> dis{};  ///< DisPattern texts: entities of DIS that are such targets
  std::string rcs_file{};          ///< path of size.aspects; empty: none
};

/// The type of that name; null: there is none.
const TargetType* find_type(const std::vector<TargetType>& types, const std::string& name);
/// Their names as an error says what a target's type may be.
std::string allowed_types(const std::vector<TargetType>& types);

/// Of a target's foot, over its reference.
constexpr double kLeastTargetHeight_m = -1e3;
constexpr double kMostTargetHeight_m = 1e6;
/// Along each of its axes.
constexpr double kMostTargetAcceleration_m_s2 = 1000;
constexpr double kMostHeadingRate_deg_s = 360;

/// A target as an operator names it.
struct TargetConfig {
  std::string name;
  std::string type;  ///< name of one of the file's; empty: none
  RouteSpec route;   ///< what target.route is made of
  Target target;

  /// From where it is over the route's points; without points it has none.
  void lay_route();
};

/// What is outside its limits, or does not go together.
std::vector<FieldError> validate(const TargetConfig& target);

}  // namespace obliq
