#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct ssl_st;
struct ssl_ctx_st;

namespace lorica::test {

/// A client of the server that knows nothing of Boost: sockets, and OpenSSL for TLS.
class TestClient {
 public:
  /// @param receives  the kernel keeps about so many bytes that were not read yet; 0 = as many as it likes
  explicit TestClient(int port, bool secure = false, int receives = 0);
  ~TestClient();
  TestClient(const TestClient&) = delete;
  TestClient& operator=(const TestClient&) = delete;

  void write(std::string_view bytes);
  /// Whatever comes until the server closes, or until it holds `until`.
  [[nodiscard]] std::string read(std::string_view until = "");
  /// One request and its answer, with head and body. @param header  lines, each with its \r\n
  [[nodiscard]] std::string get(const std::string& path, const std::string& header = "",
                                const std::string& method = "GET");
  /// Becomes a WebSocket. @return the status line
  std::string watch(const std::string& header = "Sec-WebSocket-Protocol: lorica.live.1\r\n");

  struct Message {
    int kind = 0;  ///< 1 text, 2 binary, 8 close; 0 = the connection has ended
    std::string bytes;

    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(bytes); }
    /// Of a frame.
    [[nodiscard]] std::uint64_t number() const;
  };
  [[nodiscard]] Message next();
  /// The next message of a type: "frame" or that of a JSON message; others are skipped.
  [[nodiscard]] Message next(std::string_view type);
  /// Reads so many bytes, and waits for them. @return whether they came
  [[nodiscard]] bool take(std::size_t bytes);
  /// The next message, if all of it was read; none is waited for.
  [[nodiscard]] std::optional<Message> taken();
  void send(const nlohmann::json& message) { sendFrame(0x81, message.dump()); }
  /// @param head  first byte of a WebSocket frame
  void sendFrame(unsigned char head, std::string_view bytes, bool masked = true);

  std::string host;

 private:
  /// Of the message that begins the buffer: bytes of its head and behind it, as far as that is known.
  [[nodiscard]] std::pair<std::size_t, std::size_t> sizes() const;

  int socket_ = -1;
  ssl_ctx_st* context_ = nullptr;
  ssl_st* secure_ = nullptr;
  std::string buffer_;
};

/// Waits until something is true, at most a minute. @return whether it is
[[nodiscard]] bool becomes(const std::function<bool()>& what);

/// A client that watches.
struct Watcher : TestClient {
  explicit Watcher(int port) : TestClient(port) { watch(); }
};

}  // namespace lorica::test
