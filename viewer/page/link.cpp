#include "viewer/page/link.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/files.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <qrcodegen.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <memory>
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

constexpr long kDays = 397;          // browsers accept no longer ones
constexpr long kDay = 24 * 60 * 60;  // [s]
constexpr long kVersion3 = 2;        // of X.509
constexpr std::size_t kMaxPem = 1 << 20;

template <auto release>
struct Releaser {
  void operator()(auto* object) const { release(object); }
};
using Key = std::unique_ptr<EVP_PKEY, Releaser<EVP_PKEY_free>>;
using X509Handle = std::unique_ptr<X509, Releaser<X509_free>>;
using Bio = std::unique_ptr<BIO, Releaser<BIO_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Releaser<X509_EXTENSION_free>>;

std::string textOf(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(std::max(size, 0L))};
}

X509Handle certificateIn(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(std::min(pem.size(), kMaxPem))));
  return X509Handle(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
}

bool addExtension(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
  return extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1;
}

bool isAddress(const std::string& host) {
  return std::ranges::all_of(host, [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; });
}

std::string alternativeNames(const std::vector<std::string>& hosts) {
  std::string names;
  for (const std::string& host : hosts) {
    names += fmt::format("{}{}:{}", names.empty() ? "" : ",", isAddress(host) ? "IP" : "DNS", host);
  }
  return names;
}

/// Whether the certificate and the key belong together and it is valid for another day.
bool usable(const Certificate& kept) {
  const X509Handle certificate = certificateIn(kept.chain);
  const Bio bio(BIO_new_mem_buf(kept.key.data(), static_cast<int>(std::min(kept.key.size(), kMaxPem))));
  const Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, nullptr, nullptr));
  if (certificate == nullptr || key == nullptr || X509_check_private_key(certificate.get(), key.get()) != 1) {
    return false;
  }
  int days = 0, seconds = 0;
  return ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate.get())) == 1 && days >= 1;
}

/// Whether a certificate is for all of these hosts. Phones refuse one that is not for the address that they typed.
bool isFor(const std::string& chain, const std::vector<std::string>& hosts) {
  const X509Handle certificate = certificateIn(chain);
  return std::ranges::all_of(hosts, [&](const std::string& host) {
    return (isAddress(host) ? X509_check_ip_asc(certificate.get(), host.c_str(), 0)
                            : X509_check_host(certificate.get(), host.c_str(), 0, 0, nullptr)) == 1;
  });
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

Result<Certificate> makeCertificate(const std::vector<std::string>& hosts) {
  const Key key(EVP_EC_gen("P-256"));
  const X509Handle certificate(X509_new());
  std::array<unsigned char, 16> serial{};
  bool made = key != nullptr && certificate != nullptr && RAND_bytes(serial.data(), serial.size()) == 1;
  if (made) {
    serial[0] &= 0x7f;  // above zero
    const std::unique_ptr<BIGNUM, Releaser<BN_free>> number(BN_bin2bn(serial.data(), serial.size(), nullptr));
    X509_NAME* name = X509_get_subject_name(certificate.get());
    const auto* owner = reinterpret_cast<const unsigned char*>("Lorica on this machine");
    made = X509_set_version(certificate.get(), kVersion3) == 1 &&
           BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate.get())) != nullptr &&
           X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -kDay) != nullptr &&
           X509_gmtime_adj(X509_getm_notAfter(certificate.get()), (kDays - 1) * kDay) != nullptr &&
           X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8, owner, -1, -1, 0) == 1 &&
           X509_set_issuer_name(certificate.get(), name) == 1 && X509_set_pubkey(certificate.get(), key.get()) == 1 &&
           addExtension(certificate.get(), NID_subject_alt_name, alternativeNames(hosts)) &&
           addExtension(certificate.get(), NID_basic_constraints, "critical,CA:FALSE") &&
           addExtension(certificate.get(), NID_ext_key_usage, "serverAuth") &&
           X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0;
  }
  const Bio chain(BIO_new(BIO_s_mem())), secret(BIO_new(BIO_s_mem()));
  if (!made || PEM_write_bio_X509(chain.get(), certificate.get()) != 1 ||
      PEM_write_bio_PrivateKey(secret.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1) {
    return unsupported("no certificate could be made: OpenSSL refused");
  }
  return Certificate{textOf(chain.get()), textOf(secret.get())};
}

Result<Certificate> ownCertificate(const std::filesystem::path& folder, const std::vector<std::string>& hosts) {
  if (folder.empty()) return makeCertificate(hosts);
  LORICA_TRY_DO(makeOwnFolder(folder));
  const std::filesystem::path chainFile = folder / "certificate.pem", keyFile = folder / "key.pem";
  const Result<std::string> chain = readFile(chainFile, NamedBy::kLorica, kMaxPem);
  const Result<std::string> key = readFile(keyFile, NamedBy::kLorica, kMaxPem);
  const bool kept = chain && key && usable({*chain, *key});
  if (kept && isFor(*chain, hosts)) return Certificate{*chain, *key};
  LORICA_TRY(Certificate made, makeCertificate(hosts));
  made.renewed = kept;
  LORICA_TRY_DO(writeFileAtomically(keyFile, made.key, NamedBy::kSecret));
  LORICA_TRY_DO(writeFileAtomically(chainFile, made.chain, NamedBy::kLorica));
  return made;
}

std::string fingerprintOf(const std::string& chain) {
  const X509Handle certificate = certificateIn(chain);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (certificate == nullptr || X509_digest(certificate.get(), EVP_sha256(), digest.data(), &size) != 1) return "";
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{}{:02X}", i == 0 ? "" : ":", digest[i]);
  return text;
}

}  // namespace lorica
