// Watches a session that `lorica serve` shows: prints for each of its seconds how many bones and props came. Needs
// Boost's headers and nothing of Lorica; what is read here is described in docs/WIRE.md.
//   lorica serve walk & watch_session [HOST:PORT] [FRAMES]

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

/// A little-endian number, as this machine's are. @throws where a message ends too early
template <typename Number>
Number read(const std::string& bytes, std::size_t at) {
  Number number;
  if (at > bytes.size() || bytes.size() - at < sizeof number) throw std::runtime_error("a frame ends too early");
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// What a second of the session brought.
struct Second {
  double begin = -1.0;
  int frames = 0;
  unsigned bones = 0, props = 0;
  std::size_t bytes = 0;
  void print() const {
    std::printf("%.2f s: %d frames, %u bones, %u props, %zu bytes\n", begin, frames, bones, props, bytes);
  }
};

void watch(const std::string& host, const std::string& port, int wanted) {
  asio::io_context io;
  websocket::stream<asio::ip::tcp::socket> socket(io);
  asio::connect(socket.next_layer(), asio::ip::tcp::resolver(io).resolve(host, port));
  socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
    request.set(beast::http::field::sec_websocket_protocol, "lorica.live.1");
  }));
  socket.handshake(host + ":" + port, "/live");
  Second second;
  while (wanted > 0) {
    beast::flat_buffer buffer;
    socket.read(buffer);
    const std::string message = beast::buffers_to_string(buffer.data());
    if (!socket.got_binary()) continue;  // JSON: the hello, the props and the state
    const auto time = read<double>(message, 24);
    if (second.frames > 0 && !(time >= second.begin && time < second.begin + 1.0)) {
      second.print();
      second = Second();
    }
    if (second.frames++ == 0) second.begin = time;
    second.bytes += message.size();
    std::size_t at = 32;
    for (int left = read<std::uint16_t>(message, 6); left > 0; --left) {
      const auto kind = read<std::uint16_t>(message, at);
      if (kind == 1) second.bones += read<std::uint16_t>(message, at + 10);  // an avatar's joints
      if (kind == 3) second.props += read<std::uint32_t>(message, at + 8);   // those that moved
      at += 8 + (std::size_t{read<std::uint32_t>(message, at + 4)} + 3) / 4 * 4;
    }
    // Without this the server sends two frames and then nothing.
    socket.write(asio::buffer(R"({"type":"ack","frame":)" + std::to_string(read<std::uint64_t>(message, 16)) + "}"));
    --wanted;
  }
  if (second.frames > 0) second.print();
  socket.close(websocket::close_code::normal);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string address = argc > 1 ? argv[1] : "127.0.0.1:8420";
  const std::size_t colon = address.rfind(':');
  try {
    if (colon == std::string::npos) throw std::runtime_error("expected HOST:PORT");
    watch(address.substr(0, colon), address.substr(colon + 1), argc > 2 ? std::stoi(argv[2]) : 300);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", address.c_str(), error.what());
    return 1;
  }
}
