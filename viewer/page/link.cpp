#include "viewer/page/link.h"

#include "geometry/descriptor.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <qrcodegen.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

constexpr int kMargin = 2;  // light modules around a code
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

std::string dotted(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  return inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size()) != nullptr ? text.data() : "";
}

/// The address of this machine that the default route leaves from: what other machines reach, where those of virtual
/// bridges may be seen from here alone. Empty without a route. Nothing is sent: a datagram socket is only bound.
std::string routedAddress() {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in there{}, here{};
  there.sin_family = AF_INET;
  there.sin_port = htons(9);
  there.sin_addr.s_addr = htonl(0xC0000201);  // 192.0.2.1, which documentation may name and nobody has
  socklen_t size = sizeof here;
  if (::connect(socket.get(), reinterpret_cast<sockaddr*>(&there), sizeof there) != 0) return "";
  return ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&here), &size) == 0 ? dotted(here) : "";
}

}  // namespace

std::vector<std::string> networkAddresses() {
  std::vector<std::string> addresses;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return addresses;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    addresses.push_back(dotted(*reinterpret_cast<const sockaddr_in*>(one->ifa_addr)));
  }
  freeifaddrs(list);
  std::ranges::sort(addresses, {}, [first = routedAddress()](const std::string& address) {
    return std::pair(address != first, address);
  });
  return addresses;
}

std::string makeToken() {
  std::array<std::uint8_t, 22> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return "";
  std::string token;
  for (const std::uint8_t byte : bytes) token += kDigits[byte % kDigits.size()];
  return token;
}

bool sameToken(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different |= static_cast<unsigned char>(a[i] ^ b[i]);
  return different == 0;
}

std::string qrCode(const std::string& text) {
  using qrcodegen::QrCode;
  const QrCode code = QrCode::encodeText(text.c_str(), QrCode::Ecc::MEDIUM);
  const int size = code.getSize();
  std::string drawn;
  for (int y = -kMargin; y < size + kMargin; y += 2) {
    drawn += "\033[30;47m";
    for (int x = -kMargin; x < size + kMargin; ++x) {
      const bool upper = code.getModule(x, y), lower = code.getModule(x, y + 1);
      drawn += upper ? (lower ? "\u2588" : "\u2580") : (lower ? "\u2584" : " ");
    }
    drawn += "\033[0m\n";
  }
  return drawn;
}

}  // namespace lorica
