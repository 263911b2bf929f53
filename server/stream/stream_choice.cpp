#include "server/stream/stream_choice.h"

#include <string>

#include "proto/obliq.pb.h"

namespace obliq::stream {
namespace {

/// None asked for means the four.
template <typename Planes>
wire::PlaneSet read_planes(const Planes& planes, std::vector<FieldError>& errors) {
  if (planes.empty()) return wire::kAllPlanes;
  wire::PlaneSet set = 0;
  for (const int number : planes) {
    const auto plane = wire::plane_from_number(number);
    if (plane) {
      set = static_cast<wire::PlaneSet>(set | wire::plane_bit(*plane));
    } else {
      errors.push_back({"planes", std::to_string(number), wire::numbered_planes()});
      return set;
    }
  }
  return set;
}

void check_run(const wire::BinRun& run, const char* axis, int bins, std::vector<FieldError>& errors) {
  const auto n = static_cast<std::uint32_t>(bins);
  const std::string name(axis);
  if (run.first >= n) {
    errors.push_back({"window.first_" + name, std::to_string(run.first),
                      "0 to " + std::to_string(bins - 1) + ": there are " + std::to_string(bins) + " bins"});
  } else if (run.count > n - run.first) {
    errors.push_back({"window.n_" + name, std::to_string(run.count),
                      "0 (all that follow) to " + std::to_string(n - run.first) + ", from bin " +
                          std::to_string(run.first) + " of " + std::to_string(bins)});
  }
  if (run.step > n)
    errors.push_back({"window." + name + "_step", std::to_string(run.step), "1 to " + std::to_string(bins)});
}

template <typename Request>
StreamChoice read(const Request& request, int azimuth_bins, int range_bins, std::vector<FieldError>& errors) {
  StreamChoice choice;
  choice.planes = read_planes(request.planes(), errors);
  if (const auto iq = wire::iq_encoding_from_number(request.iq_encoding())) {
    choice.format.iq = *iq;
  } else {
    errors.push_back({"iq_encoding", std::to_string(request.iq_encoding()), "0 (cf32_le), 1 (ci16_le)"});
  }
  if (const auto compression = wire::compression_from_number(request.compression())) {
    choice.format.compression = *compression;
  } else {
    errors.push_back({"compression", std::to_string(request.compression()), "0 (none), 1 (zstd)"});
  }
  if (request.video_bits() == 0 || request.video_bits() == 8 || request.video_bits() == 16) {
    choice.format.video_bits = request.video_bits() == 16 ? 16 : 8;
  } else {
    errors.push_back({"video_bits", std::to_string(request.video_bits()), "8 or 16; 0 is 8"});
  }
  choice.truth = request.truth();
  choice.format.window = wire::read_window(request.window());
  check_run(choice.format.window.azimuth, "azimuth", azimuth_bins, errors);
  check_run(choice.format.window.range, "range", range_bins, errors);
  return choice;
}

}  // namespace

BlockFormat BlockFormat::of_plane(wire::Plane plane) const {
  BlockFormat format = *this;
  if (!wire::is_complex(plane)) format.iq = wire::IqEncoding::cf32_le;
  if (plane != wire::Plane::video) format.video_bits = 8;
  return format;
}

StreamChoice read_choice(const wire::Subscribe& request, int azimuth_bins, int range_bins,
                         std::vector<FieldError>& errors) {
  return read(request, azimuth_bins, range_bins, errors);
}
StreamChoice read_choice(const wire::RenderOnce& request, int azimuth_bins, int range_bins,
                         std::vector<FieldError>& errors) {
  return read(request, azimuth_bins, range_bins, errors);
}

}  // namespace obliq::stream
