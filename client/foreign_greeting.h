#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace obliq::client {

/// Who has said these first bytes, which are no obliq stream, and what to do about it.
std::string foreign_greeting(std::span<const std::byte> first);

}  // namespace obliq::client
