#include "tests/viewer/vr/monado_headset.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

constexpr int kPort = 4242;

/// A packet of Monado's remote driver, little endian: a magic word, fov and pose of two eyes, the pose of the head, and
/// for each controller pose, velocities, fingers, triggers, sticks and buttons.
class Packet {
 public:
  void add(const void* bytes, std::size_t count) {
    const char* from = static_cast<const char*>(bytes);
    bytes_.insert(bytes_.end(), from, from + count);
  }
  void add(double number) {
    const float written = static_cast<float>(number);
    add(&written, sizeof written);
  }
  void add(const Told& pose) {
    for (const double c : {pose.turned.x(), pose.turned.y(), pose.turned.z(), pose.turned.w()}) add(c);
    for (const double c : pose.at) add(c);
  }
  void zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }
  [[nodiscard]] const std::vector<char>& bytes() const { return bytes_; }

 private:
  std::vector<char> bytes_;
};

/// @param patience  [s]
bool waitFor(const std::function<bool()>& there, int patience = 30) {
  for (int i = 0; i < 20 * patience; ++i) {
    if (there()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

/// To the remote driver; below 0 = nobody listens.
int connection() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kPort);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int made = ::socket(AF_INET, SOCK_STREAM, 0);
  if (::connect(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return made;
  ::close(made);
  return -1;
}

}  // namespace

void MonadoHeadset::SetUp() {
  if (std::getenv("LORICA_MONADO") == nullptr) GTEST_SKIP() << "there is no Monado: run scripts/test-vr";
  display_.emplace();
  ASSERT_TRUE(display_->ready());
  ASSERT_NO_FATAL_FAILURE(startService());
  openWindow();
}

void MonadoHeadset::openWindow() {
  Result<std::unique_ptr<HeadsetWindow>> opened = Error{ErrorCode::kNoDisplay, ""};
  // A service that has just begun does not answer everybody yet.
  (void)waitFor([&] {
    opened = HeadsetWindow::create([] { return Window::create("Lorica test", 320, 240); },
                                   [this](const std::string& sentence) { said.push_back(sentence); });
    return opened.ok();
  });
  ASSERT_TRUE(opened) << opened.error().message;
  window = std::move(*opened);
}

void MonadoHeadset::openUnseen() {
  window.reset();
  display_.reset();
  openWindow();
}

void MonadoHeadset::startService(const std::string& shownOn) {
  const char* command = std::getenv("LORICA_MONADO");
  const std::filesystem::path there = std::filesystem::path(std::getenv("XDG_RUNTIME_DIR")) / "monado_comp_ipc";
  std::filesystem::remove(there);
  const auto serve = [&] {
    if (!shownOn.empty()) {
      ::unsetenv("XRT_COMPOSITOR_NULL");
      ::setenv("XRT_COMPOSITOR_FORCE_XCB", "1", 1);
      ::setenv("DISPLAY", shownOn.c_str(), 1);
    }
    std::exit(std::system(command));
  };
  // It ends at once while another one, which was killed, is not quite gone.
  bool begun = false;
  for (int patience = 4; !begun && patience < 100; patience *= 2) {
    service_.emplace(serve, there.parent_path() / "service.log");
    begun = waitFor([&] { return std::filesystem::exists(there); }, patience);
  }
  ASSERT_TRUE(begun);
  ASSERT_TRUE(waitFor([&] { return (socket_ = connection()) >= 0; }));
  tell(told);
}

void MonadoHeadset::endService() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  service_.reset();
  // It was killed, and is gone when nobody listens any more.
  (void)waitFor([] {
    const int made = connection();
    if (made >= 0) ::close(made);
    return made < 0;
  });
}

void MonadoHeadset::TearDown() {
  window.reset();
  endService();
}

void MonadoHeadset::tell(const ToldHeadset& now) const {
  Packet packet;
  packet.add("mndrmt3", 8);
  for (int eye = 0; eye < 2; ++eye) {
    for (const double c : {now.angles.left, now.angles.right, now.angles.up, now.angles.down}) packet.add(c);
    packet.add(Told{{0.032 * (2 * eye - 1), 0.0, 0.0}});
    packet.zeros(4);
  }
  packet.add(now.head);
  const char eachEye = 1;
  packet.add(&eachEye, 1);
  packet.zeros(3);
  for (std::size_t hand = 0; hand < 2; ++hand) {
    packet.add(now.hands[hand]);
    packet.zeros(6 * sizeof(float));
    for (int finger = 0; finger < 5; ++finger) packet.add(now.fists[hand]);
    packet.add(now.triggers[hand]);
    packet.zeros(2 * sizeof(float) + 5 * sizeof(float));
    const std::array<char, 2> active = {char(now.bare), char(!now.bare)};
    packet.add(active.data(), active.size());
    packet.zeros(4);  // the buttons "system" and "a"
    const char opens = char(now.opens[hand]);
    packet.add(&opens, 1);
    packet.zeros(9);
  }
  ASSERT_EQ(packet.bytes().size(), 376u);
  (void)::send(socket_, packet.bytes().data(), packet.bytes().size(), MSG_NOSIGNAL);  // or the service has ended
}

}  // namespace lorica::test
