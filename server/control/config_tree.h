#pragma once
// A configuration as written, not yet interpreted: names, values, and the place of each in its source.
#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/key.h"
#include "terrain/base/errors.h"

namespace obliq {

struct ConfigNode {
  enum class Kind { value, array, table, date };

  Kind kind = Kind::table;
  std::string key;                ///< its name in the table that holds it
  Value value;                    ///< kind value
  std::vector<ConfigNode> items;  ///< of an array or a table
  std::string where;              ///< "scene.toml:12", "--set radar.r_max_m", "OBLIQ_RADAR_R_MAX_M"
  std::string raw;                ///< as typed, for flags and environment; a file's nodes have none
  int layer = 0;                  ///< 0: the file's; each variable and each flag is one above those before it

  const ConfigNode* find(std::string_view name) const;
  ConfigNode* find(std::string_view name);
  /// The table of that name, made if there is none. Null if something else has the name.
  ConfigNode* table(std::string_view name);
  /// What is there, for a message: the value, or "a list", "a table", "a date or time".
  std::string found_text() const;
};

/// Reads a TOML file. Throws InputError "FILE:LINE: ..." when it cannot be read or is no TOML.
ConfigNode parse_config_file(const std::filesystem::path& path);
/// As parse_config_file, of a file's text; `name` stands in messages.
ConfigNode parse_config_text(const std::string& text, const std::string& name);

/// One typed value from a flag or the environment: TOML where it is TOML, else the text itself.
ConfigNode parse_config_value(std::string_view text, std::string where, int layer = 1);

/// Wraps a value into the tables of a dotted key: "a.b" = 1 becomes {a: {b: 1}}.
ConfigNode nest(std::string_view dotted_key, ConfigNode value);

/// Lays `patch` over `base`: tables join, anything else is replaced.
void merge(ConfigNode& base, const ConfigNode& patch);

/// What is wrong with a configuration, collected so that all of it is reported at once: the first complaints,
/// and how many follow.
class Complaints {
 public:
  void add(const std::string& where, const FieldError& error) { add(where + ": " + error.text()); }
  void add(std::string line) {
    if (std::ranges::find(lines_, line) != lines_.end()) return;
    if (lines_.size() < kMostLines) {
      lines_.push_back(std::move(line));
    } else {
      ++more_;
    }
  }
  /// What is added now is only counted.
  bool full() const { return lines_.size() == kMostLines; }
  bool empty() const { return lines_.empty(); }

  /// Throws InputError, one complaint a line, if there is any.
  void throw_if_any() const {
    if (lines_.empty()) return;
    std::string text;
    for (const std::string& line : lines_) text += (text.empty() ? "" : "\n") + line;
    if (more_ > 0) text += "\nand " + std::to_string(more_) + " more complaints";
    throw InputError(text);
  }

 private:
  static constexpr std::size_t kMostLines = 100;

  std::vector<std::string> lines_;
  std::size_t more_ = 0;
};

/// The candidate that `word` is most likely a slip of, or empty if none is near.
std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

}  // namespace obliq
