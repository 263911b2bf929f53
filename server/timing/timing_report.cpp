#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/timing/timing.h"

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

std::string timing_text(const Timing& timing) {
  std::string text = fmt::format("the scene, {:.2f} s, one stage after the other:\n", timing.scene.whole_s);
  text += rows(timing.scene, "ms");
  text +=
      fmt::format("a frame, {:.2f} ms on {} threads, from plan to last byte at a reader on the loopback:\n",
                  1000 * timing.frame_s, timing.threads);
  text += rows(timing.frame, "thread ms");
  text += fmt::format(
      "  = {} threads x {:.2f} ms; without a processor, which others had, for {:.1f} % of the stages\n",
      timing.threads, 1000 * timing.frame_s,
      100 * std::max(0.0, 1 - timing.processor_s / measured_s(timing.frame)));
  text += fmt::format(
      "  probes: {:+.1f} % processor time, {:+.1f} % wall time (median of {} pairs of frames with and "
      "without)\n",
      100 * (timing.processor_ratio - 1), 100 * (timing.wall_ratio - 1), timing.pairs);
  return text;
}

std::string timing_json(const Timing& timing) {
  nlohmann::ordered_json root;
  root["scene"] = {{"whole_s", timing.scene.whole_s}, {"stages", to_json(timing.scene)}};
  root["frame"] = {{"wall_s", timing.frame_s},
                   {"threads", timing.threads},
                   {"whole_thread_s", timing.frame.whole_s},
                   {"processor_s", timing.processor_s},
                   {"stages", to_json(timing.frame)}};
  root["probes"] = {{"pairs", timing.pairs},
                    {"wall_ratio", timing.wall_ratio},
                    {"processor_ratio", timing.processor_ratio}};
  return root.dump();
}

}  // namespace obliq
