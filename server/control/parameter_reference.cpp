#include "server/control/parameter_reference.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "server/control/key_list.h"
#include "server/control/parameters.h"
#include "server/control/quality_presets.h"
#include "server/control/radar_presets.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"

namespace obliq {

namespace {

using Json = nlohmann::ordered_json;

std::string padded(std::string text, std::size_t width) {
  text.append(text.size() < width ? width - text.size() : 0, ' ');
  return text + "  ";
}

constexpr auto kSceneHeader = "| key | default | allowed | meaning |\n|---|---|---|---|\n";

/// Whether the default is a value, not words about one.
bool is_toml(const KeyText& key) {
  return !key.special || key.default_text.starts_with('"') || key.default_text.starts_with('[');
}

/// The rows of the keys whose names begin so.
std::string rows(KeyGroup group, std::string_view prefix = "") {
  std::string text;
  for (const KeyText& key : all_keys())
    if (key.group == group && key.name.starts_with(prefix))
      text += markdown_row({markdown_code(key.name),
                            is_toml(key) ? markdown_code(key.default_text) : key.default_text, key.allowed,
                            key.key.summary});
  return text;
}

std::string shipped_rows() {
  std::string text;
  for (const Material& m : shipped_materials()) {
    MaterialKeys keys{m, 0};
    const Row<MaterialKeys>& model = material_rows().front();
    text += markdown_row({markdown_code(m.name), markdown_code(toml_text(load(model.key, model.slot(keys)))),
                          toml_number(to_db(m.gamma))});
  }
  return text;
}

std::string pixels_cell(int fixed, double per_bin, const char* bins) {
  return fixed > 0 ? std::to_string(fixed) : toml_number(per_bin) + " x " + bins;
}

std::string quality_page() {
  std::string page =
      "\n## Quality\n\n`frustum.quality` sets several keys at once, in a file, a variable or a flag. A key "
      "that the same file or the same\ncommand line names itself overrides it; a key in a variable overrides "
      "a file's quality; a flag's quality overrides keys in\nvariables and files. Pixel counts that follow "
      "the bins stop at 16384.\n\nA scene with an empty `[frustum]` has the quality `standard`. A scene that "
      "names pixels or plates but no kind, and a\nRenderOnce without a frustum, have the oblique frustum "
      "with spread plates. `oblique` finds its pixels when `obliqd` or\n`obliq render` has loaded the "
      "scene. What each costs, and how\nfar its frames are from the truth: "
      "[SPEED.md](../../tests/bench/SPEED.md).\n\n| quality | kind | plates | "
      "pixel_columns | pixel_rows | for |\n|---|---|---|---|---|---|\n";
  for (const QualityPreset& p : quality_presets())
    page +=
        markdown_row({markdown_code(p.name), p.kind, p.plates,
                      p.searched ? "found" : pixels_cell(p.columns, p.columns_per_bin, "azimuth bins"),
                      p.searched ? "found" : pixels_cell(p.rows, p.rows_per_bin, "range bins"), p.meaning});
  return page;
}

std::string preset_page() {
  std::string page =
      "\n## Whole radars\n\n`radar.preset` names a radar of [presets](presets), each figure of which has its "
      "source "
      "or \"assumed\" beside it. It stands for\nthe keys that the scene file does not name: sections that "
      "all radars "
      "share and a radar's own keys override it, and so do variables and\nflags. Its antenna stands above "
      "the ground "
      "(`antenna.height_reference = \"ground\"`). `obliq parameters --preset NAME` prints it.\n\n| preset | "
      "what "
      "|\n|---|---|\n";
  for (const RadarPreset& p : radar_presets())
    page += markdown_row({markdown_code(p.name), std::string(first_sentence(p)) + "."});
  return page;
}

std::string platform_page() {
  return "\n## Platforms\n\nA radar with `radar.platform` rides on the `[[platform]]` of that name: SetPose, "
         "`obliq fly --radar NAME` and `obliq pose --radar NAME`\nof the platform move all its radars at "
         "once. Its `[antenna]` has `tilt_deg` and `tilt_auto` alone; `[mount]` (or "
         "`[radar.mount]`)\nsays where it is fixed, in the platform's own axes, which roll, pitch and "
         "heading turn. The antenna itself is held level "
         "unless `beam.stabilised` is false.\nIts gimbal may have limits: what is asked beyond them is kept, "
         "the "
         "antenna stands at the limit, and RadarInfo, `obliq status` and the page say so.\n\n" +
         std::string(kSceneHeader) + rows(KeyGroup::short_form, "mount.") + rows(KeyGroup::list, "platform.");
}

std::string target_page() {
  return "\n## Targets\n\nVehicles, ships and aircraft among the echoes of the ground. Each `[[target]]` has "
         "a "
         "`type`, a `[target_types.NAME]` of the same file,\nwhose keys it may set anew for itself. It moves "
         "by "
         "the clock of the poses: at `sim_time_ns` of a pose it has\ntravelled for so long; under poses "
         "without "
         "a clock it stands. Read at start.\n\n" +
         std::string(kSceneHeader) + rows(KeyGroup::list, "target_types.") + rows(KeyGroup::list, "target.");
}

std::string daemon_section_names() {
  std::string names;
  for (const Section* section : sections())
    if (section->of_daemon) names += (names.empty() ? "`[" : ", `[") + std::string(section->name) + "]`";
  return names;
}

std::string scene_pages() {
  return "\n## The rest of a scene file\n\nRead at start and again at SIGHUP. SIGHUP takes over tokens and "
         "certificate, radar parameters whose text has changed\n(except those of a radar that a client "
         "controls), terrain, buildings, surfaces and materials, `[log]` and the limits of `[server]`; "
         "the\nlog names what needs a restart. The sections `[terrain]`, `[earth]`, `[run]` and those of the "
         "daemon\n(" +
         daemon_section_names() +
         ") take variables and flags as above. Relative paths start at the scene file's folder; `/vsi...` "
         "paths, URLs and\n`DRIVER:...` names are used as written. A scene needs either `terrain.dem` or "
         "`terrain.synthetic`. Over synthetic ground\n`earth.radius_factor` defaults to `inf`.\n\n" +
         std::string(kSceneHeader) + rows(KeyGroup::section) +
         "\n`[[buildings]]`, `[[prisms]]` and `[[surfaces]]` may each occur several times:\n\n" +
         kSceneHeader + rows(KeyGroup::list, "buildings.") + rows(KeyGroup::list, "prisms.") +
         rows(KeyGroup::list, "surfaces.") +
         "\n## Materials\n\n`[materials.NAME]` changes a built-in material or adds one:\n\n" + kSceneHeader +
         rows(KeyGroup::material) +
         "\nThe built-in materials. Gamma is for 10 GHz and grazing angles between a few degrees and about "
         "60; `sections/materials.cpp`\nnames the sources.\n\n| material | model | gamma, dB "
         "|\n|---|---|---|\n" +
         shipped_rows();
}

Json limits_json(const Key& key) {
  Json limits = Json::object();
  if (std::isfinite(key.limits.low)) limits[key.limits.low_open ? "above" : "at_least"] = key.limits.low;
  if (std::isfinite(key.limits.high)) limits[key.limits.high_open ? "below" : "at_most"] = key.limits.high;
  if (!key.choices.empty()) {
    limits["one_of"] = Json::array();
    for (const Choice& choice : key.choices)
      limits[choice.retired ? "retired" : "one_of"].push_back(choice.name);
  }
  return limits;
}

/// TOML's numbers, texts, lists and truths are JSON's; what is not ("inf", words) becomes a text.
Json default_json(const std::string& text) {
  const Json value = Json::parse(text, nullptr, false);
  return value.is_discarded() ? Json(text) : value;
}

}  // namespace

std::string parameters_json() {
  Json list = Json::array();
  for (const KeyText& key : all_keys()) {
    const Parameter* p = key.parameter;
    list.push_back({{"key", key.name},
                    {"message_field", p == nullptr ? Json() : Json(p->message_field())},
                    {"type", key.type},
                    {"unit", key.key.unit},
                    {"default", default_json(key.default_text)},
                    {"limits", limits_json(key.key)},
                    {"allowed", key.allowed},
                    {"change", change_name(key.change)},
                    {"text", key.key.summary}});
    if (p == nullptr) continue;
    for (const Choice& choice : p->key.choices)
      list.back()["enumerators"][std::string(choice.name)] = choice.wire_name;
    if (!p->meaning.knob.empty()) list.back()["knob"] = p->meaning.knob;
    std::istringstream modes{std::string(p->meaning.modes)};
    for (std::string word; modes >> word;) list.back()["modes"].push_back(word);
    if (p->meaning.of_programs) list.back()["of_programs"] = true;
    if (p->meaning.not_ideal) list.back()["not_ideal"] = true;
    if (p->meaning.aim) list.back()["aim"] = true;
  }
  return list.dump(1) + "\n";
}

std::string parameters_text() {
  std::string text;
  for (const KeyText& key : all_keys())
    if (key.group == KeyGroup::radar)
      text += padded(key.name, 27) + padded(key.default_text, 10) + padded(key.allowed, 40) +
              std::string(key.key.summary) + '\n';
  return text;
}

std::string parameters_markdown() {
  std::string page =
      "# Parameters\n\nWritten by `cmake --build --preset release --target generated` from the tables in "
      "`sections/`; do not edit. `obliq parameters --json` prints the same keys for programs.\n\n## Radar "
      "parameters\n\nEach can "
      "be set in a scene file, by an "
      "environment variable (`OBLIQ_` plus the key in capitals with underscores for\npoints: "
      "`OBLIQ_RADAR_R_MAX_M`), by the flag `--set KEY=VALUE` (`--set RADAR:KEY=VALUE` for one of several "
      "radars), and\nby a message. A flag overrides the environment, the environment the file, the file the "
      "default. *Live* parameters change\nwith the next frame. `[radar]` is one radar named `main`; several "
      "`[[radar]]` tables with a `name` are several radars, each\nwith sections of its own "
      "(`[radar.antenna]`) that override the common `[antenna]`, `[frustum]`, `[bins]` and `[scan]`. "
      "An\nantenna without a position stands at the centre of the dem, or at 33 N 99.5 W over synthetic "
      "ground.\nA length may be a text with its unit, m, km, ft or nmi, a speed with m/s, kt or km/h: "
      "`height_m = \"9842 ft\"`, `--set "
      "radar.r_max_m=80nmi`.\n\n| key | type | default | allowed | change | message field | Modbus | meaning "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const KeyText& key : all_keys()) {
    const Parameter* p = key.parameter;
    if (p == nullptr) continue;
    page += markdown_row({markdown_code(key.name), key.type, markdown_code(key.default_text), key.allowed,
                          change_name(key.change), markdown_code(p->message_field()),
                          p->modbus.address < 0 ? "" : std::to_string(p->modbus.address), key.key.summary});
  }
  page +=
      "\nIn a file, a variable or a flag, `frustum.pixels` = one number or `[columns, rows]` sets both.\n"
      "`beam.file` = a table `cut,angle_deg,gain_db` (cuts azimuth and elevation) for the patterns \"file\"; "
      "in a "
      "scene file\nalone.\n";
  page += "*Modbus*: the parameter's first register; [the map](../modbus/REGISTERS.md) gives its encoding.\n";
  return page + platform_page() + target_page() + preset_page() + quality_page() + scene_pages();
}

std::string preset_text(std::string_view name) {
  const RadarPreset* preset = find_radar_preset(name);
  if (preset == nullptr)
    throw InputError(FieldError{"--preset", toml_string(name), choices_text(radar_preset_choices())}.text());
  return std::string(preset->text);
}

std::string markdown_code(std::string_view text) {
  return text.empty() ? std::string() : "`" + std::string(text) + "`";
}

std::string markdown_row(std::initializer_list<std::string_view> cells) {
  std::string line = "|";
  for (const std::string_view cell : cells) {
    line += ' ';
    for (const char c : cell) line += c == '|' ? "\\|" : std::string(1, c);
    line += " |";
  }
  return line + '\n';
}

}  // namespace obliq
