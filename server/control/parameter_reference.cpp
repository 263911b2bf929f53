#include "server/control/parameter_reference.h"

#include "server/control/key_list.h"
#include "server/control/quality_presets.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"

namespace obliq {

namespace {

std::string padded(std::string text, std::size_t width) {
  text.append(text.size() < width ? width - text.size() : 0, ' ');
  return text + "  ";
}

/// A table cell: the bar separates columns, so it has to be escaped inside one.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return " " + text + " |";
}

std::string code(std::string_view text) {
  return text.empty() ? std::string() : "`" + std::string(text) + "`";
}

std::string row(std::string_view name, std::string_view default_text, std::string_view allowed,
                std::string_view summary) {
  return "|" + cell(code(name)) + cell(std::string(default_text)) + cell(std::string(allowed)) +
         cell(std::string(summary)) + "\n";
}

constexpr auto kSceneHeader = "| key | default | allowed | meaning |\n|---|---|---|---|\n";

/// Whether the default is a value, not words about one.
bool is_toml(const KeyText& key) {
  return key.type != "special" || key.default_text.starts_with('"') || key.default_text.starts_with('[');
}

/// The rows of the keys whose names begin so.
std::string rows(KeyGroup group, std::string_view prefix = "") {
  std::string text;
  for (const KeyText& key : all_keys())
    if (key.group == group && key.name.starts_with(prefix))
      text += row(key.name, is_toml(key) ? code(key.default_text) : key.default_text, key.allowed,
                  key.key.summary);
  return text;
}

std::string shipped_rows() {
  std::string text;
  for (const Material& m : shipped_materials()) {
    MaterialKeys keys{m, 0};
    const Row<MaterialKeys>& model = material_rows().front();
    text += "|" + cell(code(m.name)) + cell(code(toml_text(load(model.key, model.slot(keys))))) +
            cell(toml_number(to_db(m.gamma))) + "\n";
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
      "scene.\n\nMeasured over Los Angeles (`deploy/scenes/losangeles.toml`, terrain and 14,535 buildings) "
      "against the reference\nrenderer, whole frames on two threads, by `obliq frontier`. E: power error of "
      "the lit bins, weighted by power; gaps: lit\nbins without a return.\n\n| quality | kind | plates | "
      "pixel_columns | pixel_rows | for | measured |\n|---|---|---|---|---|---|---|\n";
  for (const QualityPreset& p : quality_presets())
    page += "|" + cell(code(p.name)) + cell(std::string(p.kind)) + cell(std::string(p.plates)) +
            cell(p.searched ? "found" : pixels_cell(p.columns, p.columns_per_bin, "azimuth bins")) +
            cell(p.searched ? "found" : pixels_cell(p.rows, p.rows_per_bin, "range bins")) +
            cell(std::string(p.meaning)) + cell(std::string(p.measured)) + "\n";
  return page;
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
         kSceneHeader + rows(KeyGroup::list) +
         "\n## Materials\n\n`[materials.NAME]` changes a built-in material or adds one:\n\n" + kSceneHeader +
         rows(KeyGroup::material) +
         "\nThe built-in materials. Gamma is for 10 GHz and grazing angles between a few degrees and about "
         "60; `sections/materials.cpp`\nnames the sources.\n\n| material | model | gamma, dB "
         "|\n|---|---|---|\n" +
         shipped_rows();
}

}  // namespace

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
      "# Parameters\n\nWritten by `obliq parameters --markdown` from the tables in `sections/`; do not "
      "edit.\n\n## Radar parameters\n\nEach can be set in a scene file, by an "
      "environment variable (`OBLIQ_` plus the key in capitals with underscores for\npoints: "
      "`OBLIQ_RADAR_R_MAX_M`), by the flag `--set KEY=VALUE` (`--set RADAR:KEY=VALUE` for one of several "
      "radars), and\nby a message. A flag overrides the environment, the environment the file, the file the "
      "default. *Live* parameters change\nwith the next frame. `[radar]` is one radar named `main`; several "
      "`[[radar]]` tables with a `name` are several radars, each\nwith sections of its own "
      "(`[radar.antenna]`) that override the common `[antenna]`, `[frustum]`, `[bins]` and `[scan]`. "
      "An\nantenna without a position stands at the centre of the dem, or at 33 N 99.5 W over synthetic "
      "ground.\n\n| key | type | default | allowed | change | message field | Modbus | meaning "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const KeyText& key : all_keys()) {
    if (key.group != KeyGroup::radar) continue;
    page += "|" + cell(code(key.name)) + cell(key.type) + cell(code(key.default_text)) + cell(key.allowed) +
            cell(std::string(change_name(key.change))) + cell(code(key.message_field)) +
            cell(key.modbus_address < 0 ? "" : std::to_string(key.modbus_address)) +
            cell(std::string(key.key.summary)) + "\n";
  }
  page +=
      "\nIn a file, a variable or a flag, `frustum.pixels` = one number or `[columns, rows]` sets both.\n";
  page += "*Modbus*: the parameter's first register; [the map](../modbus/REGISTERS.md) gives its encoding.\n";
  return page + quality_page() + scene_pages();
}

}  // namespace obliq
