#include "viewer/page/server_state.h"

#include <boost/beast/websocket.hpp>

#include "geometry/clock.h"
#include "geometry/errors.h"
#include "geometry/text.h"

#include <algorithm>

namespace lorica {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using beast::error_code;

constexpr int kInFlight = 2;                         // frames that a client has not acknowledged
constexpr std::size_t kMaxMessages = 1024;           // that wait for the session
constexpr std::size_t kMaxNotices = 8;               // that wait for a client
constexpr std::chrono::seconds kIdle(20);            // until a client that says nothing is asked whether it is there
constexpr double kSlowAck = 0.15, kQuickAck = 0.06;  // of a frame, where particles become fewer and more [s]
constexpr std::size_t kFewestParticles = 1'000;

}  // namespace

/// A client that watches, by a WebSocket.
class Watcher : public std::enable_shared_from_this<Watcher> {
 public:
  explicit Watcher(std::shared_ptr<ClientSocket> client)
      : client_(std::move(client)), shared_(client_->shared), socket_(Pipe(*client_)) {
    client_->watches = true;
    shared_.watchers.insert(this);
  }
  ~Watcher() {
    shared_.watchers.erase(this);
    if (pressed_) {
      ClientMessage gone;
      gone.kind = ClientMessage::Kind::kGone;
      gone.client = number_;
      shared_.add(gone);
    }
    shared_.count();
  }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  [[nodiscard]] bool live() const { return live_; }
  [[nodiscard]] unsigned layers() const { return layers_; }
  void accept(const Request& request);
  void notify(const std::shared_ptr<const std::string>& message) {
    if (notices_.size() < kMaxNotices) notices_.push_back(message);
    pump();
  }
  /// Writes what is to be written next, one message at a time.
  void pump();
  void sayGoodbye() {
    if (!live_) return client_->close();
    close({websocket::close_code::going_away, "the session is over"});
  }

 private:
  void readMessages();
  void take(const ClientMessage& message);
  void next();
  void end() {
    live_ = false;
    shared_.count();
  }
  void close(const websocket::close_reason& why) {
    end();
    client_->expireIn(shared_.limits.goodbyeSeconds);
    socket_.async_close(why, [self = shared_from_this()](error_code) {});
  }

  std::shared_ptr<ClientSocket> client_;
  ServerState& shared_;
  websocket::stream<Pipe> socket_;
  beast::flat_buffer buffer_{16 << 10};
  bool live_ = false, writing_ = false, pressed_ = false;
  int number_ = 0;
  unsigned layers_ = 0;
  double allowance_ = 0.0;    // messages
  double lastMessage_ = 0.0;  // when it came [s]
  std::array<std::uint64_t, kServedTexts> textsSent_{};
  std::uint64_t castSent_ = 0, frameSent_ = 0, frameDone_ = 0;
  std::uint32_t propsSent_ = 0;
  std::deque<std::pair<std::uint64_t, double>> inFlight_;  // frames, and when they were sent [s]
  std::deque<std::shared_ptr<const std::string>> notices_;
  ClientMemory memory_;
  std::string message_;
};

void watch(std::shared_ptr<ClientSocket> socket, const Request& request) {
  std::make_shared<Watcher>(std::move(socket))->accept(request);
}

void ServerState::count() {
  unsigned all = 0;
  int watching = 0;
  for (const Watcher* watcher : watchers) {
    if (!watcher->live()) continue;
    all |= watcher->layers();
    ++watching;
  }
  layers = all;
  clients = watching;
}

void ServerState::spread() {
  for (Watcher* watcher : watchers) watcher->pump();
}

void ServerState::say(const std::shared_ptr<const std::string>& text) {
  for (Watcher* watcher : watchers) {
    if (watcher->live()) watcher->notify(text);
  }
}

void ServerState::sayGoodbye() {
  for (Watcher* watcher : watchers) watcher->sayGoodbye();
  for (ClientSocket* socket : sockets) {
    if (!socket->watches) socket->close();
  }
}

