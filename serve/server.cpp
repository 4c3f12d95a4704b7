#include "serve/connection.h"

#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/user_folders.h"
#include "player/window_opener.h"
#include "serve/certificate.h"
#include "serve/link.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <chrono>
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

struct PageServer::Impl {
  ServerState shared;
  std::optional<tcp::acceptor> acceptor;
  std::thread thread;
  std::vector<std::string> links;
  int port = 0;
  ServedFrame filling;  // of the session's thread
  std::uint32_t run = 0;
  std::string state, fingerprint;

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
    acceptor.emplace(shared.io);
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
    if (shared.stopping) return;
    if (!error) shared.take(std::move(socket));
    accept();
  });
}

PageServer::PageServer() : impl_(std::make_unique<Impl>()) {}

Result<std::unique_ptr<PageServer>> PageServer::start(const ServeSetting& setting, const ServeLimits& limits) {
  std::unique_ptr<PageServer> server(new PageServer);
  Impl& impl = *server->impl_;
  impl.shared.limits = limits;
  if (std::error_code error; !setting.recordings.empty()) {
    std::filesystem::create_directories(setting.recordings, error);
    if (error) return unwritable("--recordings: {}: {}", setting.recordings, error.message());
  }
  if (setting.recordings.empty()) {
    impl.shared.noSentFiles = "files need a folder on the machine that serves: start with --recordings DIR";
  } else if (setting.paths == PathTrust::kAnywhere) {
    impl.shared.noSentFiles = "with --trust-paths a file could name any other of the machine that serves";
  } else {
    impl.shared.sentFiles = std::filesystem::absolute(setting.recordings) / kSentFolder;
    impl.shared.writer.emplace(1);
  }
  LORICA_TRY_DO(impl.listen(setting));
  if (setting.lan) {
    impl.shared.secure = true;
    impl.shared.token = makeToken();
    if (impl.shared.token.empty()) return unsupported("no token could be made: the system gives no random numbers");
    std::vector<std::string> hosts = networkAddresses();
    for (const std::string& host : hosts) {
      impl.links.push_back(fmt::format("https://{}:{}/#{}", host, impl.port, impl.shared.token));
    }
    hosts.insert(hosts.end(), {"localhost", "127.0.0.1"});
    if (impl.links.empty()) {
      impl.links.push_back(fmt::format("https://localhost:{}/#{}", impl.port, impl.shared.token));
    }
    LORICA_TRY(const Certificate certificate, certificateOf(setting, hosts));
    impl.fingerprint = fingerprintOf(certificate.chain);
    impl.shared.tls.emplace(asio::ssl::context::tls_server);
    LORICA_TRY_DO(useCertificate(certificate, setting, *impl.shared.tls));
  } else {
    for (const char* host : {"127.0.0.1", "localhost"}) {
      impl.shared.hosts.insert(fmt::format("{}:{}", host, impl.port));
    }
    impl.links.push_back(fmt::format("http://127.0.0.1:{}/", impl.port));
  }
  impl.accept();
  impl.thread = std::thread([&impl] { impl.shared.io.run(); });
  return server;
}

PageServer::~PageServer() {
  if (!impl_->thread.joinable()) return;
  ServerState& shared = impl_->shared;
  asio::post(shared.io, [this, &shared] {
    shared.stopping = true;
    error_code ignored;
    impl_->acceptor->close(ignored);
    shared.sayGoodbye();
  });
  impl_->thread.join();
}

const std::vector<std::string>& PageServer::links() const {
  return impl_->links;
}

const std::filesystem::path& PageServer::sentFiles() const {
  return impl_->shared.sentFiles;
}

std::string_view PageServer::noSentFiles() const {
  return impl_->shared.noSentFiles;
}

int PageServer::port() const {
  return impl_->port;
}

const std::string& PageServer::fingerprint() const {
  return impl_->fingerprint;
}

const std::string& PageServer::token() const {
  return impl_->shared.token;
}

unsigned PageServer::layers() const {
  return impl_->shared.layers;
}

int PageServer::clients() const {
  return impl_->shared.clients;
}

void PageServer::setCast(std::shared_ptr<const ServedCast> cast) {
  ServerState& shared = impl_->shared;
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
  ServerState& shared = impl_->shared;
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

void PageServer::setState(std::string state) {
  if (state == impl_->state) return;
  impl_->state = state;
  asio::post(impl_->shared.io,
             [&shared = impl_->shared, state = std::make_shared<const std::string>(std::move(state))] {
               shared.state = state;
               ++shared.stateNumber;
               shared.spread();
             });
}

void PageServer::say(std::string words) {
  asio::post(impl_->shared.io, [&shared = impl_->shared, text = std::make_shared<const std::string>(std::move(words))] {
    shared.say(text);
  });
}

void PageServer::takeWishes(std::vector<Wish>& wishes) {
  const std::lock_guard lock(impl_->shared.mutex);
  wishes.insert(wishes.end(), impl_->shared.wishes.begin(), impl_->shared.wishes.end());
  impl_->shared.wishes.clear();
}

void PageServer::waitForWish(double seconds) {
  std::unique_lock lock(impl_->shared.mutex);
  impl_->shared.wished.wait_for(lock, std::chrono::duration<double>(seconds),
                                [this] { return !impl_->shared.wishes.empty(); });
}

}  // namespace lorica
