#include "server/control/parameter_reference.h"

#include "server/control/material_library.h"
#include "server/control/parameters.h"
#include "server/control/quality_presets.h"
#include "server/control/scene_keys.h"

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

template <class T>
std::string rows(std::span<const Entry<T>> entries, std::string_view prefix, T defaults) {
  std::string text;
  for (const auto& [key, slot] : entries)
    text += row(std::string(prefix) + std::string(key.name), code(toml_text(load(key, slot(defaults)))),
                allowed_text(key, slot(defaults)), key.summary);
  return text;
}

std::string special_rows(std::string_view prefix) {
  std::string text;
  for (const SpecialKey& key : special_keys())
    if (key.name.starts_with(prefix)) text += row(key.name, key.default_text, key.allowed, key.summary);
  return text;
}

std::string material_rows() {
  std::string text;
  for (const Material& m : shipped_materials()) {
    MaterialKeys keys{m, 0};
    const Entry<MaterialKeys>& model = material_entries().front();
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
      "\n## Quality\n\n"
      "`frustum.quality` sets several keys at once, in a file, a variable or a flag; keys that the same file "
      "or "
      "the same\ncommand line names itself win. Pixels that go with the bins end at 16384. A scene that "
      "names "
      "nothing of `[frustum]` has\nthe quality `standard`; one that names pixels or plates, but no kind, and "
      "a RenderOnce "
      "without a frustum, have the oblique frustum,\nspread over the bins that its pixels cover. `oblique` "
      "looks for its "
      "pixels when `obliqd` or `obliq render` has loaded\nthe scene. A variable's key beats\na file's "
      "quality and a flag's quality beats a variable's and a file's "
      "keys."
      "\n\nMeasured over Los Angeles (`deploy/scenes/losangeles.toml`, terrain and 14,535 buildings) against "
      "the reference\nrenderer, whole frames on two threads, by `obliq frontier`. E: power error of the lit "
      "bins, weighted by power; gaps: lit\nbins without a return."
      "\n\n| quality | kind | plates | pixel_columns | pixel_rows | for | measured "
      "|\n|---|---|---|---|---|---|---|\n";
  for (const QualityPreset& p : quality_presets())
    page += "|" + cell(code(p.name)) + cell(std::string(p.kind)) + cell(std::string(p.plates)) +
            cell(p.searched ? "found" : pixels_cell(p.columns, p.columns_per_bin, "azimuth bins")) +
            cell(p.searched ? "found" : pixels_cell(p.rows, p.rows_per_bin, "range bins")) +
            cell(std::string(p.meaning)) + cell(std::string(p.measured)) + "\n";
  return page;
}

std::string daemon_section_names() {
  std::string names;
  for (const std::string_view name : daemon_sections())
    names += (names.empty() ? "`[" : ", `[") + std::string(name) + "]`";
  return names;
}

std::string scene_pages() {
  return "\n## The rest of a scene file\n\n"
         "Read at start, and again at SIGHUP: then tokens and certificate, radars' parameters whose text has "
         "changed (not of\na radar that a client controls), the ground and what stands on it, `[log]` and "
         "the "
         "limits of `[server]` are taken over, and\nwhat needs a restart is named in the log. The sections "
         "`[terrain]`, "
         "`[earth]`, `[run]` and those of the daemon\n(" +
         daemon_section_names() +
         ") take variables and flags as above. Relative paths count from the scene file's folder; `/vsi...` "
         "paths, URLs and "
         "`DRIVER:...` names "
         "stay as they\nare. One of `terrain.dem` and `terrain.synthetic` is needed. The default of "
         "`earth.radius_factor` is `inf` over\nsynthetic ground.\n\n" +
         std::string(kSceneHeader) + special_rows("terrain.") + rows(scene_entries(), "", SceneConfig{}) +
         special_rows("modbus.") + "\n`[[buildings]]`, `[[prisms]]` and `[[surfaces]]` may be repeated:\n\n" +
         kSceneHeader + special_rows("buildings.") + rows(building_entries(), "buildings.", {}) +
         special_rows("prisms.") + rows(prism_entries(), "prisms.", {}) + special_rows("surfaces.") +
         rows(surface_entries(), "surfaces.", {}) +
         "\n## Materials\n\n`[materials.NAME]` changes a material that ships or adds one:\n\n" +
         kSceneHeader + rows(material_entries(), "materials.NAME.", {}) +
         "\nThese ship. Gamma is for 10 GHz and grazing angles between a few degrees and about 60; sources "
         "stand "
         "in\n`material_library.cpp`.\n\n| material | model | gamma, dB |\n|---|---|---|\n" +
         material_rows();
}

}  // namespace

std::string parameters_text() {
  RadarConfig defaults;
  std::string text;
  for (const Parameter& p : parameters()) {
    const Slot slot = p.slot(defaults);
    text += padded(std::string(p.key.name), 27) + padded(toml_text(load(p.key, slot)), 10) +
            padded(allowed_text(p.key, slot), 40) + std::string(p.key.summary) + '\n';
  }
  return text;
}

std::string parameters_markdown() {
  RadarConfig defaults;
  std::string page =
      "# Parameters\n\n"
      "Written by `obliq parameters --markdown` from the tables in `parameters.cpp` and `scene_keys.cpp`; do "
      "not "
      "edit.\n\n"
      "## Radar parameters\n\n"
      "Each can be set in a scene file, by an environment variable (`OBLIQ_` and the key in capitals, with\n"
      "underscores for points: `OBLIQ_RADAR_R_MAX_M`), by the flag `--set KEY=VALUE` (`--set "
      "RADAR:KEY=VALUE` for "
      "one of\nseveral radars), and by a message. Flags beat environment beats file beats defaults. *Live* "
      "ones "
      "change with the\nnext frame. `[radar]` is one radar called `main`; `[[radar]]` with a `name` makes "
      "several, "
      "each with sections of\nits own (`[radar.antenna]`) over the common `[antenna]`, `[frustum]`, `[bins]` "
      "and `[scan]`. "
      "An antenna without a position\nstands at the dem's centre, over synthetic ground at 33 N 99.5 W.\n\n"
      "| key | type | default | allowed | change | message field | Modbus | meaning |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const Parameter& p : parameters()) {
    const Slot slot = p.slot(defaults);
    const std::string message = p.message == WireMessage::pose ? "Pose." : "RadarSettings.";
    page += "|" + cell(code(p.key.name)) + cell(std::string(type_name(slot))) +
            cell(code(toml_text(load(p.key, slot)))) + cell(allowed_text(p.key, slot)) +
            cell(p.change == Change::live ? "live" : "restart") +
            cell(code(message + std::string(p.wire_field))) +
            cell(p.modbus.address < 0 ? "" : std::to_string(p.modbus.address)) +
            cell(std::string(p.key.summary)) + "\n";
  }
  page +=
      "\nIn a file, a variable or a flag, `frustum.pixels` = one number or `[columns, rows]` sets both.\n";
  page +=
      "*Modbus*: the parameter's first register; [the map](../modbus/REGISTERS.md) says how it is coded.\n";
  return page + quality_page() + scene_pages();
}

}  // namespace obliq
