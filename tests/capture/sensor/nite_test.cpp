#include "capture/sensor/openni.h"

#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace lorica {
namespace {

namespace fs = std::filesystem;

const fs::path kTestDriver = test::built("tests/capture/sensor/libopenni_test_driver.so");

/// The NiTE 2 mock in its own folder, and the test driver's camera for it.
class NiteTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(setenv("LORICA_TEST_CAMERAS", plug_.path().c_str(), 1), 0);
    (void)plug_.write("a", "small");
    fs::create_directory(folder_.path() / "NiTE2");
    (void)folder_.write("NiTE2/data", "of NiTE 2");
    fs::copy_file(test::built("tests/capture/sensor/libnite_test_library.so"), library());
    std::shared_ptr<OpenNi> openNi = test::valueOf(OpenNi::start({{kTestDriver}, {}}));
    openNi_ = std::move(openNi);
  }
  [[nodiscard]] fs::path library() const { return folder_.path() / "libNiTE2.so"; }

  const test::TemporaryFolder plug_;
  const test::TemporaryFolder folder_;
  std::shared_ptr<OpenNi> openNi_;
};

TEST_F(NiteTest, JointsComeInMetresOverTheFloor) {
  const fs::path before = fs::current_path();
  std::unique_ptr<SkeletonSource> source = test::valueOf(makeNiteSource(openNi_, library()));
  EXPECT_EQ(fs::current_path(), before);
  std::vector<SkeletonFrame> frames;
  for (int i = 0; i < 10; ++i) {
    Result<std::optional<SkeletonFrame>> next = source->next();
    ASSERT_TRUE(next && *next);
    frames.push_back(**next);
    EXPECT_NEAR(frames.back().time, 0.1 * (i + 1), 1e-9);
  }
  for (const int nobody : {0, 1, 2}) {
    for (const TrackedJoint& joint : frames[std::size_t(nobody)].joints) EXPECT_EQ(joint.confidence, 0.0);
  }
  for (const int five : {3, 4, 5, 6, 7})
    EXPECT_EQ(frames[std::size_t(five)].user, 5) << "the first person stays selected";
  for (const int two : {8, 9}) EXPECT_EQ(frames[std::size_t(two)].user, 2);

  // Before the floor is known: 8 cm below the lower foot, the left one.
  const auto left = [](const SkeletonFrame& f) { return f[BodyJoint::kLeftFoot].position; };
  EXPECT_NEAR(left(frames[3]).y(), 0.08, 1e-6);
  EXPECT_NEAR(left(frames[3]).x(), -1.3, 1e-6);
  EXPECT_NEAR(left(frames[3]).z(), -2.0, 1e-6);
  EXPECT_NEAR(frames[3][BodyJoint::kHead].position.y() - left(frames[3]).y(), -0.65, 1e-6);

  // Afterwards: the camera 1 m above the floor, looking 0.1 rad down.
  const double c = std::cos(0.1);
  const double s = std::sin(0.1);
  for (int j = 0; j < kBodyJointCount; ++j) {
    const TrackedJoint& joint = frames[4].joints[std::size_t(j)];
    EXPECT_EQ(joint.confidence, j == 7 ? 0.0 : j == 6 ? 0.5 : 1.0);
    if (j == 7) continue;
    const Vec3 seen(-0.1 * j, 0.05 * j - 0.4, -2.0);
    const Vec3 expected(seen.x(), 1.0 + c * seen.y() + s * seen.z(), -s * seen.y() + c * seen.z());
    EXPECT_NEAR((joint.position - expected).norm(), 0.0, 1e-5) << nameOf(static_cast<BodyJoint>(j));
    ASSERT_EQ(joint.orientation.has_value(), j % 2 == 0);
    if (!joint.orientation) continue;
    // NiTE 2's rotation about (0.6, 0, 0.8) is one about (-0.6, 0, -0.8) here, followed by the camera's tilt.
    const Quat turn(Eigen::AngleAxisd(0.1, Vec3::UnitX()).inverse() *
                    Eigen::AngleAxisd(0.1 * j, Vec3(-0.6, 0.0, -0.8)));
    EXPECT_LT(joint.orientation->angularDistance(turn), 1e-5);
  }
}

