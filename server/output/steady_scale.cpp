#include "server/output/steady_scale.h"

#include <utility>

#include "proto/obliq.pb.h"

namespace obliq {

std::optional<DbRange> SteadyScale::next(const wire::FrameDescriptor& descriptor) {
  if (given_) return given_;
  std::string settings = descriptor.settings().SerializeAsString();
  if (settings != settings_) kept_.reset();
  settings_ = std::move(settings);
  return kept_;
}

}  // namespace obliq
