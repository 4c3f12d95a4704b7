#include "viewer/page/server_state.h"

#include <boost/asio/post.hpp>

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/user_folders.h"
#include "viewer/page/link.h"
#include "viewer/player/window_opener.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <system_error>
#include <thread>

namespace lorica {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int kPortsToTry = 20;

Result<Certificate> certificateOf(const ServeSetting& setting, const std::vector<std::string>& hosts) {
  if (setting.certificate.empty()) {
    const std::filesystem::path folder = userFolder("XDG_CONFIG_HOME", ".config");
    return ownCertificate(folder.empty() ? folder : folder / "serve", hosts);
  }
  LORICA_TRY(std::string chain, readFile(setting.certificate));
  LORICA_TRY(std::string key, readFile(setting.key));
  return Certificate{std::move(chain), std::move(key)};
}

Result<void> useCertificate(const Certificate& certificate, const ServeSetting& setting, asio::ssl::context& tls) {
  const auto unusable = [&](const std::string& file, const error_code& error) {
    return badFormat("{}: no certificate and key that TLS can use: {}", file.empty() ? "its own certificate" : file,
                     error.message());
  };
  error_code error;
  SSL_CTX_set_min_proto_version(tls.native_handle(), TLS1_3_VERSION);
  tls.use_certificate_chain(asio::buffer(certificate.chain), error);
  if (error) return unusable(setting.certificate, error);
  tls.use_private_key(asio::buffer(certificate.key), asio::ssl::context::pem, error);
  if (error) return unusable(setting.key, error);
  return {};
}

}  // namespace

struct PageServer::Impl : ServerState {
  std::optional<tcp::acceptor> acceptor;
  std::thread thread;
  asio::steady_timer pause{io};  // before the next one is accepted
  // Of the session's thread.
  ServedFrame filling;
  std::uint32_t run = 0;
  std::array<std::string, kServedTexts> given;

  Result<void> listen(const ServeSetting& setting);
  void accept();
};

Result<void> PageServer::Impl::listen(const ServeSetting& setting) {
  const asio::ip::address address =
      setting.lan ? asio::ip::address(asio::ip::address_v4::any()) : asio::ip::address_v4::loopback();
  const int first = setting.port > 0 ? setting.port : kUsualPort;
  const int tries = setting.port > 0 ? 1 : kPortsToTry;
  error_code error;
  for (int i = 0; i < tries; ++i) {
    acceptor.emplace(io);
    const tcp::endpoint end(address, static_cast<std::uint16_t>(first + i));
    acceptor->open(end.protocol(), error);
    if (!error) ::fcntl(acceptor->native_handle(), F_SETFD, FD_CLOEXEC);
    if (!error) acceptor->set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor->bind(end, error);
    if (!error) acceptor->listen(asio::socket_base::max_listen_connections, error);
    if (!error) break;
  }
  if (error) return unwritable("port {}: cannot be listened on: {}", first, error.message());
  port = acceptor->local_endpoint().port();
  return {};
}

void PageServer::Impl::accept() {
  acceptor->async_accept([this](error_code error, tcp::socket socket) {
    if (stopping) return;
    const bool crowded = error || !take(std::move(socket));  // an error: for want of descriptors
    if (!crowded) return accept();
    // Who waits to be accepted has sent its greeting by then, and strangers who come again at once do not fill the
    // time.
    pause.expires_after(std::chrono::milliseconds(20));
    pause.async_wait([this](error_code) {
      if (!stopping) accept();
    });
  });
}

PageServer::PageServer() : impl_(std::make_unique<Impl>()) {}

