#pragma once
#include <cstdint>
#include <string_view>

namespace obliq::net {

/// What a client may do; each role includes the ones before it.
enum class Role : std::uint8_t {
  viewer,      ///< list, watch, status, RenderOnce
  controller,  ///< claims radars, sets them, subscribes without losses
  admin,       ///< takes control from others
};

constexpr std::string_view role_name(Role role) {
  switch (role) {
    case Role::viewer:
      return "viewer";
    case Role::controller:
      return "controller";
    case Role::admin:
      break;
  }
  return "admin";
}

}  // namespace obliq::net
