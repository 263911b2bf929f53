#pragma once
#include <optional>

#include "server/radar/beam/echo_layout.h"

namespace obliq {

/// Why a mode that looks at Doppler is refused of an antenna that flies so: too fast for the rows that there
/// may be, with what would do, or not at all.
std::optional<FieldError> doppler_fault(const RadarSettings& settings, const EchoLayout& layout,
                                        const EchoPlace& place);
/// The first of these alone: a flight that grows faster goes on with the rows that there are.
std::optional<FieldError> too_few_rows(const RadarSettings& settings, const EchoLayout& layout,
                                       const EchoPlace& place);

}  // namespace obliq
