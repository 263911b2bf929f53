#include "server/apps/daemon/library_logs.h"

#include <google/protobuf/stubs/logging.h>
#include <spdlog/spdlog.h>

#include <string>

namespace obliq {

void take_over_library_logs() {
  google::protobuf::SetLogHandler(
      [](google::protobuf::LogLevel, const char*, int, const std::string& message) {
        spdlog::debug("protobuf: {}", message);  // the request is answered with an Error, which is logged
      });
}

}  // namespace obliq
