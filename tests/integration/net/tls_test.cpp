// TLS: frames arrive as without it, nobody is let in or talked to who should not be, and a certificate can be
// exchanged while clients are connected.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <future>

#include "proto/obliq.pb.h"
#include "server/security/security.h"
#include "terrain/base/errors.h"
#include "tests/integration/daemon.h"
#include "tests/integration/net_fixture.h"
#include "tests/integration/test_certificate.h"

namespace obliq::test::tls_test {
namespace {

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

class TlsTest : public testing::Test {
 protected:
  net::ServerOptions options() const {
    net::ServerOptions made = small_options();
    made.handshake_timeout_s = 5;  // signatures take their time on a loaded machine
    made.security =
        std::make_shared<security::Security>(security::SecurityFiles{"", own.certificate, own.key});
    return made;
  }
  client::ClientOptions trusting(const std::filesystem::path& certificate) const {
    client::ClientOptions made;
    made.connect_timeout = kLong;
    made.tls = {true, certificate};
    return made;
  }
  std::string complaint(const std::filesystem::path& certificate, const std::filesystem::path& key) const {
    try {
      const security::Security security(security::SecurityFiles{"", certificate, key});
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  TestFolder folder;
  TestCertificate own = make_certificate(folder.path(), "own");
};

TEST_F(TlsTest, FramesArriveAsWithoutIt) {
  const TestServer server(options());
  client::Client client;
  ASSERT_TRUE(is_ok(client.connect(server.endpoint(), trusting(own.certificate))));
  client::FrameAssembler frames;
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(receive_frame(client, frames).ok());
    expect_pattern(frames.take());
  }
  ASSERT_TRUE(client.unsubscribe("main").ok());
  client::FrameAssembler once;
  client.set_handler(&once);
  wire::RenderOnce request = once_request();  // 5 MB, in many records
  request.mutable_settings()->set_azimuth_bins(500);
  request.mutable_settings()->set_range_bins(500);
  ASSERT_TRUE(client.render_once(request).ok());
  ASSERT_TRUE(receive_frame(client, once).ok());
  expect_pattern(once.take());
}

TEST_F(TlsTest, AWaitForNothingTimesOutAndLeavesTheConnectionUsable) {
  const TestServer server(options());
  client::Client client;
  ASSERT_TRUE(client.connect(server.endpoint(), trusting(own.certificate)).ok());
  // Session tickets of TLS 1.3 have arrived by now: they are no message.
  EXPECT_EQ(client.receive(client::Timeout(50)).outcome, Outcome::timed_out);
  wire::RadarList list;
  EXPECT_TRUE(client.list_radars(list).ok());
}

TEST_F(TlsTest, LastWordsArriveAndThenTheEnd) {
  TestServer server(options());
  client::Client client;
  ASSERT_TRUE(client.connect(server.endpoint(), trusting(own.certificate)).ok());
  std::thread stopping([&] { server.stop(); });
  const Status told = client.receive(kLong);
  EXPECT_EQ(told.number, number(ErrorNumber::server_stopping)) << told.sentence();
  EXPECT_EQ(client.receive(kLong).outcome, Outcome::closed);
  stopping.join();
}

TEST_F(TlsTest, ACertificateThatNobodyVouchesForIsRefused) {
  const TestServer server(options());
  const TestCertificate other = make_certificate(folder.path(), "other");
  for (const std::filesystem::path& trusted : {std::filesystem::path(), other.certificate}) {
    client::Client client;
    const Status status = client.connect(server.endpoint(), trusting(trusted));
    EXPECT_EQ(status.outcome, Outcome::untrusted) << status.sentence();
    EXPECT_NE(status.text.find("is not trusted: "), std::string::npos) << status.text;
    EXPECT_FALSE(client.is_open());
  }
}

TEST_F(TlsTest, ACertificateForAnotherHostIsRefused) {
  net::ServerOptions made = options();
  const TestCertificate other = make_certificate(folder.path(), "other", "DNS:radar.example,IP:192.0.2.1");
  made.security =
      std::make_shared<security::Security>(security::SecurityFiles{"", other.certificate, other.key});
  const TestServer server(made);
  client::Client client;
  const Status status = client.connect(server.endpoint(), trusting(other.certificate));
  EXPECT_EQ(status.outcome, Outcome::untrusted);
  EXPECT_NE(status.text.find("the server's certificate is not for 127.0.0.1"), std::string::npos)
      << status.text;
}

TEST_F(TlsTest, AnExpiredCertificateIsAWarningToTheServerAndRefusedByTheClient) {
  const TestCertificate old = make_certificate(folder.path(), "old", "IP:127.0.0.1", -20, -10);
  net::ServerOptions made = options();
  made.security = std::make_shared<security::Security>(security::SecurityFiles{"", old.certificate, old.key});
  ASSERT_EQ(made.security->warnings().size(), 1u);
  EXPECT_NE(made.security->warnings()[0].find("old.pem expired on "), std::string::npos);
  const TestServer server(made);
  client::Client client;
  const Status status = client.connect(server.endpoint(), trusting(old.certificate));
  EXPECT_EQ(status.outcome, Outcome::untrusted);
  EXPECT_NE(status.text.find("expired"), std::string::npos) << status.text;
}

TEST_F(TlsTest, APlainClientIsToldThatThePortSpeaksTls) {
  const TestServer server(options());
  client::Client client;
  const Status status = client.connect(server.endpoint());
  EXPECT_EQ(status.number, number(ErrorNumber::tls_required)) << status.sentence();
  EXPECT_NE(status.text.find("--tls"), std::string::npos);
  RawPeer web(server);
  web.send("GET / HTTP/1.0\r\n\r\n");
  EXPECT_EQ(web.error_number(), number(ErrorNumber::tls_required));
}

TEST_F(TlsTest, ATlsClientIsToldThatThePortDoesNotSpeakIt) {
  const TestServer server;
  client::Client client;
  const Status status = client.connect(server.endpoint(), trusting(own.certificate));
  EXPECT_EQ(status.number, number(ErrorNumber::bad_magic)) << status.sentence();
  EXPECT_NE(status.text.find("does not speak TLS"), std::string::npos) << status.text;
}

TEST_F(TlsTest, AClientTurnedAwayHearsWhyAlsoWhereItExpectsTls) {
  net::ServerOptions made = options();
  made.max_clients = 1;
  const TestServer server(made);
  client::Client first;
  ASSERT_TRUE(first.connect(server.endpoint(), trusting(own.certificate)).ok());
  client::Client second;
  const Status status = second.connect(server.endpoint(), trusting(own.certificate));
  EXPECT_EQ(status.number, number(ErrorNumber::too_many_clients)) << status.sentence();
}

TEST_F(TlsTest, PeersThatDoNotFinishTheHandshakeAreClosed) {
  net::ServerOptions made = options();
  made.handshake_timeout_s = 0.3;
  const TestServer server(made);
  RawPeer silent(server);
  RawPeer slow(server);
  RawPeer leaving(server);
  leaving.send(std::string_view("\x16\x03\x01", 3));
  leaving.socket().close();
  // A record of 512 bytes, a byte at a time, never completed.
  const std::string head("\x16\x03\x01\x02\x00\x01", 6);
  auto crawl = std::async(std::launch::async, [&] {
    for (std::size_t i = 0; i < 500; ++i) {
      const std::byte one{static_cast<unsigned char>(i < head.size() ? head[i] : '\0')};
      if (!slow.socket().send(std::span(&one, 1), kLong).ok()) return true;
      if (slow.socket().wait_readable(client::Timeout(20)).ok()) return true;  // its end
    }
    return false;
  });
  EXPECT_EQ(silent.error_number(), 0u) << "without TLS there is nothing to say it with";
  EXPECT_TRUE(crawl.get()) << "it could have gone on";
}

TEST_F(TlsTest, AForeignClientIsRefusedWithTls11AndAcceptedWith12And13) {
  const TestServer server(options());
  const auto try_version = [&](const std::string& flags) {
    const std::string command = "openssl s_client -connect " + server.endpoint().text() + " -CAfile " +
                                own.certificate.string() + " -verify_return_error -verify_ip 127.0.0.1 " +
                                flags + " </dev/null";
    return run_program("/bin/sh", {"-c", command}, folder.path());
  };
  const auto old = try_version("-tls1_1 -cipher DEFAULT@SECLEVEL=0");
  EXPECT_NE(old.code, 0);
  EXPECT_NE(old.err.find("alert protocol version"), std::string::npos) << old.err;
  for (const std::string version : {"1_2", "1_3"}) {
    const auto fine = try_version("-tls" + version);
    EXPECT_EQ(fine.code, 0) << fine.err;
    EXPECT_NE(fine.out.find("Verify return code: 0 (ok)"), std::string::npos) << fine.out;
    EXPECT_NE(fine.out.find(version == "1_2" ? "TLSv1.2" : "TLSv1.3"), std::string::npos) << fine.out;
  }
}

TEST_F(TlsTest, ACertificateIsExchangedWhileClientsAreConnected) {
  TestServer server(options());
  client::Client before;
  ASSERT_TRUE(before.connect(server.endpoint(), trusting(own.certificate)).ok());
  const std::filesystem::path first = folder / "first.pem";
  std::filesystem::copy_file(own.certificate, first);

  // Bad ones first: the old one stays.
  folder.write("own.pem", "nonsense");  // tokens are another matter: see Withdrawal
  EXPECT_NE(server.server().reload_security().certificate_fault, "");
  std::filesystem::copy_file(first, own.certificate, std::filesystem::copy_options::overwrite_existing);
  const TestCertificate next = make_certificate(folder.path(), "next");
  std::filesystem::copy_file(next.key, own.key, std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(server.server().reload_security().certificate_fault, "") << "the key is of the next certificate";
  client::Client meanwhile;
  EXPECT_TRUE(meanwhile.connect(server.endpoint(), trusting(first)).ok());

  std::filesystem::copy_file(next.certificate, own.certificate,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(server.server().reload_security().certificate_fault, "");
  client::Client after;
  EXPECT_TRUE(is_ok(after.connect(server.endpoint(), trusting(next.certificate))));
  client::Client late;
  EXPECT_EQ(late.connect(server.endpoint(), trusting(first)).outcome, Outcome::untrusted);
  wire::RadarList list;
  EXPECT_TRUE(before.list_radars(list).ok()) << "who was there is not disturbed";
  EXPECT_TRUE(meanwhile.list_radars(list).ok());
}

TEST_F(TlsTest, WhatIsWrongWithTheFilesIsSaidWithTheirNames) {
  const TestCertificate other = make_certificate(folder.path(), "other");
  const std::string rubbish = folder.write("rubbish", "no PEM\n");
  const auto says = [&](const std::string& found, const std::string& key, const std::string& file,
                        const std::string& why) {
    EXPECT_EQ(found.find(key + ": " + file + ": "), 0u) << found;
    EXPECT_NE(found.find(why), std::string::npos) << found;
  };
  EXPECT_EQ(complaint(own.certificate, own.key), "");
  says(complaint(folder / "none", own.key), "server.tls_certificate", folder / "none", "No such file");
  says(complaint(own.certificate, folder / "none"), "server.tls_key", folder / "none", "No such file");
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  says(complaint(pipe, own.key), "server.tls_certificate", pipe, "found a pipe; allowed: a regular file");
  says(complaint(own.certificate, pipe), "server.tls_key", pipe, "found a pipe; allowed: a regular file");
  says(complaint(rubbish, own.key), "server.tls_certificate", rubbish, "allowed: a PEM file");
  says(complaint(own.certificate, rubbish), "server.tls_key", rubbish, "allowed: a PEM file");
  says(complaint(own.certificate, other.key), "server.tls_key", other.key,
       "is not the key of the certificate in " + own.certificate.string());
  EXPECT_NE(complaint(own.certificate, "").find("server.tls_key: found nothing"), std::string::npos);
  EXPECT_NE(complaint("", own.key).find("server.tls_certificate: found nothing"), std::string::npos);
  const auto locked = run_program(
      "/usr/bin/openssl",
      {"pkey", "-in", own.key, "-aes128", "-passout", "pass:secret", "-out", folder / "locked.key"},
      folder.path());
  ASSERT_EQ(locked.code, 0) << locked.err;
  says(complaint(own.certificate, folder / "locked.key"), "server.tls_key", folder / "locked.key",
       "without passphrase");
}

}  // namespace
}  // namespace obliq::test::tls_test