void ServerState::add(const ClientMessage& message) {
  const std::lock_guard lock(mutex);
  const bool rare = message.kind == ClientMessage::Kind::kGone || !message.change.files.empty();
  if (messages.size() < kMaxMessages || rare) messages.push_back(message);
  arrived.notify_one();
}

void Watcher::accept(const Request& request) {
  socket_.read_message_max(kMaxMessageBytes);
  socket_.auto_fragment(false);
  const std::chrono::duration<double> goodbye(shared_.limits.goodbyeSeconds);  // Beast has one limit for both ends
  socket_.set_option(websocket::stream_base::timeout{
      std::chrono::duration_cast<websocket::stream_base::duration>(goodbye), kIdle, true});
  socket_.set_option(websocket::stream_base::decorator(
      [](websocket::response_type& response) { response.set(beast::http::field::sec_websocket_protocol, kProtocol); }));
  client_->expireNever();
  socket_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->live_ = true;
    self->number_ = self->shared_.nextClient++;
    self->lastMessage_ = now();
    self->allowance_ = self->shared_.limits.messagesASecond;
    self->shared_.count();
    self->pump();
    self->readMessages();
  });
}

void Watcher::readMessages() {
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error || !self->live_) return self->end();
    self->next();
  });
}

/// Takes the message that was read.
void Watcher::next() {
  const double most = shared_.limits.messagesASecond, time = now();
  allowance_ = std::min(most, allowance_ + most * (time - std::exchange(lastMessage_, time))) - 1.0;
  const auto bytes = buffer_.data();
  const Result<ClientMessage> message = socket_.got_text()
                                            ? readClientMessage({static_cast<const char*>(bytes.data()), bytes.size()})
                                            : badFormat("messages are text");
  buffer_.consume(buffer_.size());
  if (!message || allowance_ < 0.0) {
    const std::string why = message ? "too many messages" : message.error().message;
    return close({websocket::close_code::policy_error, std::string(firstBytes(why, 100))});
  }
  take(*message);
  readMessages();
}

void Watcher::take(const ClientMessage& message) {
  using Kind = ClientMessage::Kind;
  if (message.kind == Kind::kAck) {
    frameDone_ = std::max(frameDone_, std::min(message.frame, frameSent_));
    while (!inFlight_.empty() && inFlight_.front().first <= frameDone_) {
      const double age = now() - inFlight_.front().second;
      inFlight_.pop_front();
      if (age > kSlowAck) memory_.particles = std::max(memory_.particles / 2, kFewestParticles);
      if (age < kQuickAck) memory_.particles = std::min(memory_.particles + memory_.particles / 8, kMaxServedParticles);
    }
    return pump();
  }
  if (message.kind == Kind::kShow) {
    layers_ = message.layers;
    return shared_.count();
  }
  ClientMessage own = message;
  own.client = number_;
  if (message.kind == Kind::kChange && message.change.id == ControlId::kPress) pressed_ = true;
  shared_.add(own);
}

void Watcher::pump() {
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
  } else {
    for (std::size_t i = 0; i < kServedTexts && message_.empty(); ++i) {
      if (textsSent_[i] == shared_.textNumbers[i]) continue;
      textsSent_[i] = shared_.textNumbers[i];
      message_ = *shared_.texts[i];
    }
  }
  const bool frame = message_.empty();
  if (frame) {
    const bool fresh = shared_.cast && shared_.shown.run == shared_.cast->run && frameSent_ != shared_.frameNumber;
    if (!fresh || inFlight_.size() >= kInFlight) return;
    frameSent_ = shared_.frameNumber;
    inFlight_.emplace_back(frameSent_, now());
    shared_.encoder.compose(frameSent_, layers_, now(), memory_, message_);
  }
  writing_ = true;
  socket_.binary(frame);
  client_->expireIn(shared_.limits.writeSeconds);
  socket_.async_write(asio::buffer(message_), [self = shared_from_this()](error_code error, std::size_t) {
    self->writing_ = false;
    if (self->live_) self->client_->expireNever();
    if (error) return self->end();
    self->pump();
  });
}

}  // namespace lorica
