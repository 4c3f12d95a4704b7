#pragma once

#include <string>
#include <vector>

namespace lorica {

/// The IPv4 addresses of this machine on its networks, without the loopback.
[[nodiscard]] std::vector<std::string> networkAddresses();

/// 128 random bits in 22 characters that a link may have; empty if the system has none.
[[nodiscard]] std::string makeToken();

/// Whether two tokens are the same, in a time that depends on their lengths alone.
[[nodiscard]] bool sameToken(const std::string& a, const std::string& b);

/// A QR code for a terminal, two modules a character, dark on light whatever the terminal's colours.
[[nodiscard]] std::string qrCode(const std::string& text);

}  // namespace lorica
