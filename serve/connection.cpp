#include "serve/connection.h"

#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "geometry/errors.h"
#include "serve/link.h"
#include "serve/page_files.h"
#include "serve/sent_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>

namespace lorica {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using Clock = std::chrono::steady_clock;

constexpr int kInFlight = 2;               // frames that a client has not acknowledged
constexpr std::size_t kMaxWishes = 1024;   // that wait for the session
constexpr std::size_t kMaxNotices = 8;     // that wait for a client
constexpr int kSendBuffer = 256 << 10;     // of the kernel [bytes]
constexpr std::chrono::seconds kIdle(20);  // until a client that says nothing is asked whether it is there
constexpr std::chrono::milliseconds kGoodbye(300);
constexpr double kSlowAck = 0.15, kQuickAck = 0.06;  // of a frame, where particles become fewer and more [s]
constexpr std::size_t kFewestParticles = 1'000;
constexpr const char* kProtocol = "lorica.live.1";
constexpr const char* kTokenProtocol = "token.";
constexpr std::string_view kOpen = "/open/";  // and the ending of the file that is sent there
constexpr std::chrono::seconds kUnread(2);    // for what still comes after a request that is refused
constexpr char kTlsHandshake = 0x16;          // its first byte
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'";

double secondsOf(Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

std::string text(beast::string_view view) {
  return {view.data(), view.size()};
}

/// The words of a header's list: "a, b".
std::vector<std::string> wordsOf(beast::string_view list) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : list) {
    if (c == ',') {
      words.push_back(std::exchange(word, ""));
    } else if (c != ' ' && c != '\t') {
      word += c;
    }
  }
  words.push_back(word);
  return words;
}

/// A socket with or without TLS, as one type: everything above is compiled once. A handle; the sockets are elsewhere.
class Pipe {
 public:
  using executor_type = tcp::socket::executor_type;
  using Secure = asio::ssl::stream<tcp::socket&>;

  Pipe(tcp::socket& plain, Secure* secure) : plain_(&plain), secure_(secure) {}
  executor_type get_executor() { return plain_->get_executor(); }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (secure_ != nullptr) {
      secure_->async_read_some(buffers, std::forward<Handler>(handler));
    } else {
      plain_->async_read_some(buffers, std::forward<Handler>(handler));
    }
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (secure_ != nullptr) {
      secure_->async_write_some(buffers, std::forward<Handler>(handler));
    } else {
      plain_->async_write_some(buffers, std::forward<Handler>(handler));
    }
  }
  void close() {
    error_code ignored;
    plain_->shutdown(tcp::socket::shutdown_both, ignored);
    plain_->close(ignored);
  }

 private:
  tcp::socket* plain_;
  Secure* secure_;
};

template <typename Handler>
void async_teardown(beast::role_type /*role*/, Pipe& pipe, Handler&& handler) {
  pipe.close();
  asio::post(pipe.get_executor(), beast::bind_front_handler(std::forward<Handler>(handler), error_code()));
}

void beast_close_socket(Pipe& pipe) {
  pipe.close();
}

}  // namespace

