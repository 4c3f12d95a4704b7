#pragma once

#include <utility>  // Boost.Asio of Debian 12 needs std::exchange and does not include it.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include "viewer/page/server.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

// What the server, requests and watchers have in common; for viewer/page/ alone.

namespace lorica {

/// What all clients of a server share. All of it belongs to the server's thread, but for what the mutex guards.
struct ServerState : ServerFacts {
  ServeLimits limits;
  std::set<std::string> hosts;  // that a request may name, with the port; empty = all
  bool secure = false;
  std::optional<boost::asio::ssl::context> tls;
  boost::asio::io_context io{1};
  std::optional<boost::asio::thread_pool> writer;  // of sentFiles: a disk may be slow
  bool receiving = false;                          // a file is coming: memory is for one at a time

  // Of the server's thread.
  std::set<class ClientSocket*> sockets;
  std::set<class Watcher*> watchers;
  int nextClient = 1;
  std::uint64_t nextSocket = 0;
  FrameEncoder encoder;
  ServedFrame shown;              // the newest frame
  std::uint64_t frameNumber = 0;  // 0 = there is none yet
  std::shared_ptr<const ServedCast> cast;
  std::uint64_t castNumber = 0;
  std::array<std::shared_ptr<const std::string>, kServedTexts> texts;
  std::array<std::uint64_t, kServedTexts> textNumbers{};
  bool stopping = false;

  std::mutex mutex;
  std::condition_variable arrived;     // messages
  ServedFrame handedOver;              // guarded
  bool fresh = false;                  // guarded: handedOver is newer than shown
  std::deque<ClientMessage> messages;  // guarded

  std::atomic<unsigned> layers{0};
  std::atomic<int> clients{0};

  /// Begins to answer who has come. Who has not shown the token takes no place from those who have: of the strangers
  /// of an address, and of all, the oldest goes that has sent nothing, or else the oldest.
  /// @return whether there was a place for it
  bool take(boost::asio::ip::tcp::socket socket);
  void count();
  /// Gives all clients what is new.
  void spread();
  /// A message to all clients. @param text  JSON
  void say(const std::shared_ptr<const std::string>& text);
  void sayGoodbye();
  void add(const ClientMessage& message);
};

/// A client's socket, with TLS or without. It closes when what is waited for takes too long.
class ClientSocket : public std::enable_shared_from_this<ClientSocket> {
 public:
  using Plain = boost::asio::ip::tcp::socket;
  using Clock = std::chrono::steady_clock;

  ClientSocket(ServerState& server, Plain socket)
      : shared(server), plain(std::move(socket)), number(server.nextSocket++), timer_(plain.get_executor()) {
    boost::beast::error_code ignored;
    address = plain.remote_endpoint(ignored).address();
    shared.sockets.insert(this);
    if (shared.tls) secure.emplace(plain, *shared.tls);
  }
  ~ClientSocket() { shared.sockets.erase(this); }
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  void expireIn(double seconds) {
    timer_.expires_after(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
    timer_.async_wait([weak = weak_from_this(), mine = ++deadline_](boost::beast::error_code error) {
      const std::shared_ptr<ClientSocket> self = weak.lock();
      if (!error && self && self->deadline_ == mine) self->close();
    });
  }
  /// Also of one whose handler waits already.
  void expireNever() {
    ++deadline_;
    timer_.cancel();
  }
  void close() {
    boost::beast::error_code ignored;
    plain.shutdown(Plain::shutdown_both, ignored);
    plain.close(ignored);
  }

  ServerState& shared;
  Plain plain;
  std::optional<boost::asio::ssl::stream<Plain&>> secure;  // none = without TLS
  boost::asio::ip::address address;
  std::uint64_t number;  // in the order in which they came
  bool heard = false;    // it has sent something
  bool known = false;    // it has shown the token, or watches where none is needed
  bool watches = false;  // it is a Watcher's

 private:
  boost::asio::steady_timer timer_;
  std::uint64_t deadline_ = 0;  // the present one's number
};

/// A handle of a socket, of one type with TLS and without: everything above is compiled once.
class Pipe {
 public:
  using executor_type = ClientSocket::Plain::executor_type;

  explicit Pipe(ClientSocket& socket) : socket_(&socket) {}
  executor_type get_executor() { return socket_->plain.get_executor(); }
  void close() { socket_->close(); }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    use([&](auto& stream) { stream.async_read_some(buffers, std::forward<Handler>(handler)); });
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    use([&](auto& stream) { stream.async_write_some(buffers, std::forward<Handler>(handler)); });
  }

 private:
  void use(const auto& action) {
    if (socket_->secure) {
      action(*socket_->secure);
    } else {
      action(socket_->plain);
    }
  }
  ClientSocket* socket_;
};

template <typename Handler>
void async_teardown(boost::beast::role_type /*role*/, Pipe& pipe, Handler&& handler) {
  pipe.close();
  boost::asio::post(pipe.get_executor(),
                    boost::beast::bind_front_handler(std::forward<Handler>(handler), boost::beast::error_code()));
}
inline void beast_close_socket(Pipe& pipe) {
  pipe.close();
}

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

inline std::string stringOf(boost::beast::string_view view) {
  return {view.data(), view.size()};
}

/// The subprotocol that a client must ask for.
inline constexpr const char* kProtocol = "lorica.live.1";

/// Answers a request to upgrade that was checked: the client watches from now on.
void watch(std::shared_ptr<ClientSocket> socket, const Request& request);

}  // namespace lorica
