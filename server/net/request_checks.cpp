#include "server/net/request_checks.h"

#include <iterator>
#include <string>

#include "proto/obliq.pb.h"

namespace obliq::net {

void append(std::vector<FieldError>& errors, std::vector<FieldError> more) {
  errors.insert(errors.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<FieldError> missing_position(const wire::Pose& pose) {
  std::vector<FieldError> errors;
  const auto demand = [&](bool there, const char* field) {
    if (!there) errors.push_back({field, "nothing", "a value: a frame needs an antenna"});
  };
  demand(pose.has_latitude_deg(), "latitude_deg");
  demand(pose.has_longitude_deg(), "longitude_deg");
  demand(pose.has_height_m(), "height_m");
  return errors;
}

}  // namespace obliq::net