TEST_F(NiteTest, WhatIsStartedIsEnded) {
  for (int i = 0; i < 3; ++i) {
    std::unique_ptr<SkeletonSource> source = test::valueOf(makeNiteSource(openNi_, library()));
    for (int k = 0; k < 7; ++k) ASSERT_TRUE(source->next());
  }
  void* handle = dlopen(library().c_str(), RTLD_NOW | RTLD_NOLOAD);
  ASSERT_NE(handle, nullptr);
  const int* calls = static_cast<const int*>(dlsym(handle, "niteTestCalls"));
  ASSERT_NE(calls, nullptr);
  EXPECT_EQ(calls[0], 3);
  for (int i = 0; i < 8; i += 2) EXPECT_EQ(calls[i], calls[i + 1]);
  EXPECT_EQ(calls[4], 21);
  EXPECT_EQ(calls[6], 6) << "each skeleton requested once";
}

TEST_F(NiteTest, AnUnpluggedCameraComesBack) {
  std::unique_ptr<SkeletonSource> source = test::valueOf(makeNiteSource(openNi_, library()));
  void* handle = dlopen(library().c_str(), RTLD_NOW | RTLD_NOLOAD);
  ASSERT_NE(handle, nullptr);
  const int* calls = static_cast<const int*>(dlsym(handle, "niteTestCalls"));
  int* silent = static_cast<int*>(dlsym(handle, "niteTestIsSilent"));
  ASSERT_TRUE(calls != nullptr && silent != nullptr);

  double last = -1.0;
  const auto personAt = [&](int maxFrames, bool wanted) {
    for (int i = 0; i < maxFrames; ++i) {
      const Result<std::optional<SkeletonFrame>> next = source->next();
      if (!next || !*next || !((*next)->time > last)) return false;
      last = (*next)->time;
      if (((**next)[BodyJoint::kHead].confidence > 0.0) == wanted) return true;
    }
    return false;
  };
  ASSERT_TRUE(personAt(5, true));
  *silent = 1;
  fs::remove(plug_.path() / "a");
  EXPECT_TRUE(personAt(5, false));
  for (int i = 0; i < 40 && calls[3] == 0; ++i) ASSERT_TRUE(personAt(1, false));
  EXPECT_EQ(calls[3], 1) << "the tracker of a missing camera is destroyed";
  EXPECT_EQ(calls[6], calls[7]);
  ASSERT_TRUE(personAt(1, false));
  EXPECT_EQ(calls[2], 1);

  *silent = 0;
  fs::rename(folder_.write("again", "small"), plug_.path() / "a");
  EXPECT_TRUE(personAt(60, true));
  EXPECT_EQ(calls[2], 2);
}

TEST_F(NiteTest, LibrariesThatAreNoneAreSentences) {
  const auto problem = [this](const fs::path& file, const std::string& uri = {}) {
    const Result<std::unique_ptr<SkeletonSource>> source = makeNiteSource(openNi_, file, uri);
    return source ? "it started" : source.error().message;
  };
  EXPECT_NE(problem(folder_.path() / "no.so").find("no such file"), std::string::npos);
  EXPECT_NE(problem(folder_.write("text.so", "a text")).find("cannot be loaded"), std::string::npos);
  EXPECT_NE(problem(kTestDriver).find("not a NiTE 2 library"), std::string::npos);
  EXPECT_NE(problem(library(), "test/none").find("test/none"), std::string::npos);
  fs::remove(folder_.path() / "NiTE2/data");
  EXPECT_NE(problem(library()).find("folder NiTE2"), std::string::npos) << problem(library());
}

}  // namespace
}  // namespace lorica
