#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/result.h"

namespace lorica {

/// The IPv4 addresses of this machine on its networks, without the loopback.
[[nodiscard]] std::vector<std::string> networkAddresses();

/// 128 random bits in 22 characters that a link may have; empty if the system has none.
[[nodiscard]] std::string makeToken();

/// Whether two tokens are the same, in a time that depends on their lengths alone.
[[nodiscard]] bool sameToken(const std::string& a, const std::string& b);

/// A QR code for a terminal, two modules a character, dark on light whatever the terminal's colours.
[[nodiscard]] std::string qrCode(const std::string& text);

/// A certificate and its private key, as PEM.
struct Certificate {
  std::string chain;
  std::string key;
  bool renewed = false;  ///< a good one that was kept is not for this machine's addresses
};

/// A self-signed certificate of a P-256 key, for 397 days from now.
/// @param hosts  names and IPv4 addresses that it is for
[[nodiscard]] Result<Certificate> makeCertificate(const std::vector<std::string>& hosts);

/// Lorica's own certificate, which is kept so that a browser has to be told only once to trust it. One that ends within
/// a day, cannot be read, or is not for all of the hosts, is made again.
/// @param folder  where it is kept; made for this user alone
[[nodiscard]] Result<Certificate> ownCertificate(const std::filesystem::path& folder,
                                                 const std::vector<std::string>& hosts);

/// The certificate's SHA-256, as browsers show it: "AB:CD:..."; empty if it is none.
[[nodiscard]] std::string fingerprintOf(const std::string& chain);

}  // namespace lorica
