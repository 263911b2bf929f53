#include "server/control/settings_store.h"

#include "server/control/parameters.h"

namespace obliq {

SettingsStore::SettingsStore(const RadarSettings& initial)
    : current_(std::make_shared<const SettingsSnapshot>(SettingsSnapshot{initial, 1})) {
  if (const auto errors = validate(initial); !errors.empty()) throw InputError(errors.front().text());
}

SettingsPtr SettingsStore::current() const {
  const std::lock_guard lock(mutex_);
  return current_;
}

SettingsStore::Outcome SettingsStore::update(
    const std::function<std::vector<FieldError>(RadarSettings&)>& edit) {
  const std::lock_guard lock(mutex_);
  RadarSettings candidate = current_->settings;
  std::vector<FieldError> errors = edit(candidate);
  for (FieldError& error : validate(candidate)) errors.push_back(std::move(error));
  if (!errors.empty()) return {nullptr, std::move(errors)};
  current_ = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{candidate, current_->version + 1});
  return {current_, {}};
}

SettingsStore::Outcome SettingsStore::set(const RadarSettings& settings) {
  return update([&](RadarSettings& candidate) {
    candidate = settings;
    return std::vector<FieldError>{};
  });
}

}  // namespace obliq
