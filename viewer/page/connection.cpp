#include "viewer/page/server_state.h"

#include <boost/beast/websocket/rfc6455.hpp>

#include "geometry/errors.h"
#include "viewer/page/link.h"
#include "viewer/page/page_files.h"

#include <fcntl.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>

namespace lorica {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using beast::error_code;

constexpr int kSendBuffer = 256 << 10;  // of the kernel [bytes]
constexpr std::string_view kTokenProtocol = "token.";
constexpr std::string_view kOpen = "/open/";  // and the ending of the file that is sent there
constexpr double kUnread = 2.0;               // for what still comes after a request that is refused [s]
constexpr char kTlsHandshake = 0x16;          // its first byte
constexpr const char* kNoToken = "The link's token is missing or another one.";
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'";

using Parser = http::request_parser<http::empty_body>;

/// An answer that is a sentence.
struct Sentence {
  http::status status;
  std::string text;
};

/// Whether the request comes from a page of this server or from no page.
bool ownOrigin(const Request& request, const ServerState& shared) {
  const std::string origin = stringOf(request[http::field::origin]);
  return origin.empty() || origin == (shared.secure ? "https://" : "http://") + stringOf(request[http::field::host]);
}

/// Whether the request has the token.
bool hasToken(const Request& request, const ServerState& shared) {
  if (shared.token.empty()) return true;
  const std::string bearer = stringOf(request[http::field::authorization]);
  constexpr std::string_view kBearer = "Bearer ";
  if (bearer.starts_with(kBearer)) return sameToken(bearer.substr(kBearer.size()), shared.token);
  for (const beast::string_view each : http::token_list(request[http::field::sec_websocket_protocol])) {
    const std::string word = stringOf(each);
    if (word.starts_with(kTokenProtocol)) return sameToken(word.substr(kTokenProtocol.size()), shared.token);
  }
  return false;
}

/// The same, which makes the client one of those who have a place.
bool allowed(const Request& request, ClientSocket& client) {
  client.known = client.known || hasToken(request, client.shared);
  return client.known;
}

/// Why a client may not watch; none = it may.
std::optional<Sentence> whyNotWatch(const Request& request, ClientSocket& client) {
  const ServerState& shared = client.shared;
  if (!beast::websocket::is_upgrade(request)) {
    return Sentence{http::status::upgrade_required, "A WebSocket is expected here."};
  }
  if (!ownOrigin(request, shared)) return Sentence{http::status::forbidden, "Only the server's own page may watch."};
  if (!allowed(request, client)) return Sentence{http::status::unauthorized, kNoToken};
  const http::token_list protocols(request[http::field::sec_websocket_protocol]);
  if (std::find(protocols.begin(), protocols.end(), kProtocol) == protocols.end()) {
    return Sentence{http::status::bad_request, "The subprotocol lorica.live.1 is expected."};
  }
  if (shared.clients >= shared.limits.clients) {
    return Sentence{http::status::service_unavailable, "As many as can be served are watching already."};
  }
  return std::nullopt;
}

/// Why a client may not send a file; none = it may.
std::optional<Sentence> whyNotReceive(const Parser& parser, const std::string& ending, ClientSocket& client) {
  using http::status;
  const ServerState& shared = client.shared;
  if (!ownOrigin(parser.get(), shared))
    return Sentence{status::forbidden, "Only the server's own page may open files."};
  if (!allowed(parser.get(), client)) return Sentence{status::unauthorized, kNoToken};
  if (!shared.noSentFiles.empty()) return Sentence{status::forbidden, std::string(shared.noSentFiles)};
  if (!mayBeSent(ending)) {
    return Sentence{status::unsupported_media_type,
                    fmt::format("files that the page opens end in {}", endingsThatMayBeSent())};
  }
  const auto length = parser.content_length();
  if (!length) return Sentence{status::length_required, "the file's length is missing"};
  if (*length == 0) return Sentence{status::bad_request, "the file is empty"};
  if (*length > kMaxSentFile) {
    return Sentence{
        status::payload_too_large,
        fmt::format("the file has more than {} MiB: open it on the machine that serves", kMaxSentFile >> 20)};
  }
  if (shared.receiving) {
    return Sentence{status::service_unavailable, "another file is just being sent: please try again"};
  }
  return std::nullopt;
}

/// A file comes, which is to be opened as if it were dropped on a window. It is written when all of it is there.
class Upload : public std::enable_shared_from_this<Upload> {
 public:
  /// @param done  gets the answer, unless the client is gone
  Upload(std::shared_ptr<ClientSocket> client, Parser&& header, std::string ending, std::function<void(Sentence)> done)
      : client_(std::move(client)), file_(std::move(header)), ending_(std::move(ending)), done_(std::move(done)) {
    client_->shared.receiving = true;
  }
  ~Upload() { client_->shared.receiving = false; }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  /// @param buffer  has what was read already; must outlive this
  void read(beast::flat_buffer& buffer) {
    const ServeLimits& limits = client_->shared.limits;
    const std::uint64_t length = *file_.content_length();
    file_.body_limit(length);
    client_->expireIn(limits.requestSeconds + static_cast<double>(length) / limits.fileBytesASecond);
    http::async_read(pipe_, buffer, file_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->keep();
    });
  }

