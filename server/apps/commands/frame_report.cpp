#include "server/apps/commands/frame_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"

namespace obliq {
namespace {

std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; });
  return text;
}

bool holds(const std::vector<std::string>& warnings, const std::string& warning) {
  return std::ranges::any_of(warnings, [&, text = without_numbers(warning)](const std::string& other) {
    return without_numbers(other) == text;
  });
}

}  // namespace

void print_frame_report(const std::string& out, const wire::FrameDescriptor& descriptor,
                        const wire::FrameSummary& summary, const std::string& times,
                        const std::vector<std::string>& said) {
  for (const std::string& warning : frame_warnings(descriptor, summary)) {
    if (std::ranges::find(said, warning) == said.end())
      std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
  if (descriptor.settings().frustum() == wire::SWEEP) {
    std::printf("%s: %llu planes", out.c_str(), static_cast<unsigned long long>(summary.rays()));
  } else {
    std::printf("%s: %.2f M rays", out.c_str(), static_cast<double>(summary.rays()) / 1e6);
  }
  std::printf(", %.2f M samples %s", static_cast<double>(summary.samples()) / 1e6, times.c_str());
  if (summary.lit_bins() > 0)
    std::printf(
        ", %llu gaps: %.2f %% of the lit bins unsampled",
        static_cast<unsigned long long>(summary.unsampled_bins()),
        100 * static_cast<double>(summary.unsampled_bins()) / static_cast<double>(summary.lit_bins()));
  if (descriptor.buildings_in_scene() > 0) {
    std::printf(", %u of %u buildings seen", summary.buildings_seen(), descriptor.buildings_in_scene());
  }
  std::printf("\n");
}

std::string milliseconds_text(double seconds) { return fmt::format("{:.0f} ms", 1000 * seconds); }

std::string pose_text(const wire::Pose& pose) {
  return fmt::format("{:.7f} {}, {:.7f} {}, {:.2f} m above {}, bearing {:.3f} degrees",
                     std::abs(pose.latitude_deg()), pose.latitude_deg() < 0 ? 'S' : 'N',
                     std::abs(pose.longitude_deg()), pose.longitude_deg() < 0 ? 'W' : 'E', pose.height_m(),
                     pose.height_reference() == wire::GROUND      ? "ground"
                     : pose.height_reference() == wire::ELLIPSOID ? "ellipsoid"
                                                                  : "datum",
                     pose.bearing_deg());
}

void WarningChanges::tell(std::vector<std::string> now, const std::string& where) {
  if (now == held_) return;
  for (const std::string& warning : now)
    if (!holds(held_, warning)) std::fprintf(stderr, "warning: %s%s\n", where.c_str(), warning.c_str());
  for (const std::string& warning : held_)
    if (!holds(now, warning)) std::fprintf(stderr, "over: %s%s\n", where.c_str(), warning.c_str());
  held_ = std::move(now);
}

}  // namespace obliq