/// One connection: requests, then perhaps a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(ServerState& shared, tcp::socket socket)
      : shared_(shared), socket_(std::move(socket)), timer_(socket_.get_executor()) {
    shared_.connections.insert(this);
    if (shared.tls) secure_.emplace(socket_, *shared.tls);
  }
  ~Connection() {
    shared_.connections.erase(this);
    if (shared_.receiver == this) shared_.receiver = nullptr;
    if (pressed_) {
      Wish gone;
      gone.kind = Wish::Kind::kGone;
      gone.client = client_;
      shared_.add(gone);
    }
    shared_.count();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start() {
    error_code ignored;
    ::fcntl(socket_.native_handle(), F_SETFD, FD_CLOEXEC);  // readers of files are processes of their own
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    if (!secure_) return readRequest();
    expireIn(shared_.limits.requestSeconds);
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](error_code error) {
      if (!error) self->greet();
    });
  }

  [[nodiscard]] bool watches() const { return live_; }
  [[nodiscard]] unsigned layers() const { return live_ ? layers_ : 0; }
  void notify(const std::shared_ptr<const std::string>& message) {
    if (notices_.size() < kMaxNotices) notices_.push_back(message);
    pump();
  }
  /// Writes what is to be written next, one message at a time.
  void pump();
  void sayGoodbye() {
    if (!live_) return pipe().close();
    live_ = false;
    expireIn(secondsOf(kGoodbye));
    socketOfWeb_->async_close(websocket::close_reason(websocket::close_code::going_away, "the session is over"),
                              [self = shared_from_this()](error_code) {});
  }

 private:
  using Answer = http::response<http::string_body>;

  Pipe pipe() { return {socket_, secure_ ? &*secure_ : nullptr}; }
  void expireIn(double seconds) {
    timer_.expires_after(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
    timer_.async_wait([weak = weak_from_this(), mine = ++deadline_](error_code error) {
      const std::shared_ptr<Connection> self = weak.lock();
      if (!error && self && self->deadline_ == mine) self->pipe().close();
    });
  }
  /// Also of one whose handler waits already.
  void expireNever() {
    ++deadline_;
    timer_.cancel();
  }

  /// Who comes without TLS reads where the same is with it: a browser does so whose user left https:// out.
  void greet() {
    char first = 0;
    error_code error;
    socket_.non_blocking(true, error);
    if (!error) socket_.receive(asio::buffer(&first, 1), tcp::socket::message_peek, error);
    if (error) return;
    if (first != kTlsHandshake) {
      secure_.reset();
      return readRequest();
    }
    secure_->async_handshake(Pipe::Secure::server, [self = shared_from_this()](error_code failed) {
      if (!failed) self->readRequest();
    });
  }
  void readRequest() {
    request_.emplace();
    request_->header_limit(static_cast<std::uint32_t>(shared_.limits.headerBytes));
    request_->body_limit(std::numeric_limits<std::uint64_t>::max());  // a body is read only where one is wanted
    expireIn(shared_.limits.requestSeconds);
    stream_.emplace(pipe());
    http::async_read_header(*stream_, buffer_, *request_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->answer();
    });
  }
  void answer();
  void receive(const std::string& path);
  void keep(std::string ending);
  void kept(const Result<std::string>& file);
  [[nodiscard]] bool ownOrigin() const;
  [[nodiscard]] bool allowed() const;
  void send(http::status status, std::string_view type, std::shared_ptr<const std::string> body, bool gzip = false);
  void sendToHttps(const std::string& place);
  void refuse(http::status status, const std::string& sentence) {
    send(status, "text/plain; charset=utf-8", std::make_shared<const std::string>(sentence + "\n"));
  }
  /// Takes what still comes for a moment: who sends does not read the answer before, and loses it with the connection.
  void readTheRest() {
    buffer_.clear();
    stream_->async_read_some(buffer_.prepare(buffer_.max_size()),
                             [self = shared_from_this()](error_code error, std::size_t) {
                               if (error) return self->pipe().close();
                               self->readTheRest();
                             });
  }
  void upgrade();
  void readWishes();
  void hear(const Wish& wish);

  ServerState& shared_;
  tcp::socket socket_;
  std::optional<Pipe::Secure> secure_;
  asio::steady_timer timer_;
  std::uint64_t deadline_ = 0;  // the present one's number
  std::optional<Pipe> stream_;
  beast::flat_buffer buffer_{16 << 10};
  std::optional<http::request_parser<http::empty_body>> request_;
  std::optional<http::request_parser<http::string_body>> file_;  // that is sent
  std::optional<http::response<http::span_body<const char>>> response_;
  std::shared_ptr<const std::string> body_;  // of the response
  std::string location_;                     // of what was asked for, if it is elsewhere
  unsigned version_ = 11;                    // of HTTP
  bool head_ = false, keep_ = false, unread_ = false;

  // As a client.
  std::optional<websocket::stream<Pipe>> socketOfWeb_;
  bool live_ = false, writing_ = false, pressed_ = false;
  int client_ = 0;
  unsigned layers_ = 0;
  double allowance_ = 0.0;  // wishes
  Clock::time_point heard_;
  std::uint64_t castSent_ = 0, stateSent_ = 0, frameSent_ = 0, frameDone_ = 0;
  std::uint32_t propsSent_ = 0;
  std::deque<std::pair<std::uint64_t, Clock::time_point>> inFlight_;
  std::deque<std::shared_ptr<const std::string>> notices_;
  ClientMemory memory_;
  std::string message_;
};

