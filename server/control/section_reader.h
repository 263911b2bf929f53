#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/config_tree.h"
#include "server/control/key.h"

namespace obliq {

/// store() of what a node has: a value, or for a list its items.
std::optional<FieldError> store_node(const Key& key, const Slot& slot, const ConfigNode& node);

/// Reads one table of a configuration. Remembers which keys were asked for; finish() refuses the others
/// and suggests the nearest name.
class SectionReader {
 public:
  /// prefix: the table's dotted name, for messages; empty at the top.
  SectionReader(const ConfigNode& table, std::string prefix, Complaints& complaints);

  /// The node of that name, or null. Makes the name known.
  const ConfigNode* take(std::string_view name);

  /// Reads and checks one value into its place. False when it is not there or refused.
  bool read(std::string_view name, const Key& key, const Slot& slot);

  /// Reads one value into its place by type alone, without its limits.
  bool read_unchecked(std::string_view name, const Key& key, const Slot& slot);

  /// A list of numbers within limits, of at least and at most so many; or one number, if at_least is 1.
  std::vector<double> numbers(std::string_view name, const Limits& limits, std::size_t at_least,
                              std::size_t at_most);

  /// A text or a list of texts.
  std::vector<const ConfigNode*> texts(std::string_view name);

  /// Calls `read_table` for a table, if it is there.
  void one_table(std::string_view name, const std::function<void(const ConfigNode&)>& read_table);

  /// Calls `read_table` for a table, or for each table of a list of tables.
  void each_table(std::string_view name, const std::function<void(const ConfigNode&)>& read_table);

  /// Complains where the table does not name it. what: that it is to be.
  void demand(std::string_view name, const std::string& what);
  void complain(const ConfigNode& node, std::string_view name, const std::string& allowed);
  void finish();

  const ConfigNode& table() const { return table_; }
  std::string full_name(std::string_view name) const;

 private:
  const ConfigNode& table_;
  std::string prefix_;
  Complaints& complaints_;
  std::vector<std::string> known_;
};

}  // namespace obliq