 private:
  /// Writes it in another thread, for which the server's own waits before it ends.
  void keep() {
    client_->expireNever();
    asio::io_context& io = client_->shared.io;
    asio::post(*client_->shared.writer, [self = shared_from_this(), &io, work = asio::make_work_guard(io)]() mutable {
      Result<std::string> file = keepSentFile(self->client_->shared.sentFiles, self->ending_, self->file_.get().body());
      asio::post(io, [self = std::move(self), file = std::move(file)] { self->kept(file); });
    });
  }
  void kept(const Result<std::string>& file) {
    if (!file) return done_({http::status::insufficient_storage, file.error().message});
    ClientMessage open;
    open.kind = ClientMessage::Kind::kChange;
    open.change = {.id = ControlId::kOpen, .files = {*file}};
    client_->shared.add(open);
    done_({http::status::accepted, "The file is being opened."});
  }

  std::shared_ptr<ClientSocket> client_;
  Pipe pipe_{*client_};
  http::request_parser<http::string_body> file_;
  std::string ending_;
  std::function<void(Sentence)> done_;
};

/// The requests of a client and their answers.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  explicit Connection(std::shared_ptr<ClientSocket> client) : client_(std::move(client)), shared_(client_->shared) {}

  void start() {
    error_code ignored;
    tcp::socket& socket = client_->plain;
    ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);  // readers of files are processes of their own
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    if (!client_->secure) return readRequest();
    client_->expireIn(shared_.limits.requestSeconds);
    socket.async_wait(tcp::socket::wait_read, [self = shared_from_this()](error_code error) {
      if (!error) self->greet();
    });
  }

 private:
  /// Who comes without TLS reads where the same is with it: a browser does so whose user left https:// out.
  void greet() {
    client_->heard = true;
    char first = 0;
    error_code error;
    client_->plain.non_blocking(true, error);
    if (!error) client_->plain.receive(asio::buffer(&first, 1), tcp::socket::message_peek, error);
    if (error) return;
    if (first != kTlsHandshake) {
      client_->secure.reset();
      return readRequest();
    }
    client_->secure->async_handshake(asio::ssl::stream_base::server, [self = shared_from_this()](error_code failed) {
      if (!failed) self->readRequest();
    });
  }
  void readRequest() {
    request_.emplace();
    request_->header_limit(static_cast<std::uint32_t>(shared_.limits.headerBytes));
    request_->body_limit(std::numeric_limits<std::uint64_t>::max());  // a body is read only where one is wanted
    client_->expireIn(shared_.limits.requestSeconds);
    http::async_read_header(pipe_, buffer_, *request_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->answer();
    });
  }
  void answer();
  void answerFile(const std::string& path);
  void receive(const std::string& ending);
  void send(http::status status, std::string_view type, std::shared_ptr<const std::string> body, bool gzip = false);
  void say(const Sentence& sentence) {
    send(sentence.status, "text/plain; charset=utf-8", std::make_shared<const std::string>(sentence.text + "\n"));
  }
  /// Takes what still comes for a moment: who sends does not read the answer before, and loses it with the connection.
  void readTheRest() {
    buffer_.clear();
    pipe_.async_read_some(buffer_.prepare(buffer_.max_size()),
                          [self = shared_from_this()](error_code error, std::size_t) {
                            if (error) return self->client_->close();
                            self->readTheRest();
                          });
  }

  std::shared_ptr<ClientSocket> client_;
  ServerState& shared_;
  Pipe pipe_{*client_};
  beast::flat_buffer buffer_{16 << 10};
  std::optional<Parser> request_;
  std::optional<http::response<http::span_body<const char>>> response_;
  std::shared_ptr<const std::string> body_;  // of the response
  std::string location_;                     // of what was asked for, if it is elsewhere
  unsigned version_ = 11;                    // of HTTP
  bool head_ = false, keep_ = false, unread_ = false;
};

void Connection::answer() {
  client_->heard = true;
  const Request& request = request_->get();
  version_ = request.version();
  head_ = request.method() == http::verb::head;
  keep_ = request.keep_alive();
  unread_ = !request_->is_done();
  const std::string host = stringOf(request[http::field::host]);
  // A name that leads here by somebody else's DNS would let their page read what only this machine may.
  if (!shared_.hosts.empty() && !shared_.hosts.contains(host)) {
    return say({http::status::misdirected_request, "This server answers to 127.0.0.1 and localhost alone."});
  }
  const std::string target = stringOf(request.target());
  if (shared_.secure && !client_->secure) {
    // Not for ever: another time the same port may be one without TLS. The token stays, which only the browser knows.
    location_ = "https://" + host + (target.starts_with('/') ? target : "/");
    return say({http::status::temporary_redirect, "This page needs https: " + location_});
  }
  const std::string path = target.substr(0, target.find('?'));
  if (request.method() == http::verb::put && path.starts_with(kOpen)) return receive(path.substr(kOpen.size()));
  if (unread_) return client_->close();  // nothing else has a body
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return say({http::status::method_not_allowed, "GET and HEAD are all that is answered here."});
  }
  if (path != "/live") return answerFile(path);
  if (const std::optional<Sentence> refused = whyNotWatch(request, *client_)) return say(*refused);
  watch(client_, request);
}

