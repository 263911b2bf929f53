#pragma once
#include <optional>

#include "server/radar/beam/echo_layout.h"

namespace obliq {

/// Why there can be no image of synthetic aperture of an antenna that flies so: it does not fly across it.
std::optional<FieldError> image_fault(const RadarSettings& settings, const EchoPlace& place);
/// The same by what a pose says of its velocity alone; one without stands still.
std::optional<FieldError> image_fault(const RadarSettings& settings, const PoseSettings& pose);
/// Why a mode is refused when it is set, of an antenna so fast: there are too few rows, with what would do. A
/// flight that becomes so fast goes on with the rows that there are.
std::optional<FieldError> too_few_rows(const RadarSettings& settings, const EchoLayout& layout,
                                       const EchoPlace& place);

}  // namespace obliq
