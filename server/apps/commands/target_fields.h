#pragma once
// Targets as operators write them: KEY=VALUE words, tables of a file, lines of a list.
#include <string>
#include <vector>

#include "server/control/config_tree.h"

namespace obliq::wire {
class Target;
class TargetList;
}  // namespace obliq::wire

namespace obliq {

/// The fields that the message has, a line each, and its route, as [[target]] of a state file has them.
std::string target_text(const wire::Target& target);
/// Such a table.
void read_target(const ConfigNode& table, wire::Target& target, Complaints& complaints);

/// "id=7", "type=truck", "route=47.1,8.2,12" ... : a new target begins with each id. Throws InputError.
std::vector<wire::Target> targets_of_words(const std::vector<std::string>& words);
/// A line of JSON each, as `obliq targets --json` prints them. Throws InputError that names file and line.
std::vector<wire::Target> targets_of_file(const std::string& path);

/// A table for people.
std::string target_table(const wire::TargetList& list);

}  // namespace obliq
