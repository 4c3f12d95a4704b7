#pragma once

#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include "viewer/page/server_state.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

// What requests and watchers have in common; for viewer/page/ alone.

namespace lorica {

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
