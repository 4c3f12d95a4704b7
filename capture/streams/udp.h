#pragma once

#include "geometry/descriptor.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// A host and a port, as written by a user: "39539", "0.0.0.0:39539", "[::1]:39540", "studio.local:39539".
struct NetworkAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
};

/// @param needsHost  whether a bare port is refused
/// @return the address, or an error with what was found and expected
[[nodiscard]] Result<NetworkAddress> parseNetworkAddress(const std::string& text, bool needsHost);
/// "127.0.0.1:39539", "[::1]:39539"
[[nodiscard]] std::string textOf(const NetworkAddress& address);

/// A TCP socket that listens on an address of this machine, for the caller to close.
/// @return its file descriptor, or why it cannot be had
[[nodiscard]] Result<int> listenTcp(const NetworkAddress& address);
/// The port of a socket, also if 0 was asked for; 0 if it has none.
[[nodiscard]] std::uint16_t portOf(int socket);

/// A UDP socket; closed by its destructor.
class UdpSocket {
 public:
  /// Receives what is sent to an address of this machine.
  /// @return the socket, or why it cannot be had: the port is taken, the host does not resolve
  [[nodiscard]] static Result<UdpSocket> listen(const NetworkAddress& address);
  /// Sends to an address.
  [[nodiscard]] static Result<UdpSocket> connect(const NetworkAddress& address);

  struct Packet {
    std::size_t size = 0;
    std::uint64_t sender = 0;  ///< a hash of its address and port
    std::uint16_t port = 0;    ///< of the sender
  };
  /// Waits for a packet. @param memory  gets its bytes; a longer packet is cut
  /// @return the packet; nothing if none came within the time
  [[nodiscard]] std::optional<Packet> receive(std::span<std::byte> memory, double seconds);

  /// @return whether the system took the packet; a receiver that is not there is no error
  bool send(std::span<const std::byte> packet);

  /// The port that a socket got, also if 0 was asked for.
  [[nodiscard]] std::uint16_t port() const { return portOf(socket_.get()); }

 private:
  explicit UdpSocket(int descriptor) : socket_(descriptor) {}

  Descriptor socket_;
};

}  // namespace lorica
