#include "capture/tracking/depth_joints.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/registration/wandering_walk.h"
#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/vr/headsets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

/// What a display shows: an XWD file with 32 bits a pixel, blue first, whose header is in the other order of bytes.
Image readDisplay(const std::filesystem::path& folder) {
  std::ifstream file(folder / "Xvfb_screen0", std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto byte = [&](std::size_t at) { return std::uint8_t(bytes[at]); };
  const auto header = [&](std::size_t word) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < 4; ++i) number = number << 8 | byte(4 * word + i);
    return number;
  };
  Image image;
  if (bytes.size() < 100) return image;
  const std::size_t pixels = header(0) + 12 * header(19), line = header(12);
  image.width = int(header(4));
  image.height = int(header(5));
  image.rgba.resize(image.byteCount());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t at = pixels + y * line + 4 * std::size_t(x);
      const std::array<std::uint8_t, 4> rgba = {byte(at + 2), byte(at + 1), byte(at), 255};
      std::copy(rgba.begin(), rgba.end(), image.pixel(x, y));
    }
  }
  return image;
}

double decoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
double encoded(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

/// Pixels of an image: the first and the one after the last, in both directions.
struct Area {
  int left = 1 << 20, top = 1 << 20, right = 0, bottom = 0;
  void add(int x, int y) {
    left = std::min(left, x);
    right = std::max(right, x + 1);
    top = std::min(top, y);
    bottom = std::max(bottom, y + 1);
  }
};

// Monado's window has the picture of the left eye in its left half and that of the right one in its right half.
TEST_F(Headsets, TheRuntimesOwnWindowShowsThePanelWhereItIs) {
  openUnseen();
  // Before a plain background, and at rest.
  const auto rest = [&] {
    Choices& choices = window->choices();
    choices.paused = true;
    choices.steps = 1;
    choices.quality = 0;
    choices.show.background = Vec3f(0.0f, 1.0f, 0.0f);
    choices.show.ground = false;
  };
  rest();
  // Of its own window: 85 degrees across half of a display of 13 by 7 cm.
  const double wide = std::tan(42.5 * EIGEN_PI / 180.0), high = wide * 0.07 / 0.065;
  told.angles = {-std::atan(wide), std::atan(wide), std::atan(high), -std::atan(high)};
  const auto press = [&](bool down) { told.opens[1] = down; };
  playUntil([&] {
    press(arrived() && !window->panel().isOpen());
    return arrived() && window->panel().isOpen();
  });
  // A panel that was drawn for one headset is drawn again for the next one.
  endService();
  playUntil([&] { return window->headset() == nullptr; });
  TemporaryFolder folder;
  const VirtualDisplay display(folder.path().string());
  ASSERT_TRUE(display.ready());
  ASSERT_NO_FATAL_FAILURE(startService(display.name()));
  constexpr int kShown = 10;   // pictures after which a picture is on the display
  std::array<Image, 2> shown;  // without the panel, with it
  std::array<HeadsetEye, 2> eyes;
  HeadsetPanel panel;
  int pictures = 0;
  rest();
  playUntil([&] {
    if (!arrived()) return false;
    if (++pictures == kShown) shown[0] = readDisplay(folder.path());
    const bool open = window->panel().isOpen();
    press(pictures >= kShown && !open);
    if (!open) pictures = std::min(pictures, kShown);
    if (pictures < 2 * kShown) return false;
    shown[1] = readDisplay(folder.path());
    panel = window->panel();
    eyes = frame().eyes;
    return true;
  });
  if (HasFailure()) return;
  if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
    EXPECT_TRUE(writePng(std::string(to) + "/compositor.png", shown[0]));
    EXPECT_TRUE(writePng(std::string(to) + "/compositor_panel.png", shown[1]));
  }

  Area all;
  std::array<Area, 2> changed;
  const auto brightest = [](const std::array<int, 3>& rgb) { return std::max({rgb[0], rgb[1], rgb[2]}); };
  const auto rgbOf = [](Image& image, int x, int y) {
    const std::uint8_t* pixel = image.pixel(x, y);
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  for (int y = 0; y < shown[0].height; ++y) {
    for (int x = 0; x < shown[0].width; ++x) {
      if (brightest(rgbOf(shown[0], x, y)) > 0) all.add(x, y);
    }
  }
  const int width = (all.right - all.left) / 2, height = all.bottom - all.top;
  ASSERT_GT(width, 100) << "the window is not there";
  constexpr int kEdge = 4;  // of the window, which is drawn another way with a panel
  for (int y = all.top + kEdge; y < all.bottom - kEdge; ++y) {
    for (int x = all.left + kEdge; x < all.right - kEdge; ++x) {
      const std::array<int, 3> before = rgbOf(shown[0], x, y), after = rgbOf(shown[1], x, y);
      int most = 0;
      for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(after[c] - before[c]));
      if (most > 24) changed[x < all.left + width ? 0 : 1].add(x, y);
    }
  }
  Image text = panel.image();
  for (const int eye : {0, 1}) {
    // Where its corners and its pixels are by the pinhole of the eye.
    const Isometry3 eyeFromPanel = eyes[eye].stageFromEye.inverse() * panel.stageFromPanel();
    const auto seenAt = [&](double x, double y) -> Eigen::Vector2d {
      const Vec3 at = eyeFromPanel * Vec3((x - 0.5) * panel.width(), (0.5 - y) * panel.height(), 0.0);
      return {all.left + width * (eye + 0.5 - 0.5 * at.x() / at.z() / wide),
              all.top + height * (0.5 + 0.5 * at.y() / at.z() / high)};
    };
    const Eigen::Vector2d first = seenAt(0.0, 0.0), last = seenAt(1.0, 1.0);
    const Area& found = changed[eye];
    std::printf("eye %d: the panel is at %d to %d, %d to %d; calculated %.1f to %.1f, %.1f to %.1f\n", eye, found.left,
                found.right, found.top, found.bottom, first.x(), last.x(), first.y(), last.y());
    EXPECT_NEAR(found.left, first.x(), 2.0);
    EXPECT_NEAR(found.right, last.x(), 2.0);
    EXPECT_NEAR(found.top, first.y(), 2.0);
    EXPECT_NEAR(found.bottom, last.y(), 2.0);
    // What is on it, over the scene.
    double off = 0.0, changes = 0.0;
    int count = 0;
    for (int y = found.top + 2; y + 2 < found.bottom; ++y) {
      for (int x = found.left + 2; x + 2 < found.right; ++x) {
        const double u = (x + 0.5 - first.x()) / (last.x() - first.x()),
                     v = (y + 0.5 - first.y()) / (last.y() - first.y());
        const std::uint8_t* own = text.pixel(std::clamp(int(u * text.width), 0, text.width - 1),
                                             std::clamp(int(v * text.height), 0, text.height - 1));
        const std::array<int, 3> before = rgbOf(shown[0], x, y), after = rgbOf(shown[1], x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          const double light = decoded(own[c] / 255.0) + (1.0 - own[3] / 255.0) * decoded(before[c] / 255.0);
          off += std::abs(255.0 * encoded(std::min(light, 1.0)) - after[c]);
          changes += std::abs(before[c] - after[c]);
          ++count;
        }
      }
    }
    std::printf("eye %d: off by %.1f of 255 in the mean, where the panel changes %.1f\n", eye, off / count,
                changes / count);
    EXPECT_LT(off / count, 0.5 * changes / count);
  }
}

