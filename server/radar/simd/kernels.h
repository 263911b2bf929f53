#pragma once
// All kernels. A new one: OBLIQ_KERNEL in its header, its name here, its file in CMakeLists.txt.
#include <vector>

#include "server/radar/simd/buildings/circles.h"
#include "server/radar/simd/buildings/face_places.h"
#include "server/radar/simd/buildings/light_left.h"
#include "server/radar/simd/buildings/square_walls.h"
#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/simd/echoes/bin_samples.h"
#include "server/radar/simd/echoes/face_voltages.h"
#include "server/radar/simd/ground/cut_at_bins.h"
#include "server/radar/simd/ground/ground_echoes.h"
#include "server/radar/simd/ground/ground_plates.h"
#include "server/radar/simd/ground/ground_speckle.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/simd/ground/rays.h"
#include "server/radar/simd/ground/sea_texture.h"
#include "server/radar/simd/receiver/cancelled_sums.h"
#include "server/radar/simd/receiver/pulse_sums.h"
#include "server/radar/simd/receiver/row_doppler.h"
#include "server/radar/simd/receiver/rows.h"
#include "server/radar/simd/receiver/sharpened_sum.h"

namespace obliq {

#define OBLIQ_KERNELS(K)  \
  K(pixel_rays)           \
  K(first_hits_on_ground) \
  K(refine_ground_hits)   \
  K(highest_ground)       \
  K(visible_ground)       \
  K(cut_at_range_bins)    \
  K(ground_echoes)        \
  K(ground_places)        \
  K(sea_texture)          \
  K(texture_echoes)       \
  K(profile_nodes)        \
  K(see_part)             \
  K(light_left)           \
  K(square_walls)         \
  K(face_places)          \
  K(face_powers)          \
  K(face_voltages)        \
  K(mark_visible_ranges)  \
  K(ground_plates)        \
  K(plate_samples)        \
  K(bin_samples)          \
  K(sum_scatterers)       \
  K(ground_speckle)       \
  K(azimuth_sum)          \
  K(range_sum)            \
  K(draw_speckle)         \
  K(doppler_cells)        \
  K(doppler_phasors)      \
  K(cancel_row)           \
  K(locked_sum)           \
  K(cancelled_sum)        \
  K(sharpened_sum)        \
  K(doppler_turns)        \
  K(pulse_sum)            \
  K(turn_row)             \
  K(white_noise)          \
  K(filter_row)           \
  K(video_levels)         \
  K(circle_bins)          \
  K(idle_circles)

/// Those of one instruction set.
struct Kernels {
  const char* name;
#define OBLIQ_MEMBER(kernel) kernel##_kernel kernel;
  OBLIQ_KERNELS(OBLIQ_MEMBER)
#undef OBLIQ_MEMBER
};

/// Those in use: of the widest set that this machine has, or those that use_kernels() was given.
const Kernels& active_kernels();
/// For tests that compare instruction sets. Not while anything is rendered.
void use_kernels(const Kernels& kernels);

/// Of all the sets that this machine has, the narrowest first.
const std::vector<Kernels>& all_kernels();

}  // namespace obliq
