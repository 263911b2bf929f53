#include "server/http/response_text.h"

#include <boost/beast/http.hpp>
#include <sstream>
#include <string>

namespace obliq::http {

namespace bhttp = boost::beast::http;

std::string response_text(const Page& page, bool head, bool keep_alive, unsigned http_version) {
  bhttp::response<bhttp::empty_body> response(static_cast<bhttp::status>(page.status), http_version);
  response.set(bhttp::field::content_type, page.type);
  response.set(bhttp::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", "default-src 'self'; connect-src 'self'; frame-ancestors 'none'");
  response.set("Referrer-Policy", "no-referrer");
  if (page.status == 401) response.set(bhttp::field::www_authenticate, "Bearer");
  if (page.status == 405) response.set(bhttp::field::allow, "GET, HEAD");
  if (page.status == 426) response.set(bhttp::field::upgrade, "websocket");
  if (page.retry_after_s > 0) response.set(bhttp::field::retry_after, std::to_string(page.retry_after_s));
  response.content_length(page.body.size());
  response.keep_alive(keep_alive);
  std::ostringstream header;
  header << response.base();
  return head ? header.str() : header.str() + page.body;
}

}  // namespace obliq::http