constexpr double kPi = std::numbers::pi;
constexpr double kRate = 10.0;                            // images of the camera in a second of the walk
constexpr double kSlowest = 0.1;                          // between poses of a headset, for a registration [s]
constexpr std::size_t kStands = 10, kStandsAtMost = 100;  // images, with a headset that is registered and without
constexpr double kNear = 0.04;                            // [m]
constexpr int kWalkPatience = 3000;                       // pictures
const Vec3 kHeadInHeadset(0.0, -0.11, 0.1);

/// Images of a virtual camera, each of which comes when it is released: so the walk goes at the speed of the pictures.
/// The last one is repeated. It waits as long as that takes: a camera that says that nothing came, says that nobody is
/// seen.
class ReleasedImages final : public DepthSource {
 public:
  explicit ReleasedImages(std::vector<DepthFrame> images) : images_(std::move(images)) {}
  [[nodiscard]] const DepthCamera& camera() const override { return camera_; }
  [[nodiscard]] std::string name() const override { return "a walk"; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override {
    while (given_ >= released && !over) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (over) return DepthRead::kEnd;
    frame = images_[std::min(given_, images_.size() - 1)];
    frame.time = static_cast<double>(given_++) / kRate;
    return DepthRead::kFrame;
  }

  std::atomic<std::size_t> released = 0;
  std::atomic<bool> over = false;

 private:
  DepthCamera camera_;
  std::vector<DepthFrame> images_;
  std::size_t given_ = 0;
};

TEST_F(Headsets, AWalkBeforeADepthCameraRegistersTheHeadset) {
  // Somebody walks, and the camera sees them.
  std::vector<VirtualPerson> people;
  people.push_back({valueOf(VirtualPerformer::create(makeMannequin(), wanderingWalk(8.0, 1)))});
  people[0].worldFromMotion.translation().z() = 0.3;
  VirtualSensorSettings settings;
  settings.framesPerSecond = kRate;
  VirtualSensor sensor = valueOf(VirtualSensor::create(std::move(people), settings));
  std::vector<DepthFrame> images(sensor.frameCount());
  std::vector<SkeletonFrame> truth;
  for (std::size_t i = 0; i < images.size(); ++i) {
    sensor.render(i, images[i]);
    truth.push_back(moved(sensor.truth()[0].joints, sensor.floorFromCamera()));
  }
  // The headset counts from elsewhere.
  Registration known;
  known.yaw = 0.8;
  known.translation = {1.3, 0.0, -0.7};
  const auto wear = [&](std::size_t image) {
    const TrackedJoint& head = truth[std::min(image, truth.size() - 1)][BodyJoint::kHead];
    const Quat floorFromHeadset = *head.orientation * Quat(Eigen::AngleAxisd(kPi, Vec3::UnitY()));
    const Vec3 eyes = head.position - floorFromHeadset * kHeadInHeadset;
    const Isometry3 stageFromFloor = known.stageFromFloor();
    told.head = {stageFromFloor * eyes, Quat(Mat3(stageFromFloor.linear() * floorFromHeadset.toRotationMatrix()))};
  };

  auto walk = std::make_unique<ReleasedImages>(std::move(images));
  ReleasedImages& camera = *walk;
  auto sources = std::make_shared<LiveSources>();
  DepthJoints tracking(std::move(walk), valueOf(Tracker::create(camera.camera())));
  sources->headset = std::make_shared<WornHeadset>();
  tracking.wear(sources->headset);
  auto joints = std::make_unique<LiveJoints>(std::move(tracking));
  sources->tracked = joints.get();
  sources->name = joints->source().name();
  sources->joints.push_back(std::move(joints));
  const std::shared_ptr<ReleasedImages> atEnd(&camera, [](ReleasedImages* it) { it->over = true; });
  LiveRequest live;
  live.headset = true;
  run = valueOf(lorica::Run::start(valueOf(prepareLiveCast(request(), live, host, sources)), {}, host));
  Choices& choices = window->choices();
  choices.inside = true;
  choices.quality = 0;

  // They take a step when the headset was where they are, and the image of that was tracked. At last they stand.
  std::size_t step = 0;
  double begun = 0.0, last = 0.0;
  std::vector<double> intervals;
  wear(0);
  playUntil(
      [&] {
        if (window->headset() == nullptr || !frame().located) return false;
        if (begun == 0.0) begun = last = frame().time;
        intervals.push_back(frame().time - std::exchange(last, frame().time));
        if (!arrived()) return false;
        if (camera.released == step) {
          camera.released = step + 1;
          return false;
        }
        if (run->sight()->image.time < static_cast<double>(step) / kRate) return false;
        if (step >= truth.size() + (run->sight()->worn ? kStands : kStandsAtMost)) return true;
        wear(++step);
        return false;
      },
      kWalkPatience);
  std::sort(intervals.begin(), intervals.end());
  const double usual = intervals[intervals.size() / 2], slow = intervals[intervals.size() * 9 / 10];
  std::printf("%zu images in %.1f s, a pose each %.0f ms, one of ten later than %.0f ms\n", step + 1, last - begun,
              1e3 * usual, 1e3 * slow);
  // Late poses are gaps, and each leaves out the images of the next 0.2 s.
  if (!sources->headset->registration() && slow > kSlowest) {
    GTEST_SKIP() << "this machine is too slow: a registration needs ten pictures a second";
  }
  ASSERT_TRUE(sources->headset->registration());
  const Registration found = *sources->headset->registration();
  const Vec3 level = (found.stageFromFloor().inverse() * known.stageFromFloor()).translation();
  std::printf("yaw off by %.2f degrees, floor by %.0f mm, lag %.0f ms\n", (found.yaw - known.yaw) * 180.0 / kPi,
              1e3 * level.norm(), 1e3 * found.lag);
  EXPECT_NEAR(found.yaw, known.yaw, kPi / 180.0);
  EXPECT_LT(level.norm(), 0.05);

  // The avatar stands where they do, and their eyes are in its head. The camera sees them with the headset.
  const SessionAvatar& avatar = run->session.avatar();
  const DepthSight& sight = *run->sight();
  const auto jointAt = [&](HumanBone bone) -> Vec3 {
    return avatar.worldFromJoint()[avatar.character().skeleton.jointOf(bone)].translation();
  };
  const auto middleOf = [](const Vec3& a, const Vec3& b) { return Vec3(0.5 * (a + b)); };
  const SkeletonFrame& person = truth.back();
  const Vec3 worn = found.headInFloor(frame().stageFromHead.translation(), Quat(frame().stageFromHead.linear()));
  const Vec3 head = jointAt(HumanBone::kHead) + sight.stage;
  const Vec3 hips = middleOf(jointAt(HumanBone::kLeftUpperLeg), jointAt(HumanBone::kRightUpperLeg)) + sight.stage;
  const Vec3 inEyes = window->place().worldFromStage() * (frame().stageFromHead * found.headInHeadset);
  const double headOff = (head - person[BodyJoint::kHead].position).norm();
  const double hipsOff =
      (hips - middleOf(person[BodyJoint::kLeftHip].position, person[BodyJoint::kRightHip].position)).norm();
  std::printf("head from the headset by %.0f mm, from the true one by %.0f mm; hips from the true ones by %.0f mm\n",
              1e3 * (head - worn).norm(), 1e3 * headOff, 1e3 * hipsOff);
  EXPECT_LT((head - worn).norm(), kNear);
  EXPECT_LT(headOff, kNear);
  EXPECT_LT(hipsOff, kNear);
  EXPECT_LT((jointAt(HumanBone::kHead) - inEyes).norm(), 1e-3);
  if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
    EXPECT_TRUE(writePng(std::string(to) + "/walked.png", window->headset()->picture(0)));
  }
}

}  // namespace
}  // namespace lorica::test
