#include "tests/viewer/page/test_client.h"

#include "geometry/little_endian.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

namespace lorica::test {

TestClient::TestClient(int port, bool secure, int receives) : host("127.0.0.1:" + std::to_string(port)) {
  socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
  if (receives > 0) (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receives, sizeof receives);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  (void)::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  timeval patience{60, 0};
  (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (!secure) return;
  context_ = SSL_CTX_new(TLS_client_method());
  secure_ = SSL_new(context_);
  SSL_set_fd(secure_, socket_);
  (void)SSL_connect(secure_);
}

TestClient::~TestClient() {
  if (secure_ != nullptr) SSL_free(secure_);
  if (context_ != nullptr) SSL_CTX_free(context_);
  ::close(socket_);
}

void TestClient::write(std::string_view bytes) {
  if (secure_ != nullptr) {
    (void)SSL_write(secure_, bytes.data(), static_cast<int>(bytes.size()));
  } else {
    (void)!::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
}

std::string TestClient::read(std::string_view until) {
  std::string all = std::exchange(buffer_, "");
  std::array<char, 16384> part{};
  while (until.empty() || all.find(until) == std::string::npos) {
    const auto got =
        secure_ != nullptr ? SSL_read(secure_, part.data(), part.size()) : ::recv(socket_, part.data(), part.size(), 0);
    if (got <= 0) break;
    all.append(part.data(), static_cast<std::size_t>(got));
  }
  return all;
}

bool TestClient::take(std::size_t bytes) {
  std::array<char, 16384> part{};
  while (bytes > 0) {
    const std::size_t most = std::min(bytes, part.size());
    const auto got = secure_ != nullptr ? SSL_read(secure_, part.data(), static_cast<int>(most))
                                        : ::recv(socket_, part.data(), most, 0);
    if (got <= 0) return false;
    buffer_.append(part.data(), static_cast<std::size_t>(got));
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string TestClient::get(const std::string& path, const std::string& header, const std::string& method) {
  const std::string own = header.find("Host:") == std::string::npos ? "Host: " + host + "\r\n" : "";
  write(method + " " + path + " HTTP/1.1\r\n" + own + header + "Connection: close\r\n\r\n");
  return read();
}

std::string TestClient::watch(const std::string& header) {
  write("GET /live HTTP/1.1\r\nHost: " + host +
        "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
        header + "\r\n");
  std::string answer = read("\r\n\r\n");
  const std::size_t end = answer.find("\r\n\r\n");
  if (end != std::string::npos) buffer_ = answer.substr(end + 4);
  return answer.substr(0, answer.find("\r\n"));
}

std::uint64_t TestClient::Message::number() const {
  return loadLittleEndian<std::uint64_t>(bytes.data() + 16);
}

std::pair<std::size_t, std::size_t> TestClient::sizes() const {
  if (buffer_.size() < 2) return {2, 0};
  std::size_t length = static_cast<unsigned char>(buffer_[1]) & 127;
  const std::size_t head = length == 126 ? 4 : length == 127 ? 10 : 2;
  if (buffer_.size() < head || head == 2) return {head, length};
  length = 0;
  for (std::size_t i = 2; i < head; ++i) length = length << 8 | static_cast<unsigned char>(buffer_[i]);
  return {head, length};
}

std::optional<TestClient::Message> TestClient::taken() {
  const auto [head, length] = sizes();
  if (buffer_.size() < head + length) return std::nullopt;
  Message message{buffer_[0] & 15, buffer_.substr(head, length)};
  buffer_.erase(0, head + length);
  if (message.kind != 9) return message;
  sendFrame(0x8a, message.bytes);  // the server asks whether somebody is there
  return taken();
}

TestClient::Message TestClient::next() {
  for (;;) {
    if (std::optional<Message> message = taken()) return *std::move(message);
    const auto [head, length] = sizes();
    if (!take(head + length - buffer_.size())) return {};
  }
}

TestClient::Message TestClient::next(std::string_view type) {
  for (;;) {
    Message message = next();
    if (message.kind == 0 || message.kind == 8) return message;
    if (message.kind == 2 && type == "frame") return message;
    if (message.kind == 1 && message.json()["type"] == type) return message;
  }
}

void TestClient::sendFrame(unsigned char head, std::string_view bytes, bool masked) {
  std::string frame(1, static_cast<char>(head));
  const int mask = masked ? 0x80 : 0;
  if (bytes.size() < 126) {
    frame += static_cast<char>(mask | static_cast<int>(bytes.size()));
  } else {
    frame += static_cast<char>(mask | 126);
    frame += static_cast<char>(bytes.size() >> 8);
    frame += static_cast<char>(bytes.size() & 255);
  }
  if (masked) frame.append(4, '\0');  // a mask of zeros changes nothing
  frame += bytes;
  write(frame);
}

bool becomes(const std::function<bool()>& what) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!what()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace lorica::test
