#include "server/control/config_tree.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <numeric>

#include "terrain/base/files.h"
#include "terrain/base/text.h"

namespace obliq {

namespace {

/// A scene file is written by hand. More than this is a mistaken path (or a device that never ends).
constexpr std::size_t kLargestFile_bytes = 4u << 20;
/// Tables in tables: the deepest key has four parts. Guards the stack against a.a.a.a... of any length.
constexpr int kDeepest = 16;
/// Values and tables. The largest scenes, with a hundred files and a material for each of a hundred surfaces,
/// have some thousands.
constexpr std::size_t kMostValues = 100'000;

std::string read_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;  // what cannot be looked at cannot be opened either, and says why below
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(name + ": found a folder; allowed: a scene file (TOML)");
  refuse_endless_file(name, name);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(name + ": cannot be read: " + std::strerror(errno));
  std::string text(kLargestFile_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw InputError(name + ": cannot be read: " + std::strerror(errno));
  if (file.gcount() > static_cast<std::streamsize>(kLargestFile_bytes))
    throw InputError(name + ": found more than " + std::to_string(kLargestFile_bytes >> 20) +
                     " MiB; allowed: a scene file (TOML)");
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

/// Counts values, and the points between the parts of a key, outside quotes and comments, before anything is
/// made of them. toml++ limits how deep brackets nest, but not dotted keys, and takes tables apart
/// recursively.
void refuse_deep_or_many_keys(std::string_view text, const std::string& name) {
  std::size_t line = 1;
  std::size_t values = 0;
  int dots = 0;
  char open = 0;  // the quote or '#' that is open, 0: none
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') {
      ++line;
      dots = 0;
      open = 0;  // a string of several lines is left too early: that can only count too many points
    } else if (open != 0) {
      if (c == '\\' && open == '"') ++i;
      if (c == open && open != '#') open = 0;
    } else if (c == '"' || c == '\'' || c == '#') {
      open = c;
    } else if (std::string_view("=,[]{}").find(c) != std::string_view::npos) {
      const bool opens_table = c == '[' && (i == 0 || text[i - 1] == '\n');
      if (c == '=' || c == ',' || opens_table) ++values;
      dots = 0;
    } else if (c == '.' && ++dots > kDeepest) {
      throw InputError(name + ":" + std::to_string(line) + ": found a key of more than " +
                       std::to_string(kDeepest) + " parts; allowed: the keys of a scene file");
    }
  }
  if (values > kMostValues)
    throw InputError(name + ": found about " + std::to_string(values) + " values; allowed: at most " +
                     std::to_string(kMostValues));
}

/// Without the character that was found: of a file that is no scene, such as a key under a wrong name, no
/// part belongs into a log.
std::string without_found(std::string_view description) {
  return printable_text(std::string(description.substr(0, description.find(", saw "))));
}

/// `path`: of keys, as far as the node has any.
ConfigNode convert(const toml::node& node, const std::string& file, const std::string& path, int depth) {
  const auto line = node.source().begin.line;
  ConfigNode out;
  out.where = line > 0 ? file + ":" + std::to_string(line) : file;
  if (depth > kDeepest)
    throw InputError(out.where + ": found tables or lists more than " + std::to_string(kDeepest) +
                     " deep; allowed: the keys of a scene file");
  node.visit([&](const auto& n) {
    using T = std::remove_cvref_t<decltype(n)>;
    if constexpr (toml::is_table<T>) {
      out.kind = ConfigNode::Kind::table;
      for (const auto& [key, child] : n) {
        const std::string below = (path.empty() ? "" : path + ".") + std::string(key.str());
        ConfigNode& item = out.items.emplace_back(convert(child, file, below, depth + 1));
        item.key = std::string(key.str());
      }
    } else if constexpr (toml::is_array<T>) {
      out.kind = ConfigNode::Kind::array;
      for (const auto& child : n) out.items.push_back(convert(child, file, path, depth + 1));
    } else if constexpr (toml::is_date<T> || toml::is_time<T> || toml::is_date_time<T>) {
      out.kind = ConfigNode::Kind::date;
    } else {
      out.kind = ConfigNode::Kind::value;
      out.value = Value(n.get());
      if constexpr (toml::is_string<T>) {
        // The system's calls would end a name there, and so would messages.
        if (n.get().find('\0') != std::string::npos)
          throw InputError(out.where + (path.empty() ? "" : ": " + printable_text(path)) + ": found " +
                           toml_string(n.get().substr(0, 80)) +
                           "; allowed: a text without the character U+0000");
      }
    }
  });
  return out;
}

/// Levenshtein distance: the fewest characters to insert, drop or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string without_underscores(std::string_view word) {
  std::string plain(word);
  std::erase(plain, '_');
  return plain;
}

}  // namespace

