#include "capture/streams/depth_stream.h"

#include "capture/streams/udp.h"
#include "docs/samples/depth/lorica_depth.h"
#include "geometry/descriptor.h"
#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <thread>

namespace lorica {
namespace {

using test::has;
using test::valueOf;

DepthLens smallLens() {
  return DepthLens::pinhole(40, 30, 1.0, 0.8);
}

std::vector<std::uint16_t> imageOf(const DepthLens& lens, int number) {
  std::vector<std::uint16_t> image(static_cast<std::size_t>(lens.width) * lens.height);
  std::iota(image.begin(), image.end(), static_cast<std::uint16_t>(1000 + number));
  return image;
}

std::string bytesOf(const DepthLens& lens, double time, const std::vector<std::uint16_t>& image) {
  const auto header = depthHeaderOf(lens, time);
  std::string bytes(reinterpret_cast<const char*>(header.data()), header.size());
  return bytes.append(reinterpret_cast<const char*>(image.data()), 2 * image.size());
}

std::string sentImages(const DepthLens& lens, int first, int count) {
  std::string bytes;
  for (int i = first; i < first + count; ++i) bytes += bytesOf(lens, i / 30.0, imageOf(lens, i));
  return bytes;
}

/// Feeds bytes in pieces. @return how many images came, or why it ended
Result<int> fed(DepthFrameParser& parser, std::string_view bytes, std::size_t piece) {
  int images = 0;
  while (!bytes.empty()) {
    const std::span<std::byte> place = parser.wanted();
    const std::size_t size = std::min({place.size(), bytes.size(), piece});
    std::memcpy(place.data(), bytes.data(), size);
    bytes.remove_prefix(size);
    LORICA_TRY(const bool whole, parser.got(size));
    images += whole ? 1 : 0;
  }
  return images;
}

TEST(DepthFrameParser, ImagesAreTheSameInPiecesOfAnySize) {
  const DepthLens lens = smallLens();
  for (const std::size_t piece : {1U, 7U, 136U, 137U, 5000U, 1000000U}) {
    DepthFrameParser parser;
    EXPECT_EQ(valueOf(fed(parser, sentImages(lens, 0, 3), piece)), 3);
    EXPECT_EQ(parser.image(), imageOf(lens, 2));
    EXPECT_EQ(parser.time(), 2 / 30.0);
    EXPECT_EQ(*parser.lens(), lens);
    EXPECT_FALSE(parser.within());
  }
}

TEST(DepthFrameParser, BareImagesAreThoseOfTheFormat) {
  const std::vector<std::uint16_t> image(64 * 48, 0x1234);
  std::string bytes(reinterpret_cast<const char*>(image.data()), 2 * image.size());
  for (const bool big : {false, true}) {
    const std::string text = fmt::format("gray16{},64x48,fov=60x45,unit=0.0002", big ? "be" : "le");
    DepthFrameParser parser(valueOf(parseBareDepth(text)));
    EXPECT_EQ(parser.lens()->metresPerUnit, 0.0002);
    EXPECT_EQ(valueOf(fed(parser, bytes, 100)), 1);
    EXPECT_EQ(parser.image()[5], big ? 0x3412 : 0x1234);
    EXPECT_LT(parser.time(), 0.0);
  }
}

TEST(DepthFrameParser, AnImageThatBrokeOffCostsNoMoreThanTheNext) {
  const DepthLens lens = smallLens();
  const std::string one = sentImages(lens, 0, 1);
  for (const std::size_t left : {1UL, 100UL, 136UL, 137UL, one.size() / 2, one.size() - 1}) {
    DepthFrameParser parser;
    const std::string bytes = one + one.substr(0, left) + sentImages(lens, 1, 4);
    const int images = valueOf(fed(parser, bytes, 333));
    EXPECT_GE(images, 4) << left;
    EXPECT_LE(images, 6) << left;
    EXPECT_EQ(parser.image(), imageOf(lens, 4)) << left;
  }
}

TEST(DepthFrameParser, AHeaderThatCannotBeIsASentence) {
  struct Wrong {
    std::size_t at;
    double value;  // of 8 bytes, or an integer of 4 where at < 24
    const char* says;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const Wrong& wrong :
       {Wrong{0, 7, "LORDEPTH"}, Wrong{8, 2, "version 2"}, Wrong{12, 3, "found an image of 3"},
        Wrong{16, 70000, "70000 x 30"}, Wrong{20, 0, "40 x 0"}, Wrong{24, nan, "nan s"},
        Wrong{32, 1.5, "unit of 1.5 m"}, Wrong{32, 0, "unit of 0 m"}, Wrong{32, nan, "unit of nan"},
        Wrong{40, -3, "focal"}, Wrong{40, nan, "focal"}, Wrong{48, 1e9, "focal"}, Wrong{56, -40, "axis"},
        Wrong{64, nan, "axis"}, Wrong{72, infinite, "distortion"}, Wrong{72, -30, "folds"},
        Wrong{128, nan, "distortion"}}) {
    std::string bytes = sentImages(smallLens(), 0, 1);
    if (wrong.at < 24) {
      const auto number = static_cast<std::uint32_t>(wrong.value);
      std::memcpy(bytes.data() + wrong.at, &number, 4);
    } else {
      std::memcpy(bytes.data() + wrong.at, &wrong.value, 8);
    }
    DepthFrameParser parser;
    const Result<int> read = fed(parser, bytes, 4096);
    ASSERT_FALSE(read) << wrong.says;
    EXPECT_TRUE(has(read.error().message, wrong.says)) << read.error().message;
  }
  DepthFrameParser parser;
  DepthLens other = smallLens();
  other.focalX *= 2;
  EXPECT_TRUE(
      has(fed(parser, sentImages(smallLens(), 0, 1) + sentImages(other, 1, 1), 999).error().message, "another camera"));
}

TEST(DepthFrameParser, MutatedStreamsEndInASentenceAndReserveNothing) {
  RandomNumbers random(68);
  const std::string good = sentImages(smallLens(), 0, 3);
  const test::AllocationWatch watch;
  int refused = 0, whole = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string bytes = good;
    const std::size_t reach = trial % 2 == 0 ? kDepthHeaderBytes : bytes.size();  // half of them in the first header
    for (int change = 0; change <= trial % 4; ++change) {
      const auto at = static_cast<std::size_t>(random.between(0.0, 0.999) * static_cast<double>(reach));
      bytes[at] = static_cast<char>(random.bits() >> 56U);
    }
    bytes.resize(static_cast<std::size_t>(random.between(0.0, 1.0) * static_cast<double>(bytes.size())));
    DepthFrameParser parser;
    const Result<int> read = fed(parser, bytes, 1 + trial % 300);
    ++(read ? whole : refused);
    EXPECT_TRUE(read || !read.error().message.empty());
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(whole, 1000);
  EXPECT_LT(watch.largest(), std::size_t{30} << 20);
  DepthFrameParser parser;
  ASSERT_TRUE(fed(parser, good, 4096));
  const Result<int> rubbish = fed(parser, std::string(std::size_t{17} << 20, 'L'), 4096);
  ASSERT_FALSE(rubbish) << "not for ever";
  EXPECT_TRUE(has(rubbish.error().message, "no header"));
}

TEST(DepthFrameParser, FormatsThatCannotBeAreSentences) {
  for (const auto& [text, says] :
       std::vector<std::pair<std::string, std::string>>{{"rgb24,640x480", "gray16le"},
                                                        {"gray16le", "no size"},
                                                        {"gray16le,640", "1 numbers"},
                                                        {"gray16le,640x480x2", "3 numbers"},
                                                        {"gray16le,0x480,fov=60x45", "0 x 480"},
                                                        {"gray16le,640x480,fov=60", "1 numbers"},
                                                        {"gray16le,640x480,fov=0x45", "field of view of 0 degrees"},
                                                        {"gray16le,640x480,fov=ax45", "'a'"},
                                                        {"gray16le,100x99", "usual"},
                                                        {"gray16le,640x480,zoom=2", "zoom=2"},
                                                        {"gray16le,640x480,unit=5", "unit of 5 m"},
                                                        {"gray16le,640x480,unit=cm", "'cm'"},
                                                        {"gray16le,640x480,d=nan", "'nan'"},
                                                        {"gray16le,1e30x480,fov=60x45", "1e+30"}}) {
    const Result<BareDepth> read = parseBareDepth(text);
    ASSERT_FALSE(read) << text;
    EXPECT_TRUE(has(read.error().message, says)) << read.error().message;
  }
  EXPECT_EQ(valueOf(parseBareDepth("gray16le,640x576")).lens.metresPerUnit, 0.001);
  EXPECT_EQ(valueOf(parseBareDepth("gray16le,640x480,fx=525,cx=319.5,unit=mm")).lens.focalY, 525.0);
  EXPECT_EQ(valueOf(parseBareDepth("gray16le,640x480,unit=0.1mm")).lens.metresPerUnit, 0.1 * 0.001);
}

/// A sender at a named pipe, a Unix socket or a port of this machine; waits until somebody listens there.
class Client {
 public:
  explicit Client(const std::string& at) : descriptor_(connected(at)) {}
  void send(std::string_view bytes) const { EXPECT_EQ(writeAll(descriptor_.get(), bytes), 0); }
  [[nodiscard]] int get() const { return descriptor_.get(); }

