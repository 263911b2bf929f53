#include "server/control/section_reader.h"

#include <algorithm>

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

std::optional<double> number_of(const ConfigNode& node) {
  if (node.kind != Kind::value) return std::nullopt;
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) return static_cast<double>(*whole);
  return std::nullopt;
}

bool is_text(const ConfigNode& node) {
  return node.kind == Kind::value && std::holds_alternative<std::string>(node.value);
}

}  // namespace

std::optional<FieldError> store_node(const Key& key, const Slot& slot, const ConfigNode& node) {
  const FieldError unfit{std::string(key.name), node.found_text(), allowed_text(key, slot)};
  Value value = node.value;
  if (node.kind == Kind::array && std::holds_alternative<std::vector<double>*>(slot)) {
    std::vector<double> numbers;
    for (const ConfigNode& item : node.items) {
      const auto number = number_of(item);
      if (!number) return unfit;
      numbers.push_back(*number);
    }
    value = std::move(numbers);
  } else if (node.kind != Kind::value) {
    return unfit;
  }
  auto error = store(key, slot, value);
  if (error) error->found = unfit.found;
  return error;
}

SectionReader::SectionReader(const ConfigNode& table, std::string prefix, Complaints& complaints)
    : table_(table), prefix_(std::move(prefix)), complaints_(complaints) {}

std::string SectionReader::full_name(std::string_view name) const {
  return prefix_.empty() ? std::string(name) : prefix_ + "." + std::string(name);
}

const ConfigNode* SectionReader::take(std::string_view name) {
  if (std::ranges::find(known_, name) == known_.end()) known_.emplace_back(name);
  return table_.find(name);
}

void SectionReader::demand(std::string_view name, const std::string& what) {
  if (table_.find(name) == nullptr) complaints_.add(table_.where, {full_name(name), "nothing", what});
}

void SectionReader::complain(const ConfigNode& node, std::string_view name, const std::string& allowed) {
  complaints_.add(node.where, FieldError{full_name(name), node.found_text(), allowed});
}

bool SectionReader::read_unchecked(std::string_view name, const Key& key, const Slot& slot) {
  const ConfigNode* node = take(name);
  if (node == nullptr) return false;
  // A flag's text needs no quotes, even if it looks like a number.
  const bool bare_text = node->layer > 0 && std::holds_alternative<std::string*>(slot) && !is_text(*node);
  const auto error = bare_text ? store(key, slot, node->raw) : store_node(key, slot, *node);
  if (error) complain(*node, name, error->allowed);
  return !error;
}

bool SectionReader::read(std::string_view name, const Key& key, const Slot& slot) {
  if (!read_unchecked(name, key, slot)) return false;
  const bool good = !check(key, slot);
  if (!good) complain(*table_.find(name), name, allowed_text(key, slot));
  return good;
}

std::vector<double> SectionReader::numbers(std::string_view name, const Limits& limits, std::size_t at_least,
                                           std::size_t at_most) {
  const ConfigNode* node = take(name);
  if (node == nullptr) return {};
  std::vector<double> values;
  bool good = true;
  const auto append = [&](const ConfigNode& item) {
    const auto value = number_of(item);
    good = good && value && limits.contains(*value);
    if (value) values.push_back(*value);
  };
  if (node->kind == Kind::array) {
    for (const ConfigNode& item : node->items) append(item);
  } else {
    append(*node);
  }
  if (good && values.size() >= at_least && values.size() <= at_most) return values;
  double any = 0;
  const std::string each = allowed_text(Key{name, "", limits}, &any);
  const std::string count = at_least == at_most ? std::to_string(at_least)
                                                : std::to_string(at_least) + " to " + std::to_string(at_most);
  complain(*node, name, "a list of " + count + ", each a " + each);
  return {};
}

std::vector<const ConfigNode*> SectionReader::texts(std::string_view name) {
  const ConfigNode* node = take(name);
  if (node == nullptr) return {};
  std::vector<const ConfigNode*> found;
  if (is_text(*node)) found.push_back(node);
  if (node->kind == Kind::array && std::ranges::all_of(node->items, is_text))
    for (const ConfigNode& item : node->items) found.push_back(&item);
  const bool all_said = std::ranges::none_of(
      found, [](const ConfigNode* text) { return std::get<std::string>(text->value).empty(); });
  if (found.empty() || !all_said) {
    complain(*node, name, "a text in quotes, or a list of such");
    return {};
  }
  return found;
}

void SectionReader::one_table(std::string_view name,
                              const std::function<void(const ConfigNode&)>& read_table) {
  const ConfigNode* node = take(name);
  if (node == nullptr) return;
  if (node->kind == Kind::table) {
    read_table(*node);
  } else {
    complain(*node, name, "one table");
  }
}

void SectionReader::each_table(std::string_view name,
                               const std::function<void(const ConfigNode&)>& read_table) {
  const ConfigNode* node = take(name);
  if (node == nullptr) return;
  const auto is_table = [](const ConfigNode& n) { return n.kind == Kind::table; };
  if (is_table(*node)) {
    read_table(*node);
  } else if (node->kind == Kind::array && std::ranges::all_of(node->items, is_table)) {
    for (const ConfigNode& item : node->items) read_table(item);
  } else {
    complain(*node, name, "a table");
  }
}

void SectionReader::finish() {
  for (const ConfigNode& item : table_.items) {
    if (std::ranges::find(known_, item.key) != known_.end()) continue;
    const std::string near = complaints_.full() ? "" : nearest_name(item.key, known_);
    std::string allowed;
    if (!near.empty()) {
      allowed = "did you mean " + full_name(near) + "?";
    } else {
      std::vector<std::string> names = known_;
      std::ranges::sort(names);
      for (const std::string& known : names) allowed += (allowed.empty() ? "" : ", ") + known;
    }
    complaints_.add(item.where, FieldError{full_name(toml_key(item.key)), "an unknown key", allowed});
  }
}

}  // namespace obliq
