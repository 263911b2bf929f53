// The page's files, and which requests HTTP refuses because another site led a browser here.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/http/page_routes.h"
#include "server/net/io_thread.h"
#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"

namespace obliq::test::page_test {
namespace {

using http::is_own_host;
using http::is_own_origin;
using http::Site;

const std::filesystem::path kPage = OBLIQ_SOURCE_DIR "/server/http/page";

HttpReply ask(std::uint16_t port, const std::string& path, const std::string& fields) {
  HttpPeer peer(port);
  peer.send("GET " + path + " HTTP/1.1\r\n" + fields + "\r\n");
  return peer.receive();
}

class HttpPageTest : public testing::Test {
 protected:
  HttpPageTest() : server_(io_.context(), options(), http::page_routes("[1]\n")) {}
  ~HttpPageTest() override {
    server_.stop();
    io_.end();
  }
  std::uint16_t port() const { return server_.port(); }
  int status(const std::string& fields) const { return ask(port(), "/", fields).status; }

  std::string here() const { return "127.0.0.1:" + std::to_string(port()); }

 private:
  static http::HttpOptions options() {
    http::HttpOptions options;
    options.names = {"radar.example"};
    options.origins = {"https://screens.example"};
    return options;
  }
  net::IoThread io_;
  http::HttpServer server_;
};

/// The file, of scripts and styles without indentation and comments: lines of their own, types within a line,
/// ends of lines.
std::string served(const std::filesystem::path& file) {
  if (file.extension() != ".js" && file.extension() != ".css") return text_of(file);
  std::istringstream lines(text_of(file));
  std::string all;
  bool in_comment = false;
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    in_comment |= line.starts_with("/*");
    for (std::size_t at, end; !in_comment && (at = line.find("/** ")) != std::string::npos;
         line.erase(at, end - at)) {
      end = line.find("*/", at) + 2;
      end += line.substr(end).starts_with(' ');
    }
    if (const auto at = line.find(" // "); at != std::string::npos)
      line.erase(line.find_last_not_of(' ', at) + 1);
    if (!in_comment && !line.starts_with("//")) all += line + "\n";
    if (line.find("*/") != std::string::npos) in_comment = false;
  }
  return all;
}

std::string without_empty_lines(std::string text) {
  text.insert(0, 1, '\n');
  for (std::size_t at; (at = text.find("\n\n")) != std::string::npos;) text.erase(at, 1);
  return text;
}

TEST_F(HttpPageTest, EveryFileOfTheFolderIsServedWithItsTypeAndAllAreSmall) {
  int files = 0;
  std::size_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kPage)) {
    if (entry.is_directory()) continue;
    const std::string name = std::filesystem::relative(entry.path(), kPage);
    const HttpReply reply = ask(port(), "/" + name, "Host: " + here() + "\r\n");
    ASSERT_EQ(reply.status, 200) << name;
    EXPECT_EQ(without_empty_lines(reply.body), without_empty_lines(served(entry.path()))) << name;
    bytes += reply.body.size();
    const std::string type(http::media_type(name));
    EXPECT_FALSE(type.empty()) << name;
    EXPECT_NE(reply.headers.find("content-type: " + type + "\r\n"), std::string::npos) << reply.headers;
    ++files;
  }
  EXPECT_GE(files, 1);
  EXPECT_LE(bytes, 270'000u) << "all of the page";
  EXPECT_EQ(http_get(port(), "/").body, text_of(kPage / "index.html"));
  EXPECT_EQ(http_get(port(), "/index.htm").status, 404);
  EXPECT_EQ(http_get(port(), "/../http_server.h").status, 404);
}

TEST_F(HttpPageTest, ParametersAreJson) {
  const HttpReply reply = http_get(port(), "/parameters.json");
  EXPECT_EQ(reply.body, "[1]\n");
  EXPECT_NE(reply.headers.find("content-type: application/json\r\n"), std::string::npos);
}

TEST_F(HttpPageTest, BrowsersAreToldToLoadNothingFromElsewhere) {
  const std::string headers = http_get(port(), "/").headers;
  for (const char* field :
       {"content-security-policy: default-src 'self'; connect-src 'self'; frame-ancestors 'none'\r\n",
        "x-content-type-options: nosniff\r\n", "referrer-policy: no-referrer\r\n"})
    EXPECT_NE(headers.find(field), std::string::npos) << headers;
}

TEST_F(HttpPageTest, AHostMustBeAnAddressLocalhostOrAName) {
  for (const std::string host : {"127.0.0.1", "127.0.0.1:7480", "[::1]:7480", "localhost", "LOCALHOST:1",
                                 "radar.example:7480", "Radar.Example", "192.0.2.7:7480"})
    EXPECT_EQ(status("Host: " + host + "\r\n"), 200) << host;
  for (const std::string host : {"evil.example", "radar.example.evil.example", "127.0.0.1.evil.example",
                                 "localhost.evil.example:7480", "localhost:evil", "[::1", "::1", "1"})
    EXPECT_EQ(status("Host: " + host + "\r\n"), 403) << host;
  EXPECT_EQ(status(""), 400);
  EXPECT_EQ(status("Host:\r\n"), 400);
  EXPECT_EQ(status("Host: localhost\r\nHost: evil.example\r\n"), 400);
  EXPECT_NE(ask(port(), "/", "Host: evil.example\r\n")
                .body.find("found evil.example; allowed: an address, localhost, or one of http.names"),
            std::string::npos);
}