 private:
  static int connected(const std::string& at) {
    for (;; std::this_thread::yield()) {
      struct stat status {};
      if (::stat(at.c_str(), &status) == 0 && S_ISFIFO(status.st_mode)) return ::open(at.c_str(), O_WRONLY | O_CLOEXEC);
      sockaddr_un local{};
      local.sun_family = AF_UNIX;
      at.copy(local.sun_path, sizeof local.sun_path - 1);
      sockaddr_in inet{};
      inet.sin_family = AF_INET;
      inet.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const bool path = has(at, "/");
      if (!path) inet.sin_port = htons(static_cast<std::uint16_t>(std::stoi(at)));
      const auto* to = path ? reinterpret_cast<sockaddr*>(&local) : reinterpret_cast<sockaddr*>(&inet);
      const int made = ::socket(to->sa_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (::connect(made, to, path ? sizeof local : sizeof inet) == 0) return made;
      ::close(made);
    }
  }
  Descriptor descriptor_;
};

DepthStreamSettings at(const std::string& address) {
  DepthStreamSettings settings;
  settings.at = address;
  return settings;
}

/// Opens a stream while `first` sends to it.
template <typename Send>
Result<std::unique_ptr<DepthStream>> openWhile(const DepthStreamSettings& settings, Send&& first) {
  std::optional<Result<std::unique_ptr<DepthStream>>> opened;
  std::thread opening([&] { opened.emplace(DepthStream::open(settings)); });
  first();
  opening.join();
  return std::move(*opened);
}

/// What comes next, over the times in which nothing does.
Result<DepthRead> eventOf(DepthSource& source, DepthFrame& frame) {
  for (;;) {
    Result<DepthRead> read = source.next(frame);
    if (!read || *read != DepthRead::kWaiting) return read;
  }
}

void expectUnplugged(DepthSource& source) {
  DepthFrame frame;
  Result<DepthRead> read = eventOf(source, frame);
  while (read && *read == DepthRead::kFrame) read = eventOf(source, frame);
  EXPECT_EQ(valueOf(std::move(read)), DepthRead::kUnplugged);
}

/// Reads until an image is the one with this number.
void expectNumber(DepthSource& source, const DepthLens& lens, int number, double& lastTime) {
  DepthFrame frame;
  do {
    Result<DepthRead> read = eventOf(source, frame);
    while (read && *read == DepthRead::kUnplugged) read = eventOf(source, frame);
    ASSERT_EQ(valueOf(std::move(read)), DepthRead::kFrame);
    EXPECT_TRUE(lastTime < 0.0 ? frame.time == 0.0 : frame.time > lastTime) << "times rise, over all senders";
    lastTime = frame.time;
  } while (frame.depthMm[0] != 1000 + number);
  EXPECT_EQ(frame.depthMm, imageOf(lens, number));
}

class DepthStreams : public ::testing::Test {
 protected:
  void SetUp() override { signal(SIGPIPE, SIG_IGN); }
  static std::string freePort() {
    const Descriptor probe(valueOf(listenTcp({"127.0.0.1", 0})));
    return std::to_string(portOf(probe.get()));
  }
  test::TemporaryFolder folder_;
  const std::string socket_ = folder_.path() / "socket";
  const std::string pipe_ = folder_.path() / "pipe";
  const DepthLens lens_ = smallLens();
};

TEST_F(DepthStreams, SendersComeLeaveAndComeAgainOnEachWay) {
  ASSERT_EQ(::mkfifo(pipe_.c_str(), 0600), 0);
  for (const std::string& address : {pipe_, socket_, freePort()}) {
    std::optional<Client> sender;
    const auto stream = valueOf(openWhile(at(address), [&] {
      sender.emplace(address);
      sender->send(sentImages(lens_, 0, 2));
    }));
    EXPECT_NEAR(stream->camera().horizontalFov, 1.0, 1e-12);
    EXPECT_NEAR(stream->camera().verticalFov, 0.8, 1e-12);
    double time = -1.0;
    expectNumber(*stream, lens_, 1, time);
    sender->send(sentImages(lens_, 2, 1).substr(0, 1000));  // it is killed in the middle
    sender.reset();
    expectUnplugged(*stream);
    sender.emplace(address);
    sender->send(sentImages(lens_, 0, 4));  // its clock starts again
    expectNumber(*stream, lens_, 3, time);
    sender.reset();
    expectUnplugged(*stream);
    sender.emplace(address);
    sender->send(sentImages(lens_, 9, 1));
    expectNumber(*stream, lens_, 9, time);
    const DepthStream::Counts counts = stream->counts();
    EXPECT_EQ(counts.images, 7) << address;
    EXPECT_EQ(counts.broken, 1) << address;
    EXPECT_EQ(counts.senders, 3) << address;
  }
  EXPECT_NE(::access(socket_.c_str(), F_OK), 0) << "the socket is removed";
}

TEST_F(DepthStreams, TheNewestImageWinsAndTheOthersAreCounted) {
  std::optional<Client> sender;
  const auto stream = valueOf(openWhile(at(socket_), [&] {
    sender.emplace(socket_);
    sender->send(sentImages(lens_, 0, 50));
    sender.reset();
  }));
  DepthFrame frame;
  int given = 0;
  while (valueOf(eventOf(*stream, frame)) == DepthRead::kFrame) ++given;
  EXPECT_EQ(frame.depthMm, imageOf(lens_, 49));
  EXPECT_EQ(stream->counts().images, 50);
  EXPECT_EQ(given + stream->counts().dropped, 50);
}

TEST_F(DepthStreams, NothingIsReservedAfterTheFirstImages) {
  std::optional<Client> sender;
  const auto stream = valueOf(openWhile(at(socket_), [&] {
    sender.emplace(socket_);
    sender->send(sentImages(lens_, 0, 1));
  }));
  DepthFrame frame;
  std::vector<std::string> images;
  for (int i = 1; i < 20; ++i) images.push_back(sentImages(lens_, i, 1));
  long before = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (i == 3) before = test::allocationCount();
    (void)writeAll(sender->get(), images[i]);
    (void)eventOf(*stream, frame);
  }
  EXPECT_EQ(test::allocationCount(), before);
}

TEST_F(DepthStreams, WhoSaysNothingGivesWay) {
  DepthStreamSettings settings = at(socket_);
  settings.silence = 0.0;
  std::optional<Client> silent, other;
  const auto stream = valueOf(openWhile(settings, [&] {
    silent.emplace(socket_);
    silent->send(sentImages(lens_, 0, 1));
  }));
  double time = -1.0;
  expectNumber(*stream, lens_, 0, time);
  other.emplace(socket_);
  other->send(sentImages(lens_, 1, 1));
  expectNumber(*stream, lens_, 1, time);
  EXPECT_EQ(stream->counts().senders, 2);
}

TEST_F(DepthStreams, WhoStopsInTheMiddleIsLeft) {
  DepthStreamSettings settings = at(socket_);
  settings.bare = BareDepth{lens_, false};
  settings.stall = 0.01;
  const auto stream = valueOf(DepthStream::open(settings));
  const Client sender(socket_);
  sender.send("half an image");
  while (stream->counts().broken == 0) std::this_thread::yield();
  expectUnplugged(*stream);
}

TEST_F(DepthStreams, WhatIsNoStreamIsASentenceAndStaysOne) {
  std::optional<Client> sender;
  const auto sent = [&](const std::string& bytes) {
    return openWhile(at(socket_), [&, bytes] {
      sender.emplace(socket_);
      (void)writeAll(sender->get(), bytes);  // it may be left at once
    });
  };
  const Result<std::unique_ptr<DepthStream>> web = sent("GET / HTTP/1.1\r\n" + std::string(200, 'x'));
  ASSERT_FALSE(web);
  EXPECT_TRUE(has(web.error().message, "depth from " + socket_ + ": found bytes that start with 'GET / HT'"));
  DepthFrame frame;
  std::string later = sentImages(lens_, 0, 2);
  later[later.size() / 2 + 8] = 9;  // the second header's version
  const std::string input = folder_.write("input", later);
  const Descriptor kept(::dup(STDIN_FILENO)), opened(::open(input.c_str(), O_RDONLY));
  EXPECT_EQ(::dup2(opened.get(), STDIN_FILENO), STDIN_FILENO);
  std::unique_ptr<DepthStream> stream = valueOf(DepthStream::open(at("-")));
  ::dup2(kept.get(), STDIN_FILENO);
  Result<DepthRead> read = eventOf(*stream, frame);
  while (read) read = eventOf(*stream, frame);
  EXPECT_TRUE(has(read.error().message, "version 9"));
  EXPECT_FALSE(stream->next(frame));
  DepthLens lies = lens_;
  lies.metresPerUnit = 0.05;
  stream = valueOf(sent(sentImages(lies, 0, 1)));
  EXPECT_TRUE(has(eventOf(*stream, frame).error().message, "farther than 20 m"));
}

/// A browser's page may connect to a port of this machine; nobody ends a session so.
TEST_F(DepthStreams, WhoSendsRubbishIsLeftAndTheSessionGoesOn) {
  DepthLens others = lens_;
  others.focalX *= 2.0;
  const std::string other = sentImages(others, 1, 1);
  std::string newer = sentImages(lens_, 1, 1);
  newer[8] = 9;  // version
  for (const std::string& address : {socket_, freePort()}) {
    std::optional<Client> sender;
    const auto stream = valueOf(openWhile(at(address), [&] {
      sender.emplace(address);
      sender->send(sentImages(lens_, 0, 1));
    }));
    double time = -1.0;
    expectNumber(*stream, lens_, 0, time);
    std::int64_t refused = 0;
    for (const std::string& rubbish : {"GET / HTTP/1.1\r\n" + std::string(17U << 20, 'x'), other, newer}) {
      sender.reset();
      expectUnplugged(*stream);
      sender.emplace(address);
      (void)writeAll(sender->get(), rubbish);
      for (++refused; stream->counts().refused < refused;) std::this_thread::yield();
    }
    expectUnplugged(*stream);
    sender.emplace(address);
    sender->send(sentImages(lens_, 7, 1));
    expectNumber(*stream, lens_, 7, time);
  }
}

TEST_F(DepthStreams, AddressesThatCannotBeAreSentences) {
  const auto says = [](const std::string& address) { return DepthStream::open(at(address)).error().message; };
  EXPECT_TRUE(has(says("70000"), "70000"));
  EXPECT_TRUE(has(says("host:"), "host:"));
  EXPECT_TRUE(has(says("sokcet"), "found 'sokcet', expected -, a path with a / in it"));
  EXPECT_TRUE(has(says(folder_.path()), "a folder"));
  EXPECT_TRUE(has(says(folder_.write("film.mkv", "x")), "a file"));
  EXPECT_TRUE(has(says("/nowhere/socket"), "cannot listen"));
  EXPECT_TRUE(has(says("./" + std::string(200, 'x')), "200 bytes") ||
              has(says("./" + std::string(200, 'x')), "202 bytes"));
  DepthStreamSettings first = at(socket_);
  first.bare = BareDepth{lens_, false};
  auto stream = valueOf(DepthStream::open(first));
  EXPECT_TRUE(has(says(socket_), "in use")) << says(socket_);
  struct stat status {};
  ASSERT_EQ(::stat(socket_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U) << "only this user may connect";
}

TEST_F(DepthStreams, StandardInputHasAnEnd) {
  const Descriptor kept(::dup(STDIN_FILENO));
  const auto input = [&](std::string_view bytes) {
    const std::string file = folder_.write("input", bytes);
    const Descriptor opened(::open(file.c_str(), O_RDONLY));
    EXPECT_EQ(::dup2(opened.get(), STDIN_FILENO), STDIN_FILENO);
    return DepthStream::open(at("-"));
  };
  EXPECT_TRUE(has(input("").error().message, "standard input: found its end"));
  const std::string two = sentImages(lens_, 0, 2);
  const auto stream = valueOf(input(two + two.substr(0, 700)));
  double time = -1.0;
  expectNumber(*stream, lens_, 1, time);
  DepthFrame frame;
  EXPECT_EQ(valueOf(eventOf(*stream, frame)), DepthRead::kEnd);
  EXPECT_EQ(stream->counts().broken, 1);
  ::dup2(kept.get(), STDIN_FILENO);
}

TEST_F(DepthStreams, TheHeaderForCSendsTheSame) {
  std::optional<Client> sender;
  DepthLens lens = lens_;
  lens.distortion = {0.1, 0.02, 0.001, -0.001, 0.003, 0.0, 0.0, 0.0};
  const std::string whole = sentImages(lens, 3, 1);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const Descriptor reader(ends[0]), writer(ends[1]);
  lorica_lens c = {40, 30, 0.001, lens.focalX, lens.focalY, lens.centreX, lens.centreY, {}};
  std::ranges::copy(lens.distortion, c.distortion);
  ASSERT_EQ(lorica_send_depth(writer.get(), &c, 3 / 30.0, imageOf(lens, 3).data()), 0);
  std::string got(whole.size(), '\0');
  ASSERT_EQ(::read(reader.get(), got.data(), got.size()), std::ssize(got));
  EXPECT_EQ(got, whole);
}

struct Maker {
  const char* sender;
  int width, height;
  double focal;
  bool hole = false;  ///< in the first pixel
};
class Makers : public DepthStreams, public ::testing::WithParamInterface<Maker> {};

TEST_P(Makers, ASenderGivesWhatAStandInOfTheModuleShows) {
  const Maker& maker = GetParam();
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) GTEST_SKIP() << "numpy is absent";
  const std::string tree = test::sourceFile("").string(), log = folder_.path() / "log";
  int status = -1;
  std::thread program;
  const auto stream = valueOf(openWhile(at(socket_), [&] {
    (void)Client(socket_);  // it listens
    program = std::thread([&] {
      status =
          std::system(fmt::format("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='{0}/tests/capture/streams/makers' timeout "
                                  "120 /usr/bin/python3 '{0}/docs/samples/depth/{1}.py' '{2}' >'{3}' 2>&1",
                                  tree, maker.sender, socket_, log)
                          .c_str());
    });
  }));
  EXPECT_EQ(stream->camera().width, maker.width);
  EXPECT_EQ(stream->camera().height, maker.height);
  EXPECT_NEAR(stream->camera().focalX(), maker.focal, 1e-9);
  std::vector<std::uint16_t> expected;
  for (int row = 0; row < maker.height; ++row) {
    for (int column = 0; column < maker.width; ++column) {
      expected.push_back(static_cast<std::uint16_t>(1000 + 3 * row + 2 * column));
    }
  }
  if (maker.hole) expected[0] = 0;
  DepthFrame frame;
  frame.time = -1.0;
  int images = 0;
  for (double last = -1.0;; last = frame.time) {
    if (valueOf(eventOf(*stream, frame)) != DepthRead::kFrame) break;
    ++images;
    EXPECT_GT(frame.time, last);
    EXPECT_EQ(frame.depthMm, expected);
  }
  program.join();
  EXPECT_EQ(status, 0) << readFile(log).value();
  EXPECT_EQ(images + stream->counts().dropped, 5);
}

INSTANTIATE_TEST_SUITE_P(All, Makers,
                         ::testing::Values(Maker{"realsense", 848, 480, 425.0}, Maker{"orbbec", 640, 576, 505.0},
                                           Maker{"azure_kinect", 640, 576, 504.0}, Maker{"oak", 640, 400, 450.0},
                                           Maker{"iphone", 256, 192, 220.0, true}, Maker{"ros2", 320, 240, 290.0},
                                           Maker{"kinect_v1", 640, 480, 575.8}),
                         [](const auto& maker) { return std::string(maker.param.sender); });

}  // namespace
}  // namespace lorica
