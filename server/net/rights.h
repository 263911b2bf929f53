#pragma once
// THE table of rights: what each request takes. The room, its log and PROTOCOL.md's table follow it.
#include <span>
#include <string_view>

#include "proto/claim.h"
#include "proto/message_type.h"
#include "server/security/token_file.h"

namespace obliq::net {

struct Right {
  wire::MessageType request;
  std::string_view name;
  security::Role role = security::Role::viewer;  ///< that its token must give at least
  wire::ClaimSet claims = 0;                     ///< that its client must hold, of the radar or of the world
  bool admin_always = false;                     ///< an admin needs none of them
  bool truth = false;                            ///< takes server.truth_role too
};

/// In the order in which the log names them.
std::span<const Right> rights();
/// Null: no request of a client that has said Hello, or free for all.
const Right* right_of(wire::MessageType request);

}  // namespace obliq::net
