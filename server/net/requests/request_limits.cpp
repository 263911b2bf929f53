#include "server/net/requests/request_limits.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "server/radar/wedge_memory.h"
#include "terrain/base/process.h"

namespace obliq::net {
namespace {

std::int64_t threads_of(const ServerOptions& options) {
  return options.render_threads > 0 ? options.render_threads
                                    : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
}

/// With the bytes of its rendering.
rendering::FrameCost rendering_cost(const RadarSettings& settings, wire::PlaneSet planes,
                                    const ServerOptions& options) {
  rendering::FrameCost cost;
  // The sweep has no rows: its planes are marched through all range bins.
  const std::int64_t rows =
      settings.frustum == FrustumKind::sweep ? settings.range_bins : settings.pixel_rows;
  cost.pixels = settings.pixel_columns * rows;
  cost.bins = std::int64_t{settings.azimuth_bins} * settings.range_bins;
  cost.samples = pulse_samples(settings);
  const bool materials = (planes & wire::kLabelPlanes) != 0 || may_need_materials(settings);
  const RenderingSize size = rendering_size(settings, threads_of(options), materials ? options.materials : 0);
  cost.plan_taps = size.plan_taps;
  cost.bytes = size.bytes;
  return cost;
}

/// Of these planes in one frame: of bins, and of its trains of pulses.
std::int64_t plane_bytes(wire::PlaneSet planes, const rendering::FrameCost& cost) {
  const std::int64_t of_bins =
      wire::bytes_per_bin(static_cast<wire::PlaneSet>(planes & wire::kBinPlanes)) * cost.bins;
  if ((planes & wire::kPulsesPlane) == 0) return of_bins;
  return of_bins + wire::bytes_per_bin(wire::Plane::pulses) * cost.samples;
}

std::string product(std::int64_t a, std::int64_t b) { return std::to_string(a) + " x " + std::to_string(b); }

OverLimit exceeds(const std::string& limit, std::int64_t most, const std::string& what,
                  const FieldError& field) {
  return {limit, limit + " is " + std::to_string(most) + ": " + what, field};
}

}  // namespace

rendering::FrameCost once_cost(const RadarSettings& settings, wire::PlaneSet planes,
                               const ServerOptions& options) {
  rendering::FrameCost cost = rendering_cost(settings, planes, options);
  // One train, whatever its antenna does.
  if (cost.samples > 0) cost.samples = std::int64_t{settings.doppler.pulses} * settings.range_bins;
  cost.bytes += std::min(plane_bytes(planes, cost), 2 * static_cast<std::int64_t>(options.slice_bytes));
  return cost;
}

rendering::FrameCost live_cost(const RadarSettings& settings, wire::PlaneSet planes,
                               const ServerOptions& options) {
  rendering::FrameCost cost = rendering_cost(settings, planes, options);
  cost.bytes += plane_bytes(planes, cost) * (options.queue_frames + 1);
  return cost;
}

rendering::FrameCost replay_cost(const RadarSettings& settings, wire::PlaneSet planes,
                                 const ServerOptions& options) {
  rendering::FrameCost cost;
  cost.bins = std::int64_t{settings.azimuth_bins} * settings.range_bins;
  cost.samples = pulse_samples(settings);
  cost.bytes = plane_bytes(planes, cost) * (options.queue_frames + 2);
  return cost;
}

rendering::FrameCost whole_cost(const RadarSettings& settings, const ServerOptions& options) {
  // With video.
  constexpr std::int64_t kBytesABin = 21 + 3;
  rendering::FrameCost cost = rendering_cost(settings, wire::kAllPlanes, options);
  cost.bytes += kBytesABin * cost.bins;
  return cost;
}

std::optional<OverLimit> over_limit(const RadarSettings& settings, const rendering::FrameCost& cost,
                                    std::int64_t reserved_bytes, const ServerOptions& options) {
  if (cost.bins > options.max_bins)
    return exceeds("max_bins", options.max_bins, "the frame has " + std::to_string(cost.bins),
                   {"azimuth_bins x range_bins", product(settings.azimuth_bins, settings.range_bins),
                    "at most " + std::to_string(options.max_bins) + " bins in one frame"});
  if (cost.samples > options.max_bins) {
    const std::int64_t trains = cost.samples / settings.doppler.pulses / settings.range_bins;
    return exceeds("max_bins", options.max_bins,
                   "the frame's trains have " + std::to_string(cost.samples) + " samples",
                   {"doppler_pulses x range_bins x trains",
                    product(settings.doppler.pulses, settings.range_bins) + " x " + std::to_string(trains),
                    "at most " + std::to_string(options.max_bins) + ": fewer pulses or range bins" +
                        (trains > 1 ? ", or a longer scan.dwell_bins" : "")});
  }
  if (cost.pixels > options.max_pixels)
    return exceeds(
        "max_pixels", options.max_pixels, "the frame has " + std::to_string(cost.pixels),
        {settings.frustum == FrustumKind::sweep ? "pixel_columns x range_bins" : "pixel_columns x pixel_rows",
         product(settings.pixel_columns, cost.pixels / std::max(settings.pixel_columns, 1)),
         "at most " + std::to_string(options.max_pixels) + " pixels in one frame"});
  if (cost.plan_taps > options.max_plan_taps)
    return exceeds(
        "max_plan_taps", options.max_plan_taps, "the plan of the beam has " + std::to_string(cost.plan_taps),
        {"beam.extent_deg, bins.azimuth, bins.range", std::to_string(cost.plan_taps) + " weights",
         "at most " + std::to_string(options.max_plan_taps) +
             ": a beam that ends nearer to its boresight, fewer azimuth or range bins, or a longer "
             "pulse"});
  return over_memory(settings, cost, reserved_bytes, options);
}

std::optional<OverLimit> over_memory(const RadarSettings& settings, const rendering::FrameCost& cost,
                                     std::int64_t reserved_bytes, const ServerOptions& options) {
  const auto megabytes = [](std::int64_t bytes) { return (bytes + 999'999) / 1'000'000; };
  const std::int64_t have = megabytes(resident_bytes() + reserved_bytes);
  const std::int64_t need = megabytes(cost.bytes);
  if (static_cast<double>(have + need) > options.max_memory_mb) {
    std::string cure =
        "a smaller frame, more azimuth bins for as many pixels, fewer planes, or fewer requests at a time";
    if (cost.samples > 0) cure += "; or fewer doppler.pulses";
    if (cost.plan_taps > 0) cure += "; or a beam of less beam.extent_deg";
    return exceeds("max_memory_mb", std::llround(options.max_memory_mb),
                   "the frame needs about " + std::to_string(need) + " MB beside " + std::to_string(have) +
                       " MB that are in use",
                   {"bins, pixels",
                    product(settings.azimuth_bins, settings.range_bins) + ", " +
                        product(settings.pixel_columns, settings.pixel_rows),
                    cure});
  }
  return std::nullopt;
}

std::optional<OverLimit> over_queue(const rendering::FrameCost& cost, std::int64_t work_queued,
                                    const ServerOptions& options) {
  if (work_queued + cost.work() <= options.max_work_queued) return std::nullopt;
  return exceeds("max_work_queued", options.max_work_queued,
                 "the frame has " + std::to_string(cost.work()) + " pixels and bins, and " +
                     std::to_string(work_queued) + " of all clients wait already",
                 {"pixels + bins", std::to_string(cost.work()), "a smaller frame, or later"});
}

}  // namespace obliq::net
