#pragma once
// Settings as text, by the names of obliq.proto's fields.
#include <optional>
#include <string>
#include <string_view>

#include "client/status.h"

namespace obliq::wire {
class RadarSettings;
}

namespace obliq::client {

/// "receiver_gain_db=6 scan_mode=SECTOR_SCAN noise=true scan_bars=-2;-5" into a message. bad_argument names
/// the field, what was found and what is allowed; limits are the server's.
Status read_settings(std::string_view text, wire::RadarSettings& settings);

/// The value of a field, as read_settings takes it; nothing: there is no such field.
std::optional<std::string> setting_text(const wire::RadarSettings& settings, std::string_view name);

}  // namespace obliq::client