void Connection::answerFile(const std::string& path) {
  if (const PageFile* file = pageFile(path)) {
    const bool gzip = file->bytes.size() > 2 && file->bytes[0] == 0x1f && file->bytes[1] == 0x8b;
    auto body = std::make_shared<const std::string>(file->bytes.begin(), file->bytes.end());
    return send(http::status::ok, file->type, std::move(body), gzip);
  }
  for (const std::string_view folder : {"/character/", "/mesh/"}) {
    if (!path.starts_with(folder)) continue;
    if (!allowed(request_->get(), *client_)) return say({http::status::unauthorized, kNoToken});
    std::size_t number = 0;
    const char* begin = path.data() + folder.size();
    const char* end = path.data() + path.size();
    const auto [stop, error] = std::from_chars(begin, end, number);
    std::shared_ptr<const std::string> body;
    if (error == std::errc() && folder == "/mesh/" && stop == end) body = shared_.encoder.mesh(number);
    if (error == std::errc() && folder == "/character/" && std::string_view(stop, end) == ".glb" && shared_.cast &&
        number < shared_.cast->characters.size()) {
      body = shared_.cast->characters[number];
    }
    if (body == nullptr) break;
    return send(http::status::ok, folder == "/mesh/" ? "application/octet-stream" : "model/gltf-binary", body);
  }
  say({http::status::not_found, "There is nothing of this name."});
}

void Connection::receive(const std::string& ending) {
  if (const std::optional<Sentence> refused = whyNotReceive(*request_, ending, *client_)) return say(*refused);
  unread_ = false;
  std::make_shared<Upload>(client_, std::move(*request_), ending,
                           [self = shared_from_this()](const Sentence& sentence) { self->say(sentence); })
      ->read(buffer_);
}

void Connection::send(http::status status, std::string_view type, std::shared_ptr<const std::string> body, bool gzip) {
  body_ = std::move(body);
  response_.emplace(status, version_);
  response_->set(http::field::content_type, beast::string_view(type.data(), type.size()));
  response_->set(http::field::cache_control, "no-store");
  response_->set("X-Content-Type-Options", "nosniff");
  response_->set("Referrer-Policy", "no-referrer");
  response_->set("Content-Security-Policy", kPolicy);
  response_->set("Cross-Origin-Resource-Policy", "same-origin");
  if (gzip) response_->set(http::field::content_encoding, "gzip");
  if (!location_.empty()) response_->set(http::field::location, location_);
  response_->keep_alive(keep_ && !unread_);
  response_->body() = beast::span<const char>(body_->data(), head_ ? 0 : body_->size());
  response_->content_length(body_->size());
  client_->expireIn(shared_.limits.writeSeconds + 1e-6 * static_cast<double>(body_->size()));  // a megabyte a second
  http::async_write(pipe_, *response_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->unread_) {
      error_code ignored;
      if (!self->client_->secure) self->client_->plain.shutdown(tcp::socket::shutdown_send, ignored);
      self->client_->expireIn(kUnread);
      return self->readTheRest();
    }
    if (self->response_->need_eof()) return self->client_->close();
    self->readRequest();
  });
}

}  // namespace

bool ServerState::take(tcp::socket socket) {
  const auto client = std::make_shared<ClientSocket>(*this, std::move(socket));
  int known = 0, strangers = 0, ofAddress = 0;
  ClientSocket *oldest = nullptr, *oldestOfAddress = nullptr;
  const auto count = [&](ClientSocket* each, int& all, ClientSocket*& first) {
    ++all;
    if (each == client.get()) return;
    const auto age = [](const ClientSocket* one) { return std::pair(one->heard, one->number); };
    if (first == nullptr || age(each) < age(first)) first = each;
  };
  for (ClientSocket* each : sockets) {
    if (!each->plain.is_open()) continue;
    if (each->known) {
      ++known;
      continue;
    }
    count(each, strangers, oldest);
    if (each->address == client->address) count(each, ofAddress, oldestOfAddress);
  }
  if (known >= limits.connections) return false;
  const bool many = ofAddress > limits.strangersOfAnAddress;
  const bool crowded = many || strangers > limits.strangers;
  if (crowded) (many ? oldestOfAddress : oldest)->close();
  std::make_shared<Connection>(client)->start();
  return !crowded;
}

}  // namespace lorica
