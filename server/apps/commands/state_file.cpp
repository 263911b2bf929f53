#include "server/apps/commands/state_file.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "proto/obliq.pb.h"
#include "server/apps/commands/target_fields.h"
#include "server/control/config_tree.h"
#include "server/control/parameters.h"
#include "server/control/section_reader.h"
#include "server/control/sections/platform.h"
#include "server/control/settings_message.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

constexpr std::int64_t kVersion = 1;

std::string line(std::string_view key, const Value& value) {
  return std::string(key) + " = " + toml_text(value) + "\n";
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// "antenna" and "tilt_deg" of antenna.tilt_deg.
std::pair<std::string, std::string> parts_of(std::string_view key) {
  const std::size_t dot = key.find('.');
  return {std::string(key.substr(0, dot)), std::string(key.substr(dot + 1))};
}

/// What is not there was there when the file was whole.
void demand(bool is_there, const ConfigNode& table, const std::string& name, Complaints& complaints) {
  if (!is_there)
    complaints.add(
        table.where,
        FieldError{name, "nothing",
                   "a value: `obliq save` writes all; the file has been cut, or an earlier obliq wrote it"});
}

void read_parameters(const ConfigNode& table, RadarConfig& config, Complaints& complaints) {
  std::string section;
  const ConfigNode none;
  for (const Parameter& first : parameters()) {
    if (parts_of(first.key.name).first == section) continue;
    section = parts_of(first.key.name).first;
    const ConfigNode* found = table.find(section);
    SectionReader reader(found == nullptr ? none : *found, section, complaints);
    for (const Parameter& parameter : parameters()) {
      const auto [of, name] = parts_of(parameter.key.name);
      if (of != section) continue;
      demand(reader.take(name) != nullptr, table, std::string(parameter.key.name), complaints);
      (void)reader.read(name, parameter.key, parameter.slot(config));
    }
    reader.finish();
  }
}

void read_platform(const ConfigNode& table, wire::ExerciseState& state, Complaints& complaints) {
  RadarConfig holder;
  std::string name;
  SectionReader reader(table, "platform", complaints);
  demand(reader.read("name", Key{"platform.name", ""}, &name), table, "platform.name", complaints);
  for (const Parameter* p : platform_parameters()) {
    const std::string local = parts_of(p->key.name).second;
    demand(reader.take(local) != nullptr, table, platform_key(*p), complaints);
    (void)reader.read(local, p->key, p->slot(holder));
  }
  reader.finish();
  wire::PlatformState& platform = *state.add_platforms();
  platform.set_platform(name);
  write_message(holder.pose, *platform.mutable_pose());
}

void read_radar(const ConfigNode& table, wire::ExerciseState& state, Complaints& complaints) {
  RadarConfig config;
  bool transmit = true;
  bool frozen = false;
  double rate_limit_hz = 0;
  const auto read = [&](const char* name, const Slot& slot) {
    const ConfigNode* node = table.find(name);
    demand(node != nullptr, table, std::string("radar.") + name, complaints);
    const Key key{name, ""};
    if (node == nullptr) return;
    if (node->kind != ConfigNode::Kind::value || store(key, slot, node->value))
      complaints.add(node->where, FieldError{name, node->found_text(), allowed_text(key, slot)});
  };
  read("name", &config.name);
  read("transmit", &transmit);
  read("freeze", &frozen);
  read("rate_limit_hz", &rate_limit_hz);
  read_parameters(table, config, complaints);
  for (const FieldError& error : validate(config)) complaints.add(table.where, error);
  wire::RadarState& radar = *state.add_radars();
  radar.set_radar(config.name);
  radar.set_transmit_off(!transmit);
  radar.set_frozen(frozen);
  radar.set_rate_limit_hz(rate_limit_hz);
  write_message(config.settings, *radar.mutable_settings());
  write_message(config.pose, *radar.mutable_pose());
}

}  // namespace

