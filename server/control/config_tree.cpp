#include "server/control/config_tree.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "terrain/base/files.h"
#include "terrain/base/text.h"

namespace obliq {

namespace {

/// A scene file is written by hand. More than this is a mistaken path (or a device that never ends).
constexpr std::size_t kLargestFile_bytes = 4u << 20;
/// Tables in tables: the deepest key has four parts. Guards the stack against a.a.a.a... of any length.
constexpr int kDeepest = 16;

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

/// Counts the points between the parts of a key, outside quotes and comments. toml++ limits how deep brackets
/// nest, but not dotted keys, and takes tables apart recursively.
void refuse_deep_keys(std::string_view text, const std::string& name) {
  std::size_t line = 1;
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
      dots = 0;
    } else if (c == '.' && ++dots > kDeepest) {
      throw InputError(name + ":" + std::to_string(line) + ": found a key of more than " +
                       std::to_string(kDeepest) + " parts; allowed: the keys of a scene file");
    }
  }
}

ConfigNode convert(const toml::node& node, const std::string& file, int depth) {
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
        out.items.push_back(convert(child, file, depth + 1));
        out.items.back().key = std::string(key.str());
      }
    } else if constexpr (toml::is_array<T>) {
      out.kind = ConfigNode::Kind::array;
      for (const auto& child : n) out.items.push_back(convert(child, file, depth + 1));
    } else if constexpr (toml::is_date<T> || toml::is_time<T> || toml::is_date_time<T>) {
      out.kind = ConfigNode::Kind::date;
    } else {
      out.kind = ConfigNode::Kind::value;
      out.value = Value(n.get());
    }
  });
  return out;
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
  refuse_deep_keys(text, name);
  try {
    return convert(toml::parse(text, name), name, 0);
  } catch (const toml::parse_error& e) {
    throw InputError(name + ":" + std::to_string(e.source().begin.line) +
                     ": found something that is not TOML: " + printable_text(std::string(e.description())));
  }
}

ConfigNode parse_config_value(std::string_view text, std::string where, int layer) {
  ConfigNode node;
  node.kind = ConfigNode::Kind::value;
  node.value = std::string(text);
  // A line break could smuggle in further keys; no value has one.
  const bool one_line = text.find_first_of("\r\n") == std::string_view::npos;
  if (one_line && text.size() < kLargestFile_bytes) {
    refuse_deep_keys(text, where);
    try {
      const toml::table parsed = toml::parse("v = " + std::string(text), std::string_view(where));
      node = convert(*parsed.get("v"), where, 0);
    } catch (const toml::parse_error&) {  // then it is plain text: flags spare the quotes
    }
  }
  const auto mark = [&](auto&& self, ConfigNode& n) -> void {
    n.where = where;
    n.raw = printable_text(std::string(text));
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

}  // namespace obliq