void ServerState::count() {
  unsigned all = 0;
  int watching = 0;
  for (const Connection* connection : connections) {
    all |= connection->layers();
    if (connection->watches()) ++watching;
  }
  layers = all;
  clients = watching;
}

void ServerState::spread() {
  for (Connection* connection : connections) {
    if (connection->watches()) connection->pump();
  }
}

void ServerState::take(tcp::socket socket) {
  if (connections.size() >= static_cast<std::size_t>(limits.connections)) return;
  std::make_shared<Connection>(*this, std::move(socket))->start();
}

void ServerState::say(const std::shared_ptr<const std::string>& text) {
  for (Connection* connection : connections) {
    if (connection->watches()) connection->notify(text);
  }
}

void ServerState::sayGoodbye() {
  const std::set<Connection*> all = connections;
  for (Connection* connection : all) connection->sayGoodbye();
}

void ServerState::add(const Wish& wish) {
  const std::lock_guard lock(mutex);
  const bool rare = wish.kind == Wish::Kind::kGone || wish.kind == Wish::Kind::kOpen;
  if (wishes.size() < kMaxWishes || rare) wishes.push_back(wish);
  wished.notify_one();
}

/// Whether the request comes from a page of this server or from no page.
bool Connection::ownOrigin() const {
  const auto& request = request_->get();
  const std::string origin = text(request[http::field::origin]);
  return origin.empty() || origin == (shared_.secure ? "https://" : "http://") + text(request[http::field::host]);
}

/// Whether the request has the token.
bool Connection::allowed() const {
  const auto& request = request_->get();
  if (shared_.token.empty()) return true;
  const std::string bearer = text(request[http::field::authorization]);
  constexpr std::string_view kBearer = "Bearer ";
  if (bearer.starts_with(kBearer)) return sameToken(bearer.substr(kBearer.size()), shared_.token);
  for (const std::string& word : wordsOf(request[http::field::sec_websocket_protocol])) {
    if (word.starts_with(kTokenProtocol)) {
      return sameToken(word.substr(std::string_view(kTokenProtocol).size()), shared_.token);
    }
  }
  return false;
}

void Connection::answer() {
  const auto& request = request_->get();
  version_ = request.version();
  head_ = request.method() == http::verb::head;
  keep_ = request.keep_alive();
  unread_ = !request_->is_done();
  const std::string host = text(request[http::field::host]);
  // A name that leads here by somebody else's DNS would let their page read what only this machine may.
  if (!shared_.hosts.empty() && !shared_.hosts.contains(host)) {
    return refuse(http::status::misdirected_request, "This server answers to 127.0.0.1 and localhost alone.");
  }
  const std::string target = text(request.target());
  if (shared_.secure && !secure_) return sendToHttps(host + (target.starts_with('/') ? target : "/"));
  const std::string path = target.substr(0, target.find('?'));
  if (request.method() == http::verb::put && path.starts_with(kOpen)) return receive(path);
  if (unread_) return pipe().close();  // nothing else has a body
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return refuse(http::status::method_not_allowed, "GET and HEAD are all that is answered here.");
  }
  if (path == "/live") return upgrade();
  if (const PageFile* file = pageFile(path)) {
    const bool gzip = file->bytes.size() > 2 && file->bytes[0] == 0x1f && file->bytes[1] == 0x8b;
    auto body = std::make_shared<const std::string>(file->bytes.begin(), file->bytes.end());
    return send(http::status::ok, file->type, std::move(body), gzip);
  }
  for (const std::string_view folder : {"/character/", "/mesh/"}) {
    if (!path.starts_with(folder)) continue;
    if (!allowed()) return refuse(http::status::unauthorized, "The link's token is missing or another one.");
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
  refuse(http::status::not_found, "There is nothing of this name.");
}

/// Not for ever: another time the same port may be one without TLS. The token stays, which only the browser knows.
void Connection::sendToHttps(const std::string& place) {
  location_ = "https://" + place;
  refuse(http::status::temporary_redirect, "This page needs https: " + location_);
}

