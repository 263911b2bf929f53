#pragma once
// What a section of a scene file is made of: keys that are plain values, keys that need a reader of their
// own, and what they must be together. Reading and printing are the same for all.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/config_tree.h"
#include "server/control/row.h"
#include "server/control/scene_config.h"
#include "server/control/section_reader.h"

namespace obliq {

/// What the readers of one scene file share.
struct SceneReading {
  SceneConfig& config;
  SectionReader& top;
  Complaints& complaints;
  std::filesystem::path folder;  ///< of the scene file, absolute
};

/// A special key that the file names, while it is read.
struct FoundKey {
  SceneReading& scene;
  SectionReader& reader;
  const ConfigNode& node;
  const Key& key;
  std::string_view name;  ///< in its table
  std::string allowed;

  void refuse() const { reader.complain(node, name, allowed); }
  /// The text that it is; null if it is none or empty.
  const std::string* text() const;
};

/// A key that no row can hold: a list, a path, a polygon, a material.
template <class T>
struct SpecialKey {
  Key key;                ///< limits and choices are those of the numbers or texts in it
  std::string_view form;  ///< what it may be, before the limits
  void (*read)(const FoundKey& found, T& object);
  std::string (*print)(const T& object, const SceneConfig& config);  ///< as TOML; empty: nothing
  std::string_view default_text = {};                                ///< where a T{} does not tell
  Change change = Change::reload;
};

/// One of them, in the order of a row.
template <class T>
constexpr SpecialKey<T> special(std::string_view name, std::string_view unit, Accepts accepts,
                                std::string_view form, std::string_view summary,
                                decltype(SpecialKey<T>::read) read, decltype(SpecialKey<T>::print) print,
                                std::string_view default_text = {}, Change change = Change::reload) {
  return {{name, unit, accepts.limits, accepts.choices, summary}, form, read, print, default_text, change};
}

/// The keys of a T.
template <class T>
struct Keys {
  std::span<const Row<T>> rows;
  std::span<const SpecialKey<T>> special = {};
};

/// A table that stands once, such as [server]. Its keys have their full names.
struct Section {
  std::string_view name;
  Keys<SceneConfig> keys;
  void (*finish)(SceneReading& scene, SectionReader& reader) = nullptr;  ///< after the keys
  bool of_daemon = false;                                                ///< only the daemon reads it
};

/// A table that may stand several times, such as [[buildings]]. Its keys have their names in the table.
template <class T>
struct ListSection {
  std::string_view name;
  Keys<T> keys;
  std::vector<T> WorldSpec::*list;
  void (*finish)(SceneReading& scene, SectionReader& reader, T& object) = nullptr;
};

/// All that stand once but the radars'; a section comes before those inside it ("terrain.shape").
std::span<const Section* const> sections();

/// The rows of sections(), one after the other.
std::span<const Row<SceneConfig>> scene_rows();

/// What a special key accepts, in words.
std::string allowed_text(const Key& key, std::string_view form);

/// One line of a printed scene file: "r_max_m = 37000.0  # Slant range ... [number ...; live]".
std::string printed_line(std::string_view name, const std::string& value, std::string_view summary,
                         const std::string& allowed, Change change);

/// A key's name in the table `prefix`, or empty if the key is not directly in it.
std::string_view name_in(std::string_view prefix, std::string_view name);

template <class T>
void read_keys(SceneReading& scene, SectionReader& reader, const Keys<T>& keys, std::string_view prefix,
               T& object) {
  for (const Row<T>& row : keys.rows)
    if (const auto name = name_in(prefix, row.key.name); !name.empty())
      reader.read(name, row.key, row.slot(object));
  for (const SpecialKey<T>& special : keys.special) {
    const auto name = name_in(prefix, special.key.name);
    if (const ConfigNode* node = reader.take(name))
      special.read({scene, reader, *node, special.key, name, allowed_text(special.key, special.form)},
                   object);
  }
}

template <class T>
std::string printed_keys(const Keys<T>& keys, std::string_view prefix, T object, const SceneConfig& config) {
  std::string text;
  for (const SpecialKey<T>& special : keys.special)
    if (const std::string value = special.print(object, config); !value.empty())
      text += printed_line(name_in(prefix, special.key.name), value, special.key.summary,
                           allowed_text(special.key, special.form), special.change);
  for (const auto& [key, slot, change] : keys.rows)
    text += printed_line(name_in(prefix, key.name), toml_text(load(key, slot(object))), key.summary,
                         allowed_text(key, slot(object)), change);
  return text;
}

/// The keys of [mount].
std::span<const Row<RadarConfig>> mount_rows();

/// Reads all of sections().
void read_sections(SceneReading& scene);
/// Reads one that is in no other.
void read_section(SceneReading& scene, const Section& section);
/// All of sections() as they stand in a scene file.
std::string printed_sections(const SceneConfig& config);

template <class T>
void read_list(SceneReading& scene, const ListSection<T>& section) {
  scene.top.each_table(section.name, [&](const ConfigNode& table) {
    T object;
    SectionReader reader(table, std::string(section.name), scene.complaints);
    read_keys(scene, reader, section.keys, "", object);
    if (section.finish != nullptr) section.finish(scene, reader, object);
    reader.finish();
    (scene.config.world.*section.list).push_back(std::move(object));
  });
}

template <class T>
std::string printed_list(const ListSection<T>& section, const SceneConfig& config) {
  std::string text;
  for (const T& object : config.world.*section.list)
    text += "\n[[" + std::string(section.name) + "]]\n" + printed_keys(section.keys, "", object, config);
  return text;
}

}  // namespace obliq
