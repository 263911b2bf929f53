#pragma once
#include <string_view>

#include "proto/error_number.h"

namespace obliq::net {

/// What an operator can do about a client that was sent away with this error; begins with "; " if there is
/// anything.
std::string_view advice(wire::ErrorNumber number);

}  // namespace obliq::net
