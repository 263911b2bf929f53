#pragma once
#include <string>

#include "server/http/http_server.h"

namespace obliq::http {

/// A page as it is sent, with the fields that all answers have. To HEAD without the body.
std::string response_text(const Page& page, bool head, bool keep_alive, unsigned http_version);

}  // namespace obliq::http
