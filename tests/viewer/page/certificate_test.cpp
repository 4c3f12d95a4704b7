
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "viewer/page/link.h"

#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <filesystem>
#include <set>

namespace lorica {
namespace {

using test::valueOf;

TEST(Certificate, IsForTheHostsAndVerifiesItself) {
  const Certificate made = valueOf(makeCertificate({"192.168.0.7", "localhost"}));
  BIO* bio = BIO_new_mem_buf(made.chain.data(), -1);
  X509* certificate = PEM_read_bio_X509(bio, nullptr, nullptr, nullptr);
  ASSERT_NE(certificate, nullptr);
  EXPECT_EQ(X509_check_ip_asc(certificate, "192.168.0.7", 0), 1);
  EXPECT_EQ(X509_check_ip_asc(certificate, "192.168.0.8", 0), 0);
  EXPECT_EQ(X509_check_host(certificate, "localhost", 0, 0, nullptr), 1);
  EXPECT_EQ(X509_check_host(certificate, "example.org", 0, 0, nullptr), 0);
  EXPECT_EQ(X509_verify(certificate, X509_get0_pubkey(certificate)), 1);
  EXPECT_EQ(X509_check_ca(certificate), 0);
  int days = 0, seconds = 0;
  EXPECT_EQ(ASN1_TIME_diff(&days, &seconds, X509_get0_notBefore(certificate), X509_get0_notAfter(certificate)), 1);
  EXPECT_EQ(days, 397);
  X509_free(certificate);
  BIO_free(bio);
}

TEST(Certificate, IsKeptAndMadeAgainWhenItIsBroken) {
  const test::TemporaryFolder folder;
  const std::filesystem::path kept = folder.path() / "serve";
  const Certificate first = valueOf(ownCertificate(kept, {"localhost"}));
  EXPECT_EQ(valueOf(ownCertificate(kept, {"localhost"})).chain, first.chain);
  EXPECT_EQ(fingerprintOf(first.chain).size(), 95u);
  namespace fs = std::filesystem;
  EXPECT_EQ(fs::status(kept).permissions() & (fs::perms::group_all | fs::perms::others_all), fs::perms::none);
  EXPECT_EQ(fs::status(kept / "key.pem").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  // Another address: phones refuse a certificate without it. What it was kept for besides need not be there.
  EXPECT_FALSE(first.renewed);
  const Certificate moved = valueOf(ownCertificate(kept, {"localhost", "10.0.0.7"}));
  EXPECT_TRUE(moved.renewed);
  EXPECT_NE(moved.chain, first.chain);
  const Certificate still = valueOf(ownCertificate(kept, {"localhost"}));
  EXPECT_EQ(still.chain, moved.chain);
  EXPECT_FALSE(still.renewed);
  // A key that belongs to another certificate.
  const Certificate other = valueOf(makeCertificate({"localhost"}));
  (void)folder.write("serve/key.pem", other.key);
  const Certificate again = valueOf(ownCertificate(kept, {"localhost"}));
  EXPECT_NE(again.chain, moved.chain);
  EXPECT_FALSE(again.renewed) << "it was broken";
  EXPECT_EQ(valueOf(ownCertificate(kept, {"localhost"})).chain, again.chain);
  EXPECT_EQ(fingerprintOf("no certificate"), "");
}

TEST(Link, TokensAreLongAndNeverTheSame) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(makeToken());
  EXPECT_EQ(tokens.size(), 100u);
  for (const std::string& token : tokens) EXPECT_EQ(token.size(), 22u);
  const std::string one = *tokens.begin();
  EXPECT_TRUE(sameToken(one, one));
  EXPECT_FALSE(sameToken(one, *tokens.rbegin()));
  EXPECT_FALSE(sameToken(one, one.substr(1)));
  EXPECT_FALSE(sameToken(one, ""));
}

TEST(Link, ACodeHasTheSizeOfItsVersion) {
  // A link of 50 bytes with medium correction takes version 4: 33 modules, and a margin of 2 on each side.
  const std::string code = qrCode("https://192.168.0.7:8420/#" + std::string(22, 'x'));
  EXPECT_EQ(std::count(code.begin(), code.end(), '\n'), (33 + 4 + 1) / 2);
}

}  // namespace
}  // namespace lorica
