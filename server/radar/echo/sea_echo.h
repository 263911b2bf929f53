#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "server/radar/scene_plan.h"
#include "server/radar/simd/echoes/sea_table.h"

namespace obliq {

/// Whether water returns what the sea does at a sea state, and not what its material says.
bool has_sea(const RadarSettings& settings, const std::vector<Material>& materials);

/// Of a frame; null where it has no sea.
std::shared_ptr<const SeaTable> sea_table(const ScenePlan& plan);

/// Of a bearing, the factor of the table's wind: powers 0, 1, ... of the sine of grazing within its limits.
/// against: cosine from the bearing that the wind comes from.
std::array<float, SeaTable::kUpwindTerms> upwind_terms(const SeaTable& table, double against);

/// What a piece of ground returns over what its material says: 1 unless it is water. Its horizontal offset
/// from the antenna, slant range and sine of elevation.
double sea_over_gamma(const SeaTable& table, std::uint8_t material, double dx_m, double dz_m, double range_m,
                      double sin_elevation);

}  // namespace obliq
