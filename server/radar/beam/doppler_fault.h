#pragma once
#include <optional>

#include "server/radar/beam/echo_layout.h"

namespace obliq {

/// Why a mode that looks at Doppler has no frames of an antenna that flies so: too fast for the rows that
/// there may be, with what would do, or not at all.
std::optional<FieldError> doppler_fault(const RadarSettings& settings, const EchoLayout& layout,
                                        const EchoPlace& place);

}  // namespace obliq