/// A file comes, which is to be opened as if it were dropped on a window. It is written when all of it is there.
void Connection::receive(const std::string& path) {
  if (!ownOrigin()) return refuse(http::status::forbidden, "Only the server's own page may open files.");
  if (!allowed()) return refuse(http::status::unauthorized, "The link's token is missing or another one.");
  if (!shared_.noSentFiles.empty()) return refuse(http::status::forbidden, std::string(shared_.noSentFiles));
  const std::string ending = path.substr(kOpen.size());
  if (!mayBeSent(ending)) {
    return refuse(http::status::unsupported_media_type,
                  fmt::format("files that the page opens end in {}", endingsThatMayBeSent()));
  }
  const auto length = request_->content_length();
  if (!length) return refuse(http::status::length_required, "the file's length is missing");
  if (*length == 0) return refuse(http::status::bad_request, "the file is empty");
  if (*length > kMaxSentFile) {
    return refuse(http::status::payload_too_large,
                  fmt::format("the file has more than {} MiB: open it on the machine that serves", kMaxSentFile >> 20));
  }
  if (shared_.receiver != nullptr) {
    return refuse(http::status::service_unavailable, "another file is just being sent: please try again");
  }
  shared_.receiver = this;
  unread_ = false;
  file_.emplace(std::move(*request_));
  file_->body_limit(*length);
  expireIn(shared_.limits.requestSeconds + static_cast<double>(*length) / shared_.limits.fileBytesASecond);
  http::async_read(*stream_, buffer_, *file_, [self = shared_from_this(), ending](error_code error, std::size_t) {
    if (!error) self->keep(ending);
  });
}

/// Writes it in another thread, for which the server's own waits before it ends.
void Connection::keep(std::string ending) {
  expireNever();
  asio::post(*shared_.writer, [self = shared_from_this(), ending = std::move(ending),
                               work = asio::make_work_guard(shared_.io)]() mutable {
    Result<std::string> file = keepSentFile(self->shared_.sentFiles, ending, self->file_->get().body());
    asio::io_context& io = self->shared_.io;
    asio::post(io, [self = std::move(self), file = std::move(file)] { self->kept(file); });
  });
}

void Connection::kept(const Result<std::string>& file) {
  shared_.receiver = nullptr;
  file_.reset();
  if (!file) return refuse(http::status::insufficient_storage, file.error().message);
  Wish open;
  open.kind = Wish::Kind::kOpen;
  open.file = *file;
  shared_.add(open);
  refuse(http::status::accepted, "The file is being opened.");
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
  expireIn(shared_.limits.writeSeconds + 1e-6 * static_cast<double>(body_->size()));  // a megabyte a second
  http::async_write(*stream_, *response_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    if (self->unread_) {
      error_code ignored;
      if (!self->secure_) self->socket_.shutdown(tcp::socket::shutdown_send, ignored);
      self->expireIn(secondsOf(kUnread));
      return self->readTheRest();
    }
    if (self->response_->need_eof()) return self->pipe().close();
    self->readRequest();
  });
}

void Connection::upgrade() {
  const auto& request = request_->get();
  if (!websocket::is_upgrade(request)) return refuse(http::status::upgrade_required, "A WebSocket is expected here.");
  if (!ownOrigin()) return refuse(http::status::forbidden, "Only the server's own page may watch.");
  if (!allowed()) return refuse(http::status::unauthorized, "The link's token is missing or another one.");
  const std::vector<std::string> words = wordsOf(request[http::field::sec_websocket_protocol]);
  if (std::find(words.begin(), words.end(), kProtocol) == words.end()) {
    return refuse(http::status::bad_request, "The subprotocol lorica.live.1 is expected.");
  }
  if (shared_.clients >= shared_.limits.clients) {
    return refuse(http::status::service_unavailable, "As many as can be served are watching already.");
  }
  socketOfWeb_.emplace(pipe());
  socketOfWeb_->read_message_max(kMaxWishBytes);
  socketOfWeb_->auto_fragment(false);
  websocket::stream_base::timeout timeouts{std::chrono::seconds(5), kIdle, true};
  socketOfWeb_->set_option(timeouts);
  socketOfWeb_->set_option(websocket::stream_base::decorator(
      [](websocket::response_type& response) { response.set(http::field::sec_websocket_protocol, kProtocol); }));
  expireNever();
  socketOfWeb_->async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->live_ = true;
    self->client_ = self->shared_.nextClient++;
    self->heard_ = Clock::now();
    self->allowance_ = self->shared_.limits.wishesASecond;
    self->buffer_.consume(self->buffer_.size());
    self->shared_.count();
    self->pump();
    self->readWishes();
  });
}

