// What clients send to `lorica serve`. The first byte chooses: a message, read alone; bytes of a connection; bytes
// after the handshake of a WebSocket, or messages in right WebSocket frames, each of which begins with its length in a
// byte; or a file to open, whose kind and whose claimed length are the first two. The server lives as long as the
// process; it must answer after each input, and have all of a file or nothing.
#include "skinning/skeleton.h"
#include "viewer/page/client_message.h"
#include "viewer/page/server.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using namespace lorica;

/// A connection to the server. Nothing is waited for longer than a minute.
class Client {
 public:
  explicit Client(int port) : port_(port), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    // A port that is not used up by the millionth connection: it is closed at once, without waiting.
    const linger now{1, 0};
    (void)::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    const timeval patience{60, 0};
    (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    LORICA_CHECK(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0,
                 "the server is gone");
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  void endWriting() const { ::shutdown(socket_, SHUT_WR); }
  /// No more is sent. Reads until the server has closed, too.
  void finish() const {
    endWriting();
    std::array<char, 16384> part{};
    for (;;) {
      const auto got = ::recv(socket_, part.data(), part.size(), 0);
      LORICA_CHECK(got >= 0 || errno != EAGAIN, "a connection that is over is not closed");
      if (got <= 0) return;
    }
  }
  [[nodiscard]] std::string read(std::string_view until) const {
    std::string all;
    std::array<char, 4096> part{};
    while (all.find(until) == std::string::npos) {
      const auto got = ::recv(socket_, part.data(), part.size(), 0);
      if (got <= 0) break;
      all.append(part.data(), static_cast<std::size_t>(got));
    }
    return all;
  }
  void upgrade() const {
    write(
        fmt::format("GET /live HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                    "Sec-WebSocket-Protocol: lorica.live.1\r\n\r\n",
                    port_));
    LORICA_CHECK(read("\r\n\r\n").starts_with("HTTP/1.1 101"), "a WebSocket is refused");
  }
  /// A text that the server gets whole; a mask of zeros changes nothing.
  void say(std::string_view text) const {
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0xfe);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 255);
    }
    write(frame.append(4, '\0').append(text));
  }

 private:
  int port_, socket_;
};

/// A folder that goes with the process.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("lorica-serve-fuzz-{}", ::getpid());
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

ServeSetting settingIn(const Folder& folder) {
  ServeSetting setting;
  setting.recordings = folder.path.string();
  return setting;
}

/// The server with a figure and some props, and what it does once in a session's frame.
struct Stage {
  Folder folder;
  std::unique_ptr<PageServer> server = PageServer::start(settingIn(folder)).value();
  Skeleton skeleton = Skeleton::create({Joint{}}).value();
  std::vector<Affine3> joints{static_cast<std::size_t>(skeleton.jointCount()), Affine3::Identity()};
  std::vector<Prop> props{3};
  std::vector<ClientMessage> messages;
  Scene scene;
  double time = 0.0;

  Stage() {
    const auto cast = std::make_shared<ServedCast>();
    cast->run = 1;
    cast->hello = R"({"type":"hello","run":1})";
    cast->characters.push_back(std::make_shared<const std::string>("glTF and more"));
    server->setCast(cast);
    scene.skeleton = &skeleton;
    scene.worldFromModel = joints;
    scene.worldFromJoint = joints;
  }
  void frame() {
    scene.time = time += 0.01;
    props[0].worldFromProp.translation().x() = time;
    scene.props = props;
    server->next().take(scene, server->layers());
    server->publish();
    messages.clear();
    server->takeMessages(messages);
    for (const ClientMessage& message : messages) {
      const Change& change = message.change;
      for (const std::string& file : change.files) {
        LORICA_CHECK(std::filesystem::path(file).parent_path() == server->facts().sentFiles, "a file elsewhere");
      }
      LORICA_CHECK(message.client > 0 || !change.files.empty(), "a message of nobody");
      LORICA_CHECK(change.ray.origin.allFinite() && change.velocity.allFinite(), "a change that cannot be");
      LORICA_CHECK(std::abs(message.aim.ray.direction.norm() - 1.0) < 1e-9, "a direction that is no unit vector");
    }
  }
  /// Removes them. @return how many there are, half written ones included
  [[nodiscard]] int files() const {
    int count = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(server->facts().sentFiles, none)) {
      ++count;
      LORICA_CHECK(std::filesystem::remove(entry.path()), "a file that cannot be removed");
    }
    return count;
  }
};

void checkAnswers(const Stage& stage) {
  const int port = stage.server->port();
  std::string answer;
  // A busy machine may take longer to hand over a request than the server waits for it.
  for (int attempt = 0; attempt < 5 && !answer.starts_with("HTTP/1.1 200"); ++attempt) {
    const Client client(port);
    client.write(fmt::format("GET /character/0.glb HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", port));
    answer = client.read("glTF and more");
  }
  LORICA_CHECK(answer.starts_with("HTTP/1.1 200"), "the server does not answer");
}

/// The seeds name the first port, which may be taken.
std::string ownPort(std::string bytes, int port) {
  constexpr std::string_view kSeed = "127.0.0.1:8420";
  const std::string own = fmt::format("127.0.0.1:{}", port);
  for (std::size_t at = 0; (at = bytes.find(kSeed, at)) != std::string::npos; at += own.size()) {
    bytes.replace(at, kSeed.size(), own);
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  const int mode = data[0] % 5;
  if (mode == 0) {
    if (const Result<ClientMessage> message = readClientMessage(bytes)) {
      const Change& change = message->change;
      LORICA_CHECK(change.ray.origin.allFinite() && std::isfinite(change.to.value_or(change.by)), "a change nowhere");
    }
    return 0;
  }
  static Stage stage;
  stage.frame();
  if (mode == 4) {
    if (bytes.size() < 2) return 0;
    constexpr std::array<const char*, 8> kKinds = {"bvh", "glb", "json", "lorica", "exe", "", "../bvh", "bvh/x"};
    const std::string_view body = bytes.substr(2);
    const std::size_t claimed = std::max(0, static_cast<int>(body.size()) + static_cast<signed char>(bytes[1]));
    std::string answer;
    {
      const Client client(stage.server->port());
      client.write(fmt::format(
          "PUT /open/{} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
          kKinds[static_cast<unsigned char>(bytes[0]) % kKinds.size()], stage.server->port(), claimed, body));
      client.endWriting();
      answer = client.read("\n\n");
    }
    LORICA_CHECK(answer.starts_with("HTTP/1.1 202") == (stage.files() > 0), "a file that is not as its answer says");
    stage.frame();
    checkAnswers(stage);
    return 0;
  }
  {
    const Client client(stage.server->port());
    if (mode > 1) client.upgrade();
    if (mode < 3) {
      client.write(ownPort(std::string(bytes), stage.server->port()));
    } else {
      for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t length = std::min<std::size_t>(static_cast<unsigned char>(bytes[at]), bytes.size() - at - 1);
        client.say(bytes.substr(at + 1, length));
        at += 1 + length;
      }
    }
    stage.frame();
    client.finish();
  }
  checkAnswers(stage);
  (void)stage.files();
  return 0;
}
