#include "server/output/frame_window.h"

#include <algorithm>

#include "proto/bin_window.h"
#include "proto/obliq.pb.h"
#include "terrain/base/errors.h"

namespace obliq {

wire::FrameDescriptor placed_window(const wire::FrameDescriptor& descriptor) {
  wire::FrameDescriptor placed = descriptor;
  if (!descriptor.has_window()) return placed;
  const auto window =
      wire::cut_window(wire::read_window(descriptor.window()),
                       static_cast<std::uint32_t>(std::max(0, descriptor.settings().azimuth_bins())),
                       static_cast<std::uint32_t>(std::max(0, descriptor.settings().range_bins())));
  if (!window)
    throw InputError("frame descriptor: window: found no bin of the frame in it; allowed: at least one");
  const wire::BinRun& azimuth = window->azimuth;
  const wire::BinRun& range = window->range;
  placed.clear_window();
  placed.set_azimuth_start_deg(descriptor.azimuth_start_deg() +
                               azimuth.first * descriptor.azimuth_width_deg());
  placed.set_azimuth_width_deg(azimuth.step * descriptor.azimuth_width_deg());
  placed.set_range_start_m(descriptor.range_start_m() + range.first * descriptor.range_spacing_m());
  placed.set_range_spacing_m(range.step * descriptor.range_spacing_m());
  placed.mutable_settings()->set_azimuth_bins(static_cast<int>(azimuth.kept()));
  placed.mutable_settings()->set_range_bins(static_cast<int>(range.kept()));
  return placed;
}

}  // namespace obliq
