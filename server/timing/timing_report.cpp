#include "server/timing/timing_report.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace obliq {
namespace {

constexpr int kBarOfWhole = 40;

std::string rows(const TimeParts& parts, const char* unit) {
  std::string text = fmt::format("  {:<10} {:>10} {:>8}\n", "stage", unit, "share");
  for (const auto& [name, seconds] : parts.part_s) {
    const double share = parts.whole_s > 0 ? seconds / parts.whole_s : 0;
    const std::string bar(static_cast<std::size_t>(std::lround(kBarOfWhole * std::max(0.0, share))), '#');
    text += fmt::format("  {:<10} {:10.2f} {:6.1f} %{}{}\n", name, 1000 * seconds, 100 * share,
                        bar.empty() ? "" : "  ", bar);
  }
  return text + fmt::format("  {:<10} {:10.2f} {:6.1f} %\n", "sum", 1000 * parts.whole_s, 100.0);
}

nlohmann::ordered_json to_json(const TimeParts& parts) {
  nlohmann::ordered_json root;
  for (const auto& [name, seconds] : parts.part_s)
    root[name] = {{"s", seconds}, {"share", parts.whole_s > 0 ? seconds / parts.whole_s : 0}};
  return root;
}

double measured_s(const TimeParts& frame) {
  double sum = 0;
  for (const auto& [name, seconds] : frame.part_s)
    if (name != "idle") sum += seconds;
  return sum;
}

}  // namespace

TimeParts time_parts(const StageTimes& times) {
  TimeParts parts;
  parts.whole_s = times.total_s();
  for (int k = 0; k < kStages; ++k) {
    const auto stage = static_cast<Stage>(k);
    const double seconds = times.seconds(stage);
    if (seconds > 0) parts.add(stage_name(stage), seconds);
  }
  return parts;
}

std::string profile_text(const Profile& profile) {
  std::string text = fmt::format("the scene, {:.2f} s, one stage after the other:\n", profile.scene.whole_s);
  text += rows(profile.scene, "ms");
  text +=
      fmt::format("a frame, {:.2f} ms on {} threads, from plan to last byte at a reader on the loopback:\n",
                  1000 * profile.frame_s, profile.threads);
  text += rows(profile.frame, "thread ms");
  text += fmt::format(
      "  = {} threads x {:.2f} ms; without a processor, which others had, for {:.1f} % of the stages\n",
      profile.threads, 1000 * profile.frame_s,
      100 * std::max(0.0, 1 - profile.processor_s / measured_s(profile.frame)));
  text += fmt::format(
      "  probes: {:+.1f} % processor time, {:+.1f} % wall time (median of {} pairs of frames with and "
      "without)\n",
      100 * (profile.processor_ratio - 1), 100 * (profile.wall_ratio - 1), profile.pairs);
  return text;
}

std::string profile_json(const Profile& profile) {
  nlohmann::ordered_json root;
  root["scene"] = {{"whole_s", profile.scene.whole_s}, {"stages", to_json(profile.scene)}};
  root["frame"] = {{"wall_s", profile.frame_s},
                   {"threads", profile.threads},
                   {"whole_thread_s", profile.frame.whole_s},
                   {"processor_s", profile.processor_s},
                   {"stages", to_json(profile.frame)}};
  root["probes"] = {{"pairs", profile.pairs},
                    {"wall_ratio", profile.wall_ratio},
                    {"processor_ratio", profile.processor_ratio}};
  return root.dump();
}

}  // namespace obliq
