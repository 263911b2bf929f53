#pragma once
#include <string>
#include <vector>

namespace obliq {

/// Warnings that come again and again, told on stderr when they begin and when they are over. Two that differ
/// in their numbers only are the same one.
class WarningChanges {
 public:
  /// All that hold now. `where`: what a line begins with, "FILE:7: " say.
  void tell(std::vector<std::string> now, const std::string& where = {});

 private:
  std::vector<std::string> held_;
};

}  // namespace obliq
