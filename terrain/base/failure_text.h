#pragma once
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace obliq {

/// What is wrong, in words: what the C++ library throws for want of memory has none of its own.
inline std::string failure_text(const std::exception& failure) {
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr ||
      dynamic_cast<const std::length_error*>(&failure) != nullptr)
    return "there is not enough memory for it; less terrain, smaller frames or a coarser terrain.cell_m need "
           "less";
  return failure.what();
}

}  // namespace obliq