TEST_F(HttpPageTest, AnOriginMustBeThisServersOwnOrOneOfTheList) {
  const std::string host = "Host: " + here() + "\r\n";
  EXPECT_EQ(status(host), 200) << "programs that are no browsers send none";
  EXPECT_EQ(status(host + "Origin: http://" + here() + "\r\n"), 200);
  EXPECT_EQ(status(host + "Origin: https://screens.example\r\n"), 200);
  for (const std::string origin : {"null", "http://evil.example", "http://localhost", "http://127.0.0.1",
                                   "http://screens.example", "https://screens.example.evil.example"})
    EXPECT_EQ(status(host + "Origin: " + origin + "\r\n"), 403) << origin;
  EXPECT_EQ(status(host + "Origin: https://" + here() + "\r\n"), 403) << "another scheme is another origin";
}

TEST(Site, OwnOriginHasTheSchemeOfTheServer) {
  const Site site{.tls = true, .names = {}, .origins = {}};
  EXPECT_TRUE(is_own_origin("https://192.0.2.1:7480", "192.0.2.1:7480", site));
  EXPECT_FALSE(is_own_origin("http://192.0.2.1:7480", "192.0.2.1:7480", site));
}

TEST(HttpPage, TheDaemonServesItFromTheFirstMomentAndNamesIt) {
  const TestFolder folder;
  const std::string scene =
      folder.write("scene.toml", text_of(SmallScene{.terrain = "synthetic = \"hills\"\n"}));
  const Daemon daemon({"--config", scene, "--set", "terrain.cell_m=2.5", "--set", "http.names=radar.example",
                       "--set", "http.range_scales=[0.25, 6, 12]", "--set", "http.range_unit=km"},
                      folder.path(), "loading terrain");
  const std::string log = daemon.log();
  const std::size_t at = log.find("HTTP on ") + 8;
  const std::string address = log.substr(at, log.find(": ", at) - at);
  const std::uint16_t port = port_of(address);
  EXPECT_EQ(http_get(port, "/").body, text_of(kPage / "index.html"));
  EXPECT_EQ(http_get(port, "/readyz").status, 503);
  const HttpReply state = http_get(port, "/page.json");
  EXPECT_EQ(state.status, 200) << "a browser's console has a line for each 503";
  EXPECT_EQ(state.body.find("{\"state\":\"loading: "), 0u) << state.body;
  EXPECT_NE(state.body.find(",\"range_scales\":[0.25,6,12],\"range_unit\":\"km\"}"), std::string::npos)
      << state.body;
  const Outcome json = run_program(OBLIQ_PROGRAM, {"parameters", "--json"}, folder.path());
  EXPECT_EQ(http_get(port, "/parameters.json").body, json.out);
  EXPECT_EQ(ask(port, "/", "Host: radar.example\r\n").status, 200);
  EXPECT_EQ(ask(port, "/readyz", "Host: evil.example\r\n").status, 403);
  EXPECT_NE(daemon.log().find("asked for the host \"evil.example\""), std::string::npos) << daemon.log();
  const Daemon ready({"--config", scene}, folder.path());
  EXPECT_NE(ready.log().find("the picture in a browser: http://127.0.0.1:"), std::string::npos)
      << ready.log();
}

TEST(HttpPage, RangeScalesThatDoNotRiseAreRefused) {
  const TestFolder folder;
  const std::string scene =
      folder.write("scene.toml", text_of(SmallScene{.terrain = "synthetic = \"hills\"\n"}));
  for (const std::string set :
       {"range_scales=[]", "range_scales=[1, 1]", "range_scales=[2, 1]", "range_scales=[0]",
        "range_scales=[501]", "range_scales=wide", "range_unit=ft", "range_unit=1"}) {
    const Outcome outcome = run_program(
        OBLIQD_PROGRAM, {"--config", scene, "--set", "http." + set, "--check-config"}, folder.path());
    EXPECT_EQ(outcome.code, 1) << set;
    EXPECT_NE(outcome.err.find("allowed: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(set.substr(0, set.find('='))), std::string::npos) << outcome.err;
  }
}

TEST(HttpPage, NamesAndOriginsThatAreNoneAreRefused) {
  const TestFolder folder;
  const std::string scene =
      folder.write("scene.toml", text_of(SmallScene{.terrain = "synthetic = \"hills\"\n"}));
  for (const std::string set : {"http.names=radar.example:7480", "http.names=http://radar.example",
                                "http.origins=screens.example", "http.origins=http://screens.example/page"}) {
    const Outcome outcome =
        run_program(OBLIQD_PROGRAM, {"--config", scene, "--set", set, "--check-config"}, folder.path());
    EXPECT_EQ(outcome.code, 1) << set;
    EXPECT_NE(outcome.err.find("allowed: a list of"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace obliq::test::page_test
