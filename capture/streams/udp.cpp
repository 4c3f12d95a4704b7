#include "capture/streams/udp.h"

#include "geometry/errors.h"
#include "geometry/files.h"

#include <fmt/format.h>

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

namespace lorica {
namespace {

Error badAddress(const std::string& text, bool needsHost) {
  return invalidArgument("the address {}: expected {}, with a port from 1 to 65535", text.empty() ? "''" : text,
                         needsHost ? "HOST:PORT, such as 127.0.0.1:39539" : "PORT or HOST:PORT, such as 39539");
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Result<Addresses> resolve(const NetworkAddress& address, int type, bool passive) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = type;
  hints.ai_flags = passive ? AI_PASSIVE : 0;
  addrinfo* list = nullptr;
  const int failed = getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list);
  if (failed != 0) {
    return notFound("{}: {}", textOf(address), gai_strerror(failed));
  }
  return Addresses(list);
}

/// Opens a socket and applies `use` to it and each address until one succeeds.
template <typename Use>
Result<int> openFirst(const NetworkAddress& address, int type, bool passive, const char* purpose, Use&& use) {
  LORICA_TRY(const Addresses list, resolve(address, type, passive));
  int reason = EADDRNOTAVAIL;
  for (const addrinfo* one = list.get(); one != nullptr; one = one->ai_next) {
    Descriptor made(socket(one->ai_family, type | SOCK_CLOEXEC, 0));
    if (made.valid() && use(made.get(), one->ai_addr, one->ai_addrlen) == 0) return made.release();
    reason = errno;
  }
  return unreadable("{}: cannot {}: {}", textOf(address), purpose, std::strerror(reason));
}

std::uint16_t portOf(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
  if (address.ss_family != AF_INET) return 0;
  return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

}  // namespace

Result<NetworkAddress> parseNetworkAddress(const std::string& text, bool needsHost) {
  NetworkAddress address;
  std::string_view port = text;
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) {
    port = std::string_view(text).substr(colon + 1);
    address.host = text.substr(0, colon);
    if (address.host.starts_with('[') && address.host.ends_with(']')) {
      address.host = address.host.substr(1, address.host.size() - 2);
    } else if (address.host.find(':') != std::string::npos) {
      return badAddress(text, needsHost);
    }
  } else if (needsHost) {
    return badAddress(text, needsHost);
  }
  unsigned number = 0;
  const auto [end, wrong] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (wrong != std::errc() || end != port.data() + port.size() || number == 0 || number > 65535 ||
      address.host.empty()) {
    return badAddress(text, needsHost);
  }
  address.port = number;
  return address;
}

std::string textOf(const NetworkAddress& address) {
  const bool six = address.host.find(':') != std::string::npos;
  return six ? fmt::format("[{}]:{}", address.host, address.port) : fmt::format("{}:{}", address.host, address.port);
}

Result<int> listenTcp(const NetworkAddress& address) {
  return openFirst(address, SOCK_STREAM, true, "listen there", [](int descriptor, const sockaddr* at, socklen_t size) {
    constexpr int kWaiting = 4;  // programs that connect while another sends
    const int yes = 1;
    (void)setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    return bind(descriptor, at, size) != 0 ? -1 : listen(descriptor, kWaiting);
  });
}

std::uint16_t portOf(int socket) {
  sockaddr_storage own{};
  socklen_t length = sizeof own;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&own), &length) != 0) return 0;
  return portOf(own);
}

Result<UdpSocket> UdpSocket::listen(const NetworkAddress& address) {
  LORICA_TRY(const int descriptor, openFirst(address, SOCK_DGRAM, true, "listen there", ::bind));
  return UdpSocket(descriptor);
}

Result<UdpSocket> UdpSocket::connect(const NetworkAddress& address) {
  LORICA_TRY(const int descriptor, openFirst(address, SOCK_DGRAM, false, "send there", ::connect));
  return UdpSocket(descriptor);
}

std::optional<UdpSocket::Packet> UdpSocket::receive(std::span<std::byte> memory, double seconds) {
  pollfd ready{socket_.get(), POLLIN, 0};
  if (poll(&ready, 1, static_cast<int>(1e3 * seconds)) <= 0) return std::nullopt;
  sockaddr_storage from{};
  socklen_t length = sizeof from;
  const ssize_t size =
      recvfrom(socket_.get(), memory.data(), memory.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &length);
  if (size < 0) return std::nullopt;
  return Packet{static_cast<std::size_t>(size),
                contentHash(std::string_view(reinterpret_cast<const char*>(&from), length)), portOf(from)};
}

bool UdpSocket::send(std::span<const std::byte> packet) {
  return ::send(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 || errno == ECONNREFUSED;
}

}  // namespace lorica
