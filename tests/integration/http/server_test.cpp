// The HTTP server against peers that are right, wrong, slow and many.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/net/io_thread.h"
#include "terrain/base/errors.h"
#include "tests/integration/http_peer.h"

namespace obliq::test::server_test {
namespace {

using http::HttpOptions;
using http::HttpServer;

constexpr const char* kGet = "GET /page HTTP/1.1\r\nHost: localhost\r\n\r\n";
constexpr const char* kLarge = "GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n";

class HttpServerTest : public testing::Test {
 protected:
  explicit HttpServerTest(HttpOptions options = of_one_address())
      : server_(io_.context(), options,
                {{"/page", true,
                  [] {
                    return http::Page{200, "text/plain", "words"};
                  }},
                 {"/large", true, [] {
                    return http::Page{200, "text/plain", std::string(32 << 20, 'x')};
                  }}}) {}
  ~HttpServerTest() override {
    server_.stop();
    io_.end();
  }
  std::uint16_t port() const { return server_.port(); }
  /// Peers here all come from 127.0.0.1, and many at a time.
  static HttpOptions of_one_address() {
    HttpOptions options;
    options.max_connections_per_address = options.max_connections;
    return options;
  }
  static HttpOptions limited(double timeout_s, int connections, int of_an_address, int requests) {
    HttpOptions options;
    options.timeout_s = timeout_s;
    options.max_connections = connections;
    options.max_connections_per_address = of_an_address;
    options.max_requests = requests;
    return options;
  }