Result<std::unique_ptr<PageServer>> PageServer::start(const ServeSetting& setting, const ServeLimits& limits) {
  std::unique_ptr<PageServer> server(new PageServer);
  Impl& impl = *server->impl_;
  impl.limits = limits;
  if (std::error_code error; !setting.recordings.empty()) {
    std::filesystem::create_directories(setting.recordings, error);
    if (error) return unwritable("--recordings: {}: {}", setting.recordings, error.message());
  }
  if (setting.recordings.empty()) {
    impl.noSentFiles = "files need a folder on the machine that serves: start with --recordings DIR";
  } else if (setting.paths == PathTrust::kAnywhere) {
    impl.noSentFiles = "with --trust-paths a file could name any other of the machine that serves";
  } else {
    impl.sentFiles = std::filesystem::absolute(setting.recordings) / kSentFolder;
    impl.writer.emplace(1);
  }
  LORICA_TRY_DO(impl.listen(setting));
  if (setting.lan) {
    impl.secure = true;
    impl.token = makeToken();
    if (impl.token.empty()) return unsupported("no token could be made: the system gives no random numbers");
    std::vector<std::string> hosts = networkAddresses();
    for (const std::string& host : hosts) {
      impl.links.push_back(fmt::format("https://{}:{}/#{}", host, impl.port, impl.token));
    }
    hosts.insert(hosts.end(), {"localhost", "127.0.0.1"});
    if (impl.links.empty()) {
      impl.links.push_back(fmt::format("https://localhost:{}/#{}", impl.port, impl.token));
    }
    LORICA_TRY(const Certificate certificate, certificateOf(setting, hosts));
    impl.fingerprint = fingerprintOf(certificate.chain);
    impl.certificateRenewed = certificate.renewed;
    impl.tls.emplace(asio::ssl::context::tls_server);
    LORICA_TRY_DO(useCertificate(certificate, setting, *impl.tls));
  } else {
    for (const char* host : {"127.0.0.1", "localhost"}) {
      impl.hosts.insert(fmt::format("{}:{}", host, impl.port));
    }
    impl.links.push_back(fmt::format("http://127.0.0.1:{}/", impl.port));
  }
  impl.accept();
  impl.thread = std::thread([&impl] { impl.io.run(); });
  return server;
}

PageServer::~PageServer() {
  if (!impl_->thread.joinable()) return;
  ServerState& shared = *impl_;
  asio::post(shared.io, [this, &shared] {
    shared.stopping = true;
    error_code ignored;
    impl_->acceptor->close(ignored);
    shared.sayGoodbye();
  });
  impl_->thread.join();
}

const ServerFacts& PageServer::facts() const {
  return *impl_;
}

unsigned PageServer::layers() const {
  return impl_->layers;
}

int PageServer::clients() const {
  return impl_->clients;
}

void PageServer::setCast(std::shared_ptr<const ServedCast> cast) {
  ServerState& shared = *impl_;
  impl_->run = cast->run;
  asio::post(shared.io, [&shared, cast = std::move(cast)] {
    shared.cast = cast;
    ++shared.castNumber;
    shared.spread();
  });
}

ServedFrame& PageServer::next() {
  impl_->filling.run = impl_->run;
  return impl_->filling;
}

void PageServer::publish() {
  ServerState& shared = *impl_;
  {
    const std::lock_guard lock(shared.mutex);
    std::swap(shared.handedOver, impl_->filling);
    if (std::exchange(shared.fresh, true)) return;  // the server's thread has not looked yet
  }
  asio::post(shared.io, [&shared] {
    {
      const std::lock_guard lock(shared.mutex);
      std::swap(shared.handedOver, shared.shown);
      shared.fresh = false;
    }
    shared.encoder.encode(shared.shown);
    ++shared.frameNumber;
    shared.spread();
  });
}

void PageServer::set(ServedText kind, std::string text) {
  const auto index = static_cast<std::size_t>(kind);
  if (text == impl_->given[index]) return;
  impl_->given[index] = text;
  asio::post(impl_->io, [&shared = *impl_, index, text = std::make_shared<const std::string>(std::move(text))] {
    shared.texts[index] = text;
    ++shared.textNumbers[index];
    shared.spread();
  });
}

void PageServer::say(std::string words) {
  asio::post(impl_->io,
             [&shared = *impl_, text = std::make_shared<const std::string>(std::move(words))] { shared.say(text); });
}

void PageServer::takeMessages(std::vector<ClientMessage>& messages) {
  const std::lock_guard lock(impl_->mutex);
  messages.insert(messages.end(), impl_->messages.begin(), impl_->messages.end());
  impl_->messages.clear();
}

void PageServer::waitForMessage(double seconds) {
  std::unique_lock lock(impl_->mutex);
  impl_->arrived.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !impl_->messages.empty(); });
}

}  // namespace lorica
