#include "client/tls.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <climits>
#include <utility>

namespace obliq::client {
namespace {

using Kind = Progress::Kind;

/// A record's header (RFC 8446 section 5.1): what OpenSSL reads before it finds that this is no TLS.
constexpr std::size_t kRecordHeaderBytes = 5;

/// OpenSSL's own socket BIO writes without MSG_NOSIGNAL: a server that leaves would end the whole program.
struct Wire {
  SocketHandle socket = kNoSocket;
  bool ended = false;
  int error = 0;
  std::vector<std::byte> first_bytes;
};

int wire_write(BIO* bio, const char* data, int size) {
  Wire& wire = *static_cast<Wire*>(BIO_get_data(bio));
  BIO_clear_retry_flags(bio);
  const Transfer sent =
      send_bytes(wire.socket, std::as_bytes(std::span(data, static_cast<std::size_t>(size))));
  if (sent.may_retry()) {
    BIO_set_retry_write(bio);
  } else if (sent.bytes < 0) {
    wire.error = sent.error;
  }
  return static_cast<int>(sent.bytes);
}

int wire_read(BIO* bio, char* data, int size) {
  Wire& wire = *static_cast<Wire*>(BIO_get_data(bio));
  BIO_clear_retry_flags(bio);
  const std::span room = std::as_writable_bytes(std::span(data, static_cast<std::size_t>(size)));
  const Transfer received = receive_bytes(wire.socket, room);
  if (received.may_retry()) {
    BIO_set_retry_read(bio);
  } else if (received.bytes < 0) {
    wire.error = received.error;
  } else if (received.bytes == 0) {
    wire.ended = true;
  } else if (wire.first_bytes.size() < kRecordHeaderBytes) {
    const auto bytes = room.first(static_cast<std::size_t>(received.bytes));
    wire.first_bytes.insert(wire.first_bytes.end(), bytes.begin(), bytes.end());
  }
  return static_cast<int>(received.bytes);
}

long wire_control(BIO* bio, int command, long, void*) {
  if (command == BIO_CTRL_FLUSH) return 1;
  if (command == BIO_CTRL_EOF) return static_cast<Wire*>(BIO_get_data(bio))->ended ? 1 : 0;
  return 0;
}

/// Made once, never freed: as long as the program.
const BIO_METHOD* wire_method() {
  static const BIO_METHOD* const method = [] {
    BIO_METHOD* made = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "obliq socket");
    BIO_meth_set_write(made, wire_write);
    BIO_meth_set_read(made, wire_read);
    BIO_meth_set_ctrl(made, wire_control);
    return made;
  }();
  return method;
}

std::string openssl_reason() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  return reason == nullptr ? "TLS failed" : reason;
}

struct FreeContext {
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
};
struct FreeTls {
  void operator()(SSL* tls) const { SSL_free(tls); }
};

}  // namespace

struct Tls::State {
  Wire wire;
  std::string host;
  std::unique_ptr<SSL_CTX, FreeContext> context;
  std::unique_ptr<SSL, FreeTls> tls;  ///< owns the BIO, which points to the wire
};

Tls::Tls(std::unique_ptr<State> state) : state_(std::move(state)) {}
Tls::~Tls() = default;

std::unique_ptr<Tls> Tls::make(SocketHandle socket, const std::string& host, const TlsOptions& options,
                               std::string& failure) {
  ERR_clear_error();
  auto state = std::make_unique<State>();
  state->wire.socket = socket;
  state->host = host;
  state->context.reset(SSL_CTX_new(TLS_client_method()));
  SSL_CTX* context = state->context.get();
  const auto fail = [&](const std::string& text) {
    failure = text;
    return nullptr;
  };
  if (context == nullptr) return fail(openssl_reason());
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  // A server that leaves without a farewell: messages have a length and a CRC of their own.
  SSL_CTX_set_options(context, SSL_OP_IGNORE_UNEXPECTED_EOF);
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
  if (options.ca_file.empty()) {
    SSL_CTX_set_default_verify_paths(context);
  } else if (SSL_CTX_load_verify_file(context, options.ca_file.c_str()) != 1) {
    return fail("--ca: " + options.ca_file + ": no certificate could be read (" + openssl_reason() + ")");
  }
  state->tls.reset(SSL_new(context));
  SSL* tls = state->tls.get();
  BIO* bio = BIO_new(wire_method());
  if (tls == nullptr || bio == nullptr) {
    BIO_free(bio);
    return fail(openssl_reason());
  }
  BIO_set_data(bio, &state->wire);
  BIO_set_init(bio, 1);
  SSL_set_bio(tls, bio, bio);
  const bool named = is_address(host) ? X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), host.c_str()) == 1
                                      : SSL_set1_host(tls, host.c_str()) == 1 &&
                                            SSL_set_tlsext_host_name(tls, host.c_str()) == 1;
  if (!named) return fail("the host \"" + host + "\" cannot be in a certificate");
  return std::unique_ptr<Tls>(new Tls(std::move(state)));
}

Progress Tls::progress(int result) {
  if (result > 0) return {Kind::moved, static_cast<std::size_t>(result)};
  const Wire& wire = state_->wire;
  switch (SSL_get_error(state_->tls.get(), result)) {
    case SSL_ERROR_WANT_READ:
      return {Kind::wants_read};
    case SSL_ERROR_WANT_WRITE:
      return {Kind::wants_write};
    case SSL_ERROR_ZERO_RETURN:
      return {Kind::ended};
    default:
      if (wire.error != 0) return {Kind::failed, 0, socket_error_text(wire.error)};
      if (wire.ended) return {Kind::ended};
      return {Kind::failed, 0, openssl_reason()};
  }
}

Progress Tls::shake_hands() {
  ERR_clear_error();
  Progress made = progress(SSL_connect(state_->tls.get()));
  if (made.kind != Kind::failed) return made;
  if (state_->wire.error != 0) return {Kind::ended};
  const long verified = SSL_get_verify_result(state_->tls.get());
  if (verified == X509_V_ERR_HOSTNAME_MISMATCH || verified == X509_V_ERR_IP_ADDRESS_MISMATCH) {
    made.reason = "the server's certificate is not for " + state_->host;
  } else if (verified != X509_V_OK) {
    made.reason = std::string("the server's certificate is not trusted: ") +
                  X509_verify_cert_error_string(verified) + " (--ca FILE names the authorities to trust)";
  } else if (ERR_GET_REASON(ERR_peek_last_error()) == SSL_R_WRONG_VERSION_NUMBER) {
    made.reason = "the server does not speak TLS there";
  } else {
    made.reason = "TLS handshake failed: " + made.reason;
  }
  return made;
}

Progress Tls::write(std::span<const std::byte> bytes) {
  ERR_clear_error();
  return progress(SSL_write(state_->tls.get(), bytes.data(),
                            static_cast<int>(std::min<std::size_t>(bytes.size(), INT_MAX))));
}

Progress Tls::read(std::span<std::byte> bytes) {
  ERR_clear_error();
  return progress(SSL_read(state_->tls.get(), bytes.data(),
                           static_cast<int>(std::min<std::size_t>(bytes.size(), INT_MAX))));
}

Progress Tls::peek() {
  ERR_clear_error();
  std::byte one{};
  return progress(SSL_peek(state_->tls.get(), &one, 1));
}

const std::vector<std::byte>& Tls::first_bytes() const { return state_->wire.first_bytes; }

}  // namespace obliq::client
