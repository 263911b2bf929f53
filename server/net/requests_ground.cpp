// Queries of the ground.
#include <algorithm>
#include <memory>
#include <string>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/request_limits.h"
#include "server/net/requests.h"
#include "server/net/room.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

using wire::ErrorNumber;

namespace {

std::vector<double> values(const google::protobuf::RepeatedField<double>& field) {
  return {field.begin(), field.end()};
}

/// The antenna of the query's own, in place of a radar's.
PoseSettings read_antenna(const wire::Pose& message, std::vector<FieldError>& errors) {
  PoseSettings antenna;
  for (const FieldError& missing : missing_position(message))
    errors.push_back({"antenna." + missing.field, missing.found, "a value: an antenna stands somewhere"});
  append(errors, merge_message(message, antenna));
  append(errors, validate(antenna));
  return antenna;
}

}  // namespace

void Requests::query_ground(const wire::QueryGround& request) {
  const std::uint64_t id = request.request_id();
  const ServerOptions& options = room_.options();
  if (!options.query_ground)
    return refuse(id, ErrorNumber::render_failed, "this server has no ground that could be queried");
  if (peer_.queries >= options.max_renders_queued)
    return refuse(
        id, ErrorNumber::too_many_renders,
        "too many unanswered queries: max_renders_queued is " + std::to_string(options.max_renders_queued));
  const int most = std::max({request.latitude_deg_size(), request.longitude_deg_size(),
                             request.bearing_deg_size(), request.range_m_size(), request.height_m_size()});
  if (most > static_cast<int>(wire::kMaxQueryPoints)) {
    const std::string limit = std::to_string(wire::kMaxQueryPoints);
    return refuse(id, {"max_query_points",
                       "max_query_points is " + limit + ": ask for more in several queries",
                       {"points", std::to_string(most), "1 to " + limit}});
  }

  auto question = std::make_shared<GroundQuestion>();
  std::vector<FieldError> errors;
  if (!request.radar().empty()) {
    LiveRadar* radar = radar_of(id, request.radar());
    if (radar == nullptr) return;
    question->antenna = radar->poses->at(monotonic_ns()).pose;
    if (request.has_antenna())
      errors.push_back({"antenna", "one, and the radar \"" + radar->name + "\"", "one of the two, or none"});
  } else if (request.has_antenna()) {
    question->antenna = read_antenna(request.antenna(), errors);
  }
  question->latitude_deg = values(request.latitude_deg());
  question->longitude_deg = values(request.longitude_deg());
  question->bearing_deg = values(request.bearing_deg());
  question->range_m = values(request.range_m());
  question->height_m = values(request.height_m());
  question->geoid_undulation_m = request.geoid_undulation_m();
  switch (request.height_reference()) {
    case wire::DATUM:
      question->height_reference = HeightReference::datum;
      break;
    case wire::GROUND:
      question->height_reference = HeightReference::ground;
      break;
    case wire::ELLIPSOID:
      question->height_reference = HeightReference::ellipsoid;
      break;
    default:
      errors.push_back({"height_reference", std::to_string(static_cast<int>(request.height_reference())),
                        "DATUM (0), GROUND (1) or ELLIPSOID (2)"});
  }
  append(errors, faults_of(*question));
  if (!errors.empty()) return refuse(id, ErrorNumber::invalid_value, "query refused", errors);
  room_.query_ground(peer_, id, std::move(question));
}

}  // namespace obliq::net
