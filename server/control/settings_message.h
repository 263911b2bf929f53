#pragma once
// Settings and poses to and from their messages, field by field through the table of parameters.
#include <functional>
#include <mutex>
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class RadarSettings;
class Pose;
}  // namespace obliq::wire

namespace obliq {

struct Parameter;

/// Takes over the fields that the message carries; absent ones keep their value, but a place or a time
/// without a velocity ends the one that was given. Returns what does not fit its field (an enumerator that
/// does not exist); limits are validate()'s. Never throws on what a peer may send.
[[nodiscard]] std::vector<FieldError> merge_message(const wire::RadarSettings& message,
                                                    RadarSettings& settings);
[[nodiscard]] std::vector<FieldError> merge_message(const wire::Pose& message, PoseSettings& pose);

/// A velocity is of the pose that it stands in: whether this parameter says of another one, of its place or
/// time.
bool ends_velocity(const Parameter& parameter);

/// As merge_message, of a request for a change: planes follow the azimuth bins where planes_per_bin is above
/// 0 and the request names no pixel_columns (server/control/planes_per_bin.h).
[[nodiscard]] std::vector<FieldError> merge_request(const wire::RadarSettings& message,
                                                    RadarSettings& settings);

/// Writes every field, but for those that are left open: a velocity that was not given.
void write_message(const RadarSettings& settings, wire::RadarSettings& message);
void write_message(const PoseSettings& pose, wire::Pose& message);
/// Every field that merge_request needs to arrive at the same: pixel_columns would end planes_per_bin.
void write_request(const RadarSettings& settings, wire::RadarSettings& message);

/// An ideal map's settings: none is set that makes bins more than its echoes (Meaning::not_ideal). Else every
/// bin with a value is drawn, whatever its state, and nothing is made up for the range.
bool is_ideal(const wire::RadarSettings& message);

/// The published settings of one live radar. What is published never changes: a change is a new snapshot with
/// the next version, and a renderer keeps the one it began with. Safe from any thread.
class SettingsStore {
 public:
  /// Publishes version 1 as it is: a scene file's settings are valid, a recording's need not be.
  explicit SettingsStore(const RadarSettings& initial);

  SettingsPtr current() const;

  struct Outcome {
    SettingsPtr published;           ///< null when refused
    std::vector<FieldError> errors;  ///< all reasons of a refusal
  };

  /// Edits a copy of the current settings, and publishes it if it is valid and `edit` found no fault of its
  /// own. A refused change leaves everything as it was. No other update comes between reading and publishing;
  /// `edit` runs under the store's lock and must not come back to it.
  Outcome update(const std::function<std::vector<FieldError>(RadarSettings&)>& edit);

  /// Publishes complete settings if they are valid.
  Outcome set(const RadarSettings& settings);

 private:
  mutable std::mutex mutex_;
  SettingsPtr current_;
};

}  // namespace obliq
