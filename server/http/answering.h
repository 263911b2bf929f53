#pragma once
// What a request is answered: the page of its route, or why not.
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http_server.h"

namespace obliq::http {

/// Of a request, what its answer depends on.
struct Asked {
  std::string peer;  ///< "127.0.0.1:50000"
  std::string_view target;
  std::string_view authorization;  ///< the field of that name
  bool is_read = false;            ///< GET or HEAD
  bool has_body = false;
};

/// `security` null: everybody may read.
Page page_of(const Asked& asked, const std::vector<Route>& routes, const net::Security* security);

Page error_page(int status, const std::string& text);

}  // namespace obliq::http