 private:
  net::IoThread io_;
  HttpServer server_;
};

class ImpatientHttpServerTest : public HttpServerTest {
 protected:
  ImpatientHttpServerTest() : HttpServerTest(limited(1, 64, 16, 1000)) {}
};

/// Time is not what ends anything here.
class SmallHttpServerTest : public HttpServerTest {
 protected:
  SmallHttpServerTest() : HttpServerTest(limited(600, 3, 16, 2)) {}
};

/// Nor here.
class SharedHttpServerTest : public HttpServerTest {
 protected:
  SharedHttpServerTest() : HttpServerTest(limited(600, 4, 3, 1000)) {}
};

TEST_F(HttpServerTest, AKnownPathIsAnsweredAndTheConnectionGoesOn) {
  HttpPeer peer(port());
  for (int i = 0; i < 3; ++i) {
    peer.send(kGet);
    const HttpReply reply = peer.receive();
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.body, "words");
    EXPECT_NE(reply.headers.find("cache-control: no-store"), std::string::npos) << reply.headers;
  }
}

TEST_F(HttpServerTest, RequestsSentAllAtOnceAreAnsweredInTurn) {
  HttpPeer peer(port());
  peer.send(std::string(kGet) + "GET /none HTTP/1.1\r\nHost: localhost\r\n\r\n" + kGet);
  EXPECT_EQ(peer.receive().status, 200);
  EXPECT_EQ(peer.receive().status, 404);
  EXPECT_EQ(peer.receive().status, 200);
}

TEST_F(HttpServerTest, HeadIsGetWithoutTheBody) {
  HttpPeer peer(port());
  peer.send("HEAD /page HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const HttpReply reply = peer.receive(true);
  EXPECT_EQ(reply.status, 200);
  EXPECT_NE(reply.headers.find("content-length: 5\r\n"), std::string::npos) << reply.headers;
  peer.send(kGet);  // whose answer would be garbled by a body
  EXPECT_EQ(peer.receive().body, "words");
}

TEST_F(HttpServerTest, AQueryIsNotPartOfThePath) {
  EXPECT_EQ(http_get(port(), "/page?x=1").status, 200);
  EXPECT_EQ(http_get(port(), "/pages").status, 404);
}

TEST_F(HttpServerTest, OtherMethodsAre405AndSayWhichAreAllowed) {
  for (const std::string method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "PATCH", "NONSENSE"}) {
    HttpPeer peer(port());
    peer.send(method + " /page HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
    const HttpReply reply = peer.receive();
    EXPECT_EQ(reply.status, 405) << method;
    EXPECT_NE(reply.headers.find("allow: get, head"), std::string::npos) << reply.headers;
  }
}

TEST_F(HttpServerTest, ARequestWithABodyIsRefusedAndTheConnectionEnds) {
  for (const std::string body : {"Content-Length: 5\r\n\r\nwords", "Content-Length: 99999999999\r\n\r\n",
                                 "Transfer-Encoding: chunked\r\n\r\n5\r\nwords\r\n0\r\n\r\n"}) {
    HttpPeer peer(port());
    peer.send("GET /page HTTP/1.1\r\nHost: localhost\r\n" + body);
    EXPECT_EQ(peer.receive().status, 413) << body;
    EXPECT_TRUE(peer.closed());
  }
}

TEST_F(HttpServerTest, WhatIsNoHttpIs400) {
  using namespace std::string_literals;
  for (const std::string& bytes :
       {"hello\r\n\r\n"s, "GET /page HTTP/9.9\r\n\r\n"s, "GET /page\r\n\r\n"s,
        "GET /pa\0ge HTTP/1.1\r\n\r\n"s, "GET /page HTTP/1.1\r\nno colon\r\n\r\n"s,
        "GET /page HTTP/1.1\r\nContent-Length: -1\r\n\r\n"s,
        "GET /page HTTP/1.1\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n"s,
        "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 a TLS client\r\n\r\n"s}) {
    HttpPeer peer(port());
    peer.send(bytes);
    EXPECT_EQ(peer.receive().status, 400) << bytes;
    EXPECT_TRUE(peer.closed());
  }
}

TEST_F(HttpServerTest, AHugeHeaderIs431) {
  HttpPeer one(port());
  one.send("GET /page HTTP/1.1\r\nX-Long: " + std::string(100'000, 'x') + "\r\n\r\n");
  EXPECT_EQ(one.receive().status, 431);
  HttpPeer many(port());
  std::string lines = "GET /page HTTP/1.1\r\n";
  for (int i = 0; i < 10'000; ++i) lines += "X-" + std::to_string(i) + ": y\r\n";
  many.send(lines);
  EXPECT_EQ(many.receive().status, 431);
  EXPECT_EQ(http_get(port(), "/page").status, 200);
}

TEST_F(HttpServerTest, EveryCutOfARequestIsSurvived) {
  const std::string whole = kGet;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    HttpPeer peer(port());
    peer.send(whole.substr(0, n));
  }
  EXPECT_EQ(http_get(port(), "/page").status, 200);
}

TEST_F(ImpatientHttpServerTest, ASlowHeaderIsCutOffHoweverItDribbles) {
  HttpPeer peer(port());
  // One byte at a time, for ever: a limit between bytes would never be reached.
  bool taken = true;
  for (int i = 0; i < 10'000 && taken; ++i) {
    taken = peer.send("X");
    usleep(5000);
  }
  EXPECT_FALSE(taken);
}

TEST_F(ImpatientHttpServerTest, AnIdleConnectionIsClosed) {
  HttpPeer silent(port());
  HttpPeer polite(port());
  polite.send(kGet);
  EXPECT_EQ(polite.receive().status, 200);
  EXPECT_TRUE(polite.closed());
  EXPECT_TRUE(silent.closed());
}

TEST_F(SmallHttpServerTest, WhereAllAreBeingAnsweredTheNewestAreTurnedAwayUntilThereIsRoom) {
  std::vector<std::unique_ptr<HttpPeer>> peers;
  for (int i = 0; i < 3; ++i) {
    peers.push_back(std::make_unique<HttpPeer>(port()));
    peers.back()->send(kLarge);
    EXPECT_EQ(peers.back()->receive(true).status, 200);  // the header; the rest is not read
  }
  HttpPeer newest(port());
  const HttpReply reply = newest.receive();
  EXPECT_EQ(reply.status, 503);
  EXPECT_EQ(reply.body, "http.max_connections reached\n");
  EXPECT_NE(reply.headers.find("retry-after: 600\r\n"), std::string::npos) << reply.headers;
  peers.clear();
  int status = 503;
  while (status == 503) status = http_get(port(), "/page").status;
  EXPECT_EQ(status, 200);
}

TEST_F(SmallHttpServerTest, WhoAsksNothingKeepsNobodyOut) {
  std::vector<std::unique_ptr<HttpPeer>> silent;
  for (int i = 0; i < 20; ++i) silent.push_back(std::make_unique<HttpPeer>(port()));
  HttpPeer newest(port());
  newest.send(kGet);
  EXPECT_EQ(newest.receive().status, 200);
  EXPECT_TRUE(silent.front()->closed()) << "the oldest goes first";
}

TEST_F(SharedHttpServerTest, OneHostTakesNoPlaceOfOthers) {
  HttpPeer other(port(), "127.0.0.2");
  other.send(kGet);
  EXPECT_EQ(other.receive().status, 200);
  std::vector<std::unique_ptr<HttpPeer>> silent;
  for (int i = 0; i < 20; ++i) silent.push_back(std::make_unique<HttpPeer>(port()));
  other.send(kGet);
  EXPECT_EQ(other.receive().status, 200) << "it has not been shown the door for those of 127.0.0.1";
  EXPECT_TRUE(silent.front()->closed());
}

TEST_F(HttpServerTest, ATargetInAbsoluteFormIsAnswered) {  // RFC 9112 section 3.2.2
  HttpPeer peer(port());
  for (const auto& [target, status] :
       std::vector<std::pair<std::string, int>>{{"http://here/page", 200},
                                                {"http://here:80/page?x=1", 200},
                                                {"HTTP://here/page", 200},
                                                {"http://here", 404},
                                                {"http://here/other", 404},
                                                {"/http://here/page", 404}}) {
    peer.send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(peer.receive().status, status) << target;
  }
}

TEST_F(SmallHttpServerTest, AConnectionIsNotKeptForEver) {
  HttpPeer peer(port());
  peer.send(std::string(kGet) + kGet + kGet);
  EXPECT_EQ(peer.receive().status, 200);
  const HttpReply last = peer.receive();
  EXPECT_EQ(last.status, 200);
  EXPECT_NE(last.headers.find("connection: close"), std::string::npos) << last.headers;
  EXPECT_TRUE(peer.closed());
}

TEST(HttpServerStart, APortInUseIsRefusedWithItsKey) {
  net::IoThread io;
  const HttpServer first(io.context(), {}, {});
  HttpOptions same;
  same.port = first.port();
  try {
    const HttpServer second(io.context(), same, {});
    FAIL() << "two servers on one port";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("http.port " + std::to_string(same.port)), std::string::npos)
        << e.what();
  }
  io.end();
}

TEST(ReadinessPage, SaysTheStageAndThePercentWhileLoading) {
  http::Readiness readiness;
  readiness.loading("terrain", 0.456);
  EXPECT_EQ(http::readiness_page(readiness.state()).status, 503);
  EXPECT_EQ(http::readiness_page(readiness.state()).body, "loading: terrain, 45 %\n");
  readiness.ready();
  EXPECT_EQ(http::readiness_page(readiness.state()).status, 200);
  readiness.stopping();
  EXPECT_EQ(http::readiness_page(readiness.state()).status, 503);
  readiness.ready();  // a late word of a thread that has not heard
  EXPECT_EQ(http::readiness_page(readiness.state()).body, "stopping\n");
}

}  // namespace
}  // namespace obliq::test::server_test
