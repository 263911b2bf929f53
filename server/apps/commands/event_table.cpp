#include "server/apps/commands/event_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <vector>

#include "client/recording/recorded_events.h"
#include "client/recording/recorded_frames.h"
#include "proto/bookmark.h"
#include "proto/claim.h"
#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr std::size_t kNameBytes = 64;

/// "receiver.gain_db = 6.0, video.looks = 4" of the fields that a message has.
std::string values_text(const google::protobuf::Message& message, WireMessage kind,
                        const RadarConfig& config) {
  std::string text;
  for (const Parameter& parameter : parameters()) {
    if (parameter.message != kind) continue;
    const auto* field = message.GetDescriptor()->FindFieldByName(std::string(parameter.wire_field));
    if (field == nullptr || !message.GetReflection()->HasField(message, field)) continue;
    text += (text.empty() ? "" : ", ") + std::string(parameter.key.name) + " = " +
            toml_text(value_of(parameter, config));
  }
  return text.empty() ? "what this version does not know" : text;
}

std::string settings_text(const wire::RadarSettings& message) {
  RadarConfig config;
  const bool known = merge_message(message, config.settings).empty();
  return known ? values_text(message, WireMessage::radar_settings, config)
               : "what this version does not know";
}

std::string aim_text(const wire::Pose& message) {
  RadarConfig config;
  const bool known = merge_message(message, config.pose).empty();
  return known ? values_text(message, WireMessage::pose, config) : "what this version does not know";
}

std::string claims_text(const wire::ExerciseEvent& event) {
  wire::ClaimSet claims = 0;
  for (const int kind : event.claims())
    if (const auto claim = wire::claim_from_number(kind)) claims |= claim_bit(*claim);
  return claims == 0 ? "what this version does not know" : wire::claim_names(claims);
}

std::string targets_text(const wire::ExerciseEvent& event) {
  const std::string come = event.targets_come() > 0 ? "adds " + counted(event.targets_come(), "target") : "";
  const std::string gone =
      event.targets_gone() > 0 ? "removes " + counted(event.targets_gone(), "target") : "";
  return come + (come.empty() || gone.empty() ? "" : ", ") + gone;
}

std::string switches_text(const wire::ExerciseEvent& event) {
  std::vector<std::string> words;
  if (event.has_transmit()) words.push_back(event.transmit() ? "transmit on" : "transmit off");
  if (event.has_freeze()) words.push_back(event.freeze() ? "freeze on" : "freeze off");
  if (event.has_rate_limit_hz())
    words.push_back(fmt::format("rate limit {} Hz", short_number(event.rate_limit_hz())));
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string name_text(const std::string& name) { return printable_text(name, kNameBytes); }

/// UTC to the millisecond, as ISO 8601 has it.
std::string utc_of(std::int64_t utc_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t part_ns = ((utc_ns % kSecond_ns) + kSecond_ns) % kSecond_ns;
  const auto second = static_cast<std::time_t>((utc_ns - part_ns) / kSecond_ns);
  std::tm utc{};
  char text[32] = "?";
  if (gmtime_r(&second, &utc) != nullptr) std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return fmt::format("{}.{:03}Z", text, part_ns / 1'000'000);
}

}  // namespace

std::string event_words(const wire::ExerciseEvent& event) {
  switch (event.kind()) {
    case wire::CLAIM_EVENT:
      return "claims " + claims_text(event);
    case wire::RELEASE_EVENT:
      return "releases " + claims_text(event);
    case wire::TAKE_OVER_EVENT:
      return "takes " + claims_text(event) + " from " + name_text(event.taken_from());
    case wire::SETTINGS_EVENT:
      return "sets " + settings_text(event.settings());
    case wire::AIM_EVENT:
      return "aims: " + aim_text(event.pose());
    case wire::SWITCH_EVENT:
      return "switches " + switches_text(event);
    case wire::RESET_EVENT:
      return "resets to the scene file";
    case wire::LOAD_EVENT:
      return fmt::format("loads a state of {}",
                         counted(static_cast<std::uint64_t>(event.state().radars_size()), "radar"));
    case wire::FREEZE_EVENT:
      return event.freeze() ? "stops all radars" : "lets all radars go on";
    case wire::BOOKMARK_EVENT:
      return "bookmark: " +
             (wire::bookmark_fault(event.text()) ? printable_text(event.text(), kNameBytes) : event.text());
    case wire::TARGETS_EVENT:
      return targets_text(event);
    default:
      return fmt::format("does what this version does not know (event kind {})",
                         static_cast<int>(event.kind()));
  }
}

std::string event_heading() {
  return fmt::format("{:>10}  {:>5}  {:<24}  {:<28}  {:<10}  {}", "seconds", "no.", "UTC", "client", "radar",
                     "what");
}

std::string event_line(const wire::ExerciseEvent& event, std::int64_t start_ns) {
  const double since_s = 1e-9 * (static_cast<double>(event.utc_ns()) - static_cast<double>(start_ns));
  return fmt::format("{:>10.3f}  {:>5}  {:<24}  {:<28}  {:<10}  {}", since_s, event.number(),
                     utc_of(event.utc_ns()), name_text(event.by()),
                     event.radar().empty() ? "all" : name_text(event.radar()), event_words(event));
}

void print_recorded_events(const std::string& file, bool json) {
  std::unique_ptr<client::RecordingReader> reader;
  require(client::RecordingReader::open(file, reader));
  client::RecordingStart start;
  const bool has_frames = client::read_start(*reader, "", start).ok();
  std::optional<std::int64_t> start_ns;
  if (has_frames) start_ns = start.utc_ns;
  std::uint64_t events = 0;
  const auto print = [&](const wire::ExerciseEvent& event) {
    if (!start_ns) start_ns = event.utc_ns();
    if (json) {
      std::string line;
      wire::append_json(event, line);
      std::printf("%s\n", line.c_str());
    } else {
      if (events == 0) std::printf("%s\n", event_heading().c_str());
      std::printf("%s\n", event_line(event, *start_ns).c_str());
    }
    ++events;
  };
  client::RecordedLog log;
  require(client::read_events(
      file,
      [&](const wire::ExerciseEvents& message) {
        for (const wire::ExerciseEvent& event : message.events()) print(event);
      },
      log));
  if (log.messages == 0 && !has_frames && log.damages > 0)
    throw InputError(file + ": it is not what `obliq record` writes");
  if (!json) std::printf("%s: %s\n", file.c_str(), counted(events, "event").c_str());
  if (log.damages > 0)
    throw PartlyDone(fmt::format("{}: {} damaged or cut; events may be missing there", file,
                                 counted(log.damages, "place")));
}

}  // namespace obliq
