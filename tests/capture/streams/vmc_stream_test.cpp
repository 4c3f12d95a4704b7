#include "capture/streams/vmc_stream.h"

#include "capture/retarget/bone_pose.h"
#include "capture/streams/vmc_receiver.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/capture/streams/vmc_packet.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

namespace lorica {
namespace {

using test::Packet;

/// Deviation of the steps between times from 1/60 s.
double unevenness(const std::vector<double>& times) {
  double sum = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) sum += std::abs(times[i] - times[i - 1] - 1.0 / 60.0);
  return sum / static_cast<double>(times.size() - 1);
}

TEST(FramePace, WithoutADelayEachFrameIsDueAtOnce) {
  FramePace pace(0.0);
  for (const double arrival : {0.0, 0.3, 0.301, 5.0}) EXPECT_EQ(pace.due(arrival), arrival);
  EXPECT_EQ(pace.late(), 0);
}

TEST(FramePace, ADelayMakesAnUnevenPaceEven) {
  RandomNumbers random(5);
  FramePace pace(0.05);
  std::vector<double> arrivals;
  std::vector<double> due;
  double cost = 0.0;
  for (int i = 0; i < 600; ++i) {
    const double arrival = i / 60.0 + random.between(0.0, 0.016);
    const double shown = pace.due(arrival);
    EXPECT_GE(shown, arrival);
    if (i < 120) continue;
    arrivals.push_back(arrival);
    due.push_back(shown);
    cost += (shown - arrival) / 480.0;
  }
  EXPECT_TRUE(std::is_sorted(due.begin(), due.end()));
  EXPECT_LT(unevenness(due), unevenness(arrivals) / 4.0);
  EXPECT_NEAR(cost, 0.05, 0.005);
  EXPECT_EQ(pace.late(), 0);
}

TEST(FramePace, FramesThatComeLaterThanTheDelayAreCounted) {
  FramePace pace(0.02);
  for (int i = 0; i < 100; ++i) (void)pace.due(i / 60.0 + (i % 10 == 9 ? 0.06 : 0.0));
  EXPECT_GE(pace.late(), 5);
  EXPECT_LE(pace.late(), 20);
}

TEST(FramePace, APauseBeginsAnew) {
  FramePace pace(0.05);
  for (int i = 0; i < 100; ++i) (void)pace.due(i / 60.0);
  EXPECT_NEAR(pace.due(10.0), 10.05, 1e-9);
}

TEST(WaitingFrames, TheOldestGivesWayToOneMoreThanTheLimit) {
  for (const std::size_t more : {0U, 1U}) {
    WaitingFrames waiting;
    FramePace pace(0.0);
    for (std::size_t i = 1; i <= kMaxWaitingFrames + more; ++i) {
      const double arrival = static_cast<double>(i) / 60.0;
      waiting.add(arrival, pace).time = arrival;
    }
    EXPECT_EQ(waiting.take().frame.time, static_cast<double>(1 + more) / 60.0);
    std::size_t left = 0;
    for (; waiting.due() < 1e9; ++left) (void)waiting.take();
    EXPECT_EQ(left + 1, kMaxWaitingFrames);
  }
}

/// A hundred thousand packets, as fast as they can be sent: one frame at a time waits for the session, and neither
/// side takes memory for more.
TEST(VmcStream, AFloodIsOneFrameForEachStep) {
  Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  ASSERT_TRUE(socket);
  const std::uint16_t port = socket->port();
  VmcStream stream(std::move(*socket));
  Result<UdpSocket> sender = UdpSocket::connect({"127.0.0.1", port});
  Result<UdpSocket> other = UdpSocket::connect({"127.0.0.1", port});
  ASSERT_TRUE(sender && other);
  Packet packet;
  packet.bundle().bone("Hips").weight("Joy", 1.0f).empty("/VMC/Ext/Blend/Apply");
  Packet small;
  small.bundle();
  BoneFrame frame;
  // Every place of the ring gets its memory; what a busy machine drops is sent again.
  int sent = 0;
  while (stream.counts().frames < 300) {
    sender->send(packet.bytes());
    ++sent;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_TRUE(stream.wait(100.0, frame));
  double last = frame.time;
  const std::int64_t before = test::allocationCount();
  int given = 0, waits = 0;
  for (int i = 0; i < 100000; ++i) {
    sender->send(packet.bytes());
    ++sent;
    if (i % 10 == 0) other->send(small.bytes());
    if (i % 1000 != 0) continue;
    ++waits;
    if (!stream.wait(0.0, frame)) continue;
    ++given;
    EXPECT_GT(frame.time - last, 1.0 / 240.0 - 1e-9) << "the world would run faster than the clock";
    last = frame.time;
  }
  const std::int64_t allocations = test::allocationCount() - before;
  EXPECT_EQ(waits, 100);
  EXPECT_LE(given, waits);
  // None; but where this thread is halted for half a second, the other sender is followed, with memory of its own.
  EXPECT_LT(allocations, waits);
  // All that is left is one frame, and then the one that is sent last; once more where a full socket dropped it.
  const std::vector<NamedWeight> theLast{{"Joy", 0.5f}};
  Packet end;
  end.bundle().bone("Hips").weight("Joy", 0.5f).empty("/VMC/Ext/Blend/Apply");
  frame.expressions.clear();
  while (frame.expressions != theLast) {
    sender->send(end.bytes());
    ++sent;
    while (frame.expressions != theLast && stream.wait(10.0, frame)) continue;
  }
  EXPECT_FALSE(stream.wait(0.0, frame));
  const VmcStream::Counts counts = stream.counts();
  EXPECT_LE(counts.packets, sent);
  EXPECT_GT(counts.packets, 100);
}

TEST(VmcStream, ADelayedFrameIsGivenWhenItIsDue) {
  Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  ASSERT_TRUE(socket);
  Result<UdpSocket> sender = UdpSocket::connect({"127.0.0.1", socket->port()});
  VmcStream stream(std::move(*socket), 0.2);
  ASSERT_TRUE(sender);
  sender->send(Packet().bundle().bone("Hips").bytes());
  BoneFrame frame;
  ASSERT_TRUE(stream.wait(100.0, frame));
  const std::optional<VmcStream::Given> given = stream.lastGiven();
  ASSERT_TRUE(given);
  EXPECT_NEAR(given->time - given->arrival, 0.2, 1e-9);
  EXPECT_EQ(frame.time, given->time);
  EXPECT_GE(stream.now(), given->time);
}

TEST(VmcFollower, NoiseKeepsNoSenderOut) {
  VmcFollower follower;
  Packet real;
  real.bundle().bone("Hips");
  const std::vector<std::byte> junk(1, std::byte{0});
  for (int i = 0; i < 20; ++i) {
    const double seconds = 0.1 * i;
    if (i % 3 == 0) follower.take(junk, 1, seconds);
    follower.take(real.bytes(), 2, seconds + 0.01);
  }
  // The real sender is followed after half a second: five packets too late, and then five of noise are others.
  EXPECT_EQ(follower.others(), 5 + 5);
  EXPECT_EQ(follower.packets(), 2 + 15);
}

/// What a program sends that sends its bones' own transforms.
BonePose rawPose(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  BonePose raw;
  for (std::size_t b = 0; b < raw.rotation.size(); ++b) {
    const JointIndex joint = skeleton.jointOf(static_cast<HumanBone>(b));
    if (joint == kNoJoint) continue;
    raw.rotation[b] = pose[static_cast<std::size_t>(joint)].rotation;
    raw.offset[b] = pose[static_cast<std::size_t>(joint)].translation;
  }
  return raw;
}

/// Worst difference of rotations [rad] and positions [m] of all bones.
double difference(const Skeleton& skeleton, const BonePose& a, const BonePose& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.rotation.size(); ++i) {
    if (skeleton.jointOf(static_cast<HumanBone>(i)) == kNoJoint) continue;
    worst = std::max(worst, a.rotation[i]->angularDistance(*b.rotation[i]));
    worst = std::max(worst, (a.offset[i] - b.offset[i]).norm());
  }
  return worst;
}

TEST(SenderRest, RawTransformsOfCrookedBonesBecomeThoseFromTheTpose) {
  RandomNumbers random(11);
  test::FigureSettings crooked;
  crooked.crookedAxes = true;
  crooked.armsDown = test::degrees(50.0);
  for (const Skeleton& skeleton : {test::makeFigure(crooked).skeleton, makeMannequin().skeleton}) {
    const Result<SenderRest> rest = SenderRest::create(skeleton);
    Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
    ASSERT_TRUE(rest && reader);
    for (int i = 0; i < 20; ++i) {
      Pose pose = restPose(skeleton);
      for (std::size_t j = 0; j < pose.size(); ++j) {
        if (!skeleton.joint(static_cast<JointIndex>(j)).bone || i == 0) continue;
        Vec3 axis;
        for (double& value : axis) value = random.between(-1.0, 1.0);
        const double angle = random.between(-2.0, 2.0);
        pose[j].rotation = pose[j].rotation * Quat(Eigen::AngleAxisd(angle, axis.normalized()));
      }
      BonePose sent = rawPose(skeleton, pose);
      rest->apply(sent);
      EXPECT_LT(difference(skeleton, sent, reader->read(pose)), 1e-6) << i;
    }
  }
}

TEST(SenderRest, ProportionsThatAreNotSentAreTheModels) {
  const Skeleton skeleton = makeMannequin().skeleton;
  const Result<SenderRest> rest = SenderRest::create(skeleton);
  Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
  ASSERT_TRUE(rest && reader);
  BonePose sent = rawPose(skeleton, restPose(skeleton));
  sent.offset.fill(Vec3::Zero());
  rest->apply(sent);
  EXPECT_LT(difference(skeleton, sent, reader->read(restPose(skeleton))), 1e-6);
}

}  // namespace
}  // namespace lorica
