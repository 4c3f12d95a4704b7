#pragma once

#include <utility>  // Boost.Asio of Debian 12 needs std::exchange and does not include it.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/thread_pool.hpp>

#include "viewer/page/server.h"

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

// For viewer/page/ alone.

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

}  // namespace lorica
