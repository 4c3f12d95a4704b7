#pragma once

// Boost.Asio of Debian 12 needs std::exchange and does not include it.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/thread_pool.hpp>

#include "serve/server.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>

// What the server and its connections are made of; for serve/ alone.

namespace lorica {

/// What all connections of a server share. All of it belongs to the server's thread, but for what the mutex guards.
struct ServerState {
  ServeLimits limits;
  std::string token;            // empty = none is needed
  std::set<std::string> hosts;  // that a request may name, with the port; empty = all
  bool secure = false;
  std::optional<boost::asio::ssl::context> tls;
  boost::asio::io_context io{1};
  std::filesystem::path sentFiles;                 // of clients; empty = nowhere
  std::string_view noSentFiles;                    // why; empty = they are kept
  std::optional<boost::asio::thread_pool> writer;  // of them: a disk may be slow
  const class Connection* receiver = nullptr;      // whose file is coming: memory is for one at a time

  // Of the server's thread.
  std::set<class Connection*> connections;
  int nextClient = 1;
  FrameEncoder encoder;
  ServedFrame shown;              // the newest frame
  std::uint64_t frameNumber = 0;  // 0 = there is none yet
  std::shared_ptr<const ServedCast> cast;
  std::uint64_t castNumber = 0, stateNumber = 0;
  std::shared_ptr<const std::string> state;
  bool stopping = false;

  std::mutex mutex;
  std::condition_variable wished;
  ServedFrame handedOver;   // guarded
  bool fresh = false;       // guarded: handedOver is newer than shown
  std::deque<Wish> wishes;  // guarded

  std::atomic<unsigned> layers{0};
  std::atomic<int> clients{0};

  /// Begins to answer who has come.
  void take(boost::asio::ip::tcp::socket socket);
  void count();
  /// Gives all clients what is new.
  void spread();
  /// A message to all clients. @param text  JSON
  void say(const std::shared_ptr<const std::string>& text);
  void sayGoodbye();
  void add(const Wish& wish);
};

}  // namespace lorica