void Connection::readWishes() {
  socketOfWeb_->async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error || !self->live_) {
      self->live_ = false;
      self->shared_.count();
      return;
    }
    const Clock::time_point now = Clock::now();
    const double most = self->shared_.limits.wishesASecond;
    self->allowance_ = std::min(most, self->allowance_ + most * secondsOf(now - self->heard_)) - 1.0;
    self->heard_ = now;
    const auto bytes = self->buffer_.data();
    const Result<Wish> wish = self->socketOfWeb_->got_text()
                                  ? readWish({static_cast<const char*>(bytes.data()), bytes.size()})
                                  : badFormat("messages are text");
    self->buffer_.consume(self->buffer_.size());
    if (!wish || self->allowance_ < 0.0) {
      const std::string why = wish ? "too many messages" : wish.error().message;
      self->live_ = false;
      self->shared_.count();
      self->expireIn(secondsOf(kGoodbye));
      self->socketOfWeb_->async_close(websocket::close_reason(websocket::close_code::policy_error, why.substr(0, 100)),
                                      [self](error_code) {});
      return;
    }
    self->hear(*wish);
    self->readWishes();
  });
}

void Connection::hear(const Wish& wish) {
  if (wish.kind == Wish::Kind::kAck) {
    frameDone_ = std::max(frameDone_, std::min(wish.frame, frameSent_));
    while (!inFlight_.empty() && inFlight_.front().first <= frameDone_) {
      const double age = secondsOf(Clock::now() - inFlight_.front().second);
      inFlight_.pop_front();
      if (age > kSlowAck) memory_.particles = std::max(memory_.particles / 2, kFewestParticles);
      if (age < kQuickAck) memory_.particles = std::min(memory_.particles + memory_.particles / 8, kMaxServedParticles);
    }
    return pump();
  }
  if (wish.kind == Wish::Kind::kShow) {
    layers_ = wish.layers;
    return shared_.count();
  }
  Wish own = wish;
  own.client = client_;
  if (wish.kind == Wish::Kind::kPress) pressed_ = true;
  shared_.add(own);
}

void Connection::pump() {
  if (!live_ || writing_) return;
  message_.clear();
  if (shared_.cast && castSent_ != shared_.castNumber) {
    castSent_ = shared_.castNumber;
    propsSent_ = 0;
    message_ = shared_.cast->hello;
  } else if (shared_.cast && shared_.shown.run == shared_.cast->run && propsSent_ != shared_.encoder.propsVersion()) {
    propsSent_ = shared_.encoder.propsVersion();
    message_ = shared_.encoder.propsText();
  } else if (!notices_.empty()) {
    message_ = *notices_.front();
    notices_.pop_front();
  } else if (shared_.state && stateSent_ != shared_.stateNumber) {
    stateSent_ = shared_.stateNumber;
    message_ = *shared_.state;
  }
  const bool frame = message_.empty();
  if (frame) {
    const bool fresh = shared_.cast && shared_.shown.run == shared_.cast->run && frameSent_ != shared_.frameNumber;
    if (!fresh || inFlight_.size() >= kInFlight) return;
    frameSent_ = shared_.frameNumber;
    inFlight_.emplace_back(frameSent_, Clock::now());
    shared_.encoder.compose(frameSent_, layers_, secondsOf(Clock::now().time_since_epoch()), memory_, message_);
  }
  writing_ = true;
  socketOfWeb_->binary(frame);
  expireIn(shared_.limits.writeSeconds);
  socketOfWeb_->async_write(asio::buffer(message_), [self = shared_from_this()](error_code error, std::size_t) {
    self->writing_ = false;
    if (self->live_) self->expireNever();
    if (error) self->live_ = false;
    if (error) return self->shared_.count();
    self->pump();
  });
}

}  // namespace lorica
