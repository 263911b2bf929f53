#pragma once
#include <string>

#include "server/radar/targets/target.h"

namespace obliq {

/// What targets of one kind have in common.
struct TargetType {
  std::string name;
  TargetSize size;
};

struct TargetConfig {
  std::string name;
  std::string type;  ///< name of one of the file's
  Target target;
};

}  // namespace obliq