std::string state_text(const wire::ExerciseState& state) {
  std::string text =
      "# The state of an exercise: `obliq save` has written it, `obliq load` puts it in place.\n[exercise]\n";
  text += line("version", kVersion) + line("scene", state.scene_name()) +
          line("scene_hash", state.scene_hash()) + line("build", state.build()) + line("saved", utc_now()) +
          line("radars", std::int64_t{state.radars_size()}) +
          line("platforms", std::int64_t{state.platforms_size()});
  // Without the line the state says nothing of targets: who saved it may not know where they are.
  if (state.with_targets()) text += line("targets", std::int64_t{state.targets_size()});
  for (const wire::PlatformState& platform : state.platforms()) {
    RadarConfig holder;
    if (const auto errors = merge_message(platform.pose(), holder.pose); !errors.empty())
      throw InputError("the server's platform " + platform.platform() + ": " + errors.front().text());
    text += "\n[[platform]]\n" + line("name", platform.platform());
    for (const Parameter* p : platform_parameters())
      text += line(parts_of(p->key.name).second, value_of(*p, holder));
  }
  for (const wire::RadarState& radar : state.radars()) {
    RadarConfig config;
    for (const auto& errors :
         {merge_message(radar.settings(), config.settings), merge_message(radar.pose(), config.pose)})
      if (!errors.empty())
        throw InputError("the server's radar " + radar.radar() + ": " + errors.front().text());
    text += "\n[[radar]]\n" + line("name", radar.radar()) + line("transmit", !radar.transmit_off()) +
            line("freeze", radar.frozen()) + line("rate_limit_hz", radar.rate_limit_hz());
    for (const Parameter& parameter : parameters())
      text += line(parameter.key.name, value_of(parameter, config));
  }
  for (const wire::Target& target : state.targets()) text += "\n[[target]]\n" + target_text(target);
  return text + "\n[end]\ncomplete = true\n";
}

wire::ExerciseState read_state_file(const std::filesystem::path& path) {
  const ConfigNode file = parse_config_file(path);
  Complaints complaints;
  SectionReader top(file, "", complaints);
  wire::ExerciseState state;
  std::int64_t version = 0;
  std::int64_t radars = -1;
  std::int64_t platforms = 0;  // files of before there were any do not say
  std::int64_t targets = -1;
  std::string scene, hash, build, saved;
  const auto read_head = [&](const ConfigNode& table) {
    SectionReader head(table, "exercise", complaints);
    (void)head.read("version", Key{"exercise.version", "", closed(1, kVersion)}, &version);
    complaints.throw_if_any();  // what follows may mean something else
    (void)head.read("scene", Key{"exercise.scene", ""}, &scene);
    demand(head.read("scene_hash", Key{"exercise.scene_hash", ""}, &hash), table, "exercise.scene_hash",
           complaints);
    (void)head.read("build", Key{"exercise.build", ""}, &build);
    (void)head.read("saved", Key{"exercise.saved", ""}, &saved);
    demand(head.read("radars", Key{"exercise.radars", "", closed(0, 1000)}, &radars), table,
           "exercise.radars", complaints);
    (void)head.read("platforms", Key{"exercise.platforms", "", closed(0, 1000)}, &platforms);
    (void)head.read("targets", Key{"exercise.targets", "", closed(0, 10000)}, &targets);
    head.finish();
  };
  top.one_table("exercise", read_head);
  if (version == 0 && complaints.empty())
    throw InputError(path.string() +
                     ": exercise.version: found nothing; allowed: a file that `obliq save` has written");
  top.each_table("platform", [&](const ConfigNode& table) { read_platform(table, state, complaints); });
  top.each_table("radar", [&](const ConfigNode& table) { read_radar(table, state, complaints); });
  top.each_table("target",
                 [&](const ConfigNode& table) { read_target(table, *state.add_targets(), complaints); });
  bool complete = false;
  top.one_table("end", [&](const ConfigNode& table) {
    SectionReader end(table, "end", complaints);
    (void)end.read("complete", Key{"end.complete", ""}, &complete);
  });
  top.finish();
  const auto compare = [&](const std::string& kind, int found, std::int64_t said) {
    if (found == said || !complaints.empty()) return;
    complaints.add(path.string(), FieldError{kind, std::to_string(found) + " " + kind + "s",
                                             std::to_string(said) + ", as exercise." + kind +
                                                 "s says; the file has been cut or changed"});
  };
  compare("radar", state.radars_size(), radars);
  compare("platform", state.platforms_size(), platforms);
  compare("target", state.targets_size(), std::max<std::int64_t>(targets, 0));
  state.set_with_targets(targets >= 0);
  if (!complete && complaints.empty())
    complaints.add(path.string(),
                   FieldError{"end.complete", "nothing", "true, at the end; the file has been cut"});
  complaints.throw_if_any();
  state.set_version(static_cast<std::uint32_t>(version));
  state.set_scene_hash(hash);
  state.set_scene_name(scene);
  state.set_build(build);
  return state;
}

}  // namespace obliq
