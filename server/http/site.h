#pragma once
// Which requests are meant for this server. A browser sends what any page asks it to, also to a port of the
// machine it runs on, and a foreign name may lead here (DNS rebinding): what it says of itself in Host and
// Origin tells (OWASP ASVS 4.0.3, 14.5.3 and 13.2.3; RFC 9110 section 7.2, RFC 6454 section 7).
#include <string>
#include <string_view>
#include <vector>

namespace obliq::http {

/// What this server is called.
struct Site {
  bool tls = false;
  std::vector<std::string> names;    ///< of hosts, besides addresses and localhost
  std::vector<std::string> origins;  ///< "https://screens.example", besides its own
};

/// Whether Host (with or without a port) is an address, localhost or a name of the site.
bool is_own_host(std::string_view host, const Site& site);
/// Whether an Origin is that of a page which this server sent under that Host, or one of the site's.
bool is_own_origin(std::string_view origin, std::string_view host, const Site& site);

}  // namespace obliq::http
