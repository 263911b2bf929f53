#pragma once
#include <glm/vec3.hpp>

#include "server/apps/dis/entity_state.h"

namespace obliq {

/// How an entity moves at a moment, in the earth's axes.
struct EntityMotion {
  glm::dvec3 location_m{0.0};
  glm::dvec3 velocity_m_s{0.0};
  glm::dvec3 acceleration_m_s2{0.0};
  BodyAxes body;
  glm::dvec3 turn_rad_s{0.0};  ///< of the body; 0: its axes stay
};

/// So long after its PDU, or before it, by the algorithm that it names (IEEE 1278.1-2012, annex E, table
/// E.1). F: axes fixed, R: they turn; P: constant velocity, V: with acceleration; W: along the earth's axes,
/// B: along the body's.
///   1 static; 2 FPW, 3 RPW: p + v t; 4 RVW, 5 FVW: p + v t + a t^2 / 2; 6 FPB, 9 FVB: the same, since axes
///   that do not turn keep their direction; 7 RPB, 8 RVB: the velocity turns with the body, v(t) = R(t) (v +
///   a t), and the place is its integral in closed form: exact, to rounding.
/// 0, numbers above 9 and frozen entities stand.
EntityMotion reckoned(const EntityState& state, double after_s);

/// By an algorithm that no place, velocity and acceleration can follow for long: 7 and 8, where it turns.
bool is_curved(const EntityState& state);

/// It does not move, whatever time passes.
bool stands(const EntityState& state);

}  // namespace obliq