const ConfigNode* ConfigNode::find(std::string_view name) const {
  if (kind != Kind::table) return nullptr;
  const auto found = std::ranges::find(items, name, &ConfigNode::key);
  return found == items.end() ? nullptr : &*found;
}

ConfigNode* ConfigNode::find(std::string_view name) {
  return const_cast<ConfigNode*>(std::as_const(*this).find(name));
}

ConfigNode* ConfigNode::table(std::string_view name) {
  if (ConfigNode* there = find(name)) return there->kind == Kind::table ? there : nullptr;
  ConfigNode made;
  made.key = std::string(name);
  made.where = where;
  items.push_back(std::move(made));
  return &items.back();
}

std::string ConfigNode::found_text() const {
  switch (kind) {
    case Kind::value:
      return layer == 0 ? toml_text(value) : raw;
    case Kind::array:
      return "a list";
    case Kind::table:
      return "a table";
    case Kind::date:
      break;
  }
  return "a date or time";
}

ConfigNode parse_config_file(const std::filesystem::path& path) {
  return parse_config_text(read_file(path), path.string());
}

ConfigNode parse_config_text(const std::string& text, const std::string& name) {
  refuse_deep_or_many_keys(text, name);
  try {
    return convert(toml::parse(text, name), name, "", 0);
  } catch (const toml::parse_error& e) {
    throw InputError(name + ":" + std::to_string(e.source().begin.line) +
                     ": found something that is not TOML: " + without_found(e.description()));
  }
}

ConfigNode parse_config_value(std::string_view text, std::string where, int layer) {
  ConfigNode node;
  node.kind = ConfigNode::Kind::value;
  node.value = std::string(text);
  // A line break could smuggle in further keys; no value has one.
  const bool one_line = text.find_first_of("\r\n") == std::string_view::npos;
  if (one_line && text.size() < kLargestFile_bytes) {
    refuse_deep_or_many_keys(text, where);
    try {
      const toml::table parsed = toml::parse("v = " + std::string(text), std::string_view(where));
      node = convert(*parsed.get("v"), where, "", 0);
    } catch (const toml::parse_error&) {  // then it is plain text: flags spare the quotes
    }
  }
  const auto mark = [&](auto&& self, ConfigNode& n) -> void {
    n.where = where;
    n.raw = printable_text(text);
    n.layer = layer;
    for (ConfigNode& item : n.items) self(self, item);
  };
  mark(mark, node);
  if (node.kind == ConfigNode::Kind::value) node.raw = std::string(text);
  return node;
}

ConfigNode nest(std::string_view dotted_key, ConfigNode value) {
  const std::size_t dot = dotted_key.rfind('.');
  value.key = std::string(dot == std::string_view::npos ? dotted_key : dotted_key.substr(dot + 1));
  ConfigNode table;
  table.where = value.where;
  table.layer = value.layer;
  table.items.push_back(std::move(value));
  return dot == std::string_view::npos ? table : nest(dotted_key.substr(0, dot), std::move(table));
}

void merge(ConfigNode& base, const ConfigNode& patch) {
  for (const ConfigNode& item : patch.items) {
    ConfigNode* there = base.find(item.key);
    if (there == nullptr) {
      base.items.push_back(item);
    } else if (there->kind == ConfigNode::Kind::table && item.kind == ConfigNode::Kind::table) {
      merge(*there, item);
    } else {
      *there = item;
    }
  }
}

std::string nearest_name(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t kLongestWord = 64;  // longer ones are no slip of ours
  std::string best;
  if (word.size() > kLongestWord) return best;
  const std::string plain = without_underscores(word);
  std::size_t best_distance = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& candidate : candidates) {
    // A name without its unit ("r_max", "rmax" for "r_max_m") counts as a single slip.
    const std::string stem = without_underscores(candidate.substr(0, candidate.rfind('_')));
    const bool lacks_unit = !plain.empty() && stem == plain;
    const std::size_t distance = lacks_unit ? 1 : edit_distance(plain, without_underscores(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace obliq
