#include "client/status.h"

#include <utility>

#include "proto/obliq.pb.h"

namespace obliq::client {

std::string Status::sentence() const {
  std::string line = text;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const FieldFault& fault = fields[i];
    line += (i == 0 ? ": " : "; ") + fault.field + ": found " + fault.found + "; allowed: " + fault.allowed;
  }
  if (number != 0) line += " (error " + std::to_string(number) + ")";
  return line;
}

Status Status::failure(Outcome outcome, std::string text) {
  Status status;
  status.outcome = outcome;
  status.text = std::move(text);
  return status;
}

Status Status::from_error(const wire::Error& error) {
  Status status = failure(Outcome::refused, error.text());
  status.number = error.number();
  for (const wire::FieldFault& fault : error.fields())
    status.fields.push_back({fault.field(), fault.found(), fault.allowed()});
  return status;
}

}  // namespace obliq::client
