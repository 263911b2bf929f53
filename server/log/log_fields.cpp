#include "server/log/log_fields.h"

namespace obliq {
namespace {

std::vector<LogField>& fields_of_thread() {
  thread_local std::vector<LogField> fields;
  return fields;
}

}  // namespace

LogFields::LogFields(std::initializer_list<LogField> fields) : before_(fields_of_thread().size()) {
  fields_of_thread().insert(fields_of_thread().end(), fields);
}

LogFields::~LogFields() { fields_of_thread().resize(before_); }

const std::vector<LogField>& LogFields::current() { return fields_of_thread(); }

}  // namespace obliq
