#include "server/apps/frame_report.h"

#include <cstdio>

#include "proto/obliq.pb.h"

namespace obliq {

void print_frame_report(const std::string& out, const wire::FrameDescriptor& descriptor,
                        const wire::FrameSummary& summary, const std::string& times) {
  for (const auto* warnings : {&descriptor.warnings(), &summary.warnings()})
    for (const std::string& warning : *warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (summary.coverage() < 1) {
    const double percent = 100 * (1 - summary.coverage());
    std::fprintf(stderr,
                 percent < 10 ? "warning: %.2g %% of the sector has no known ground\n"
                              : "warning: %.0f %% of the sector has no known ground\n",
                 percent);
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

std::string milliseconds_text(double seconds) {
  char text[48];
  std::snprintf(text, sizeof text, "%.0f ms", 1000 * seconds);
  return text;
}

}  // namespace obliq
