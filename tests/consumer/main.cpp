// Uses the installed library from outside where docs/samples/ do not: steps a world, draws a label, and reads the
// installed recordings.

#include <lorica/capture/files/joint_csv.h>
#include <lorica/collision/world/world.h>
#include <lorica/viewer/pictures/image_files.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace {

int fail(const char* what) {
  std::fprintf(stderr, "consumer: %s\n", what);
  return 1;
}

}  // namespace

int main() {
  // A ball dropped from one metre lies on the floor after three seconds.
  lorica::World world;
  lorica::Prop ball;
  ball.shape = lorica::PropShape::kSphere;
  ball.worldFromProp.translation() = lorica::Vec3(0, 1, 0);
  world.addProp(ball);
  for (int frame = 0; frame < 90; ++frame) world.step({}, 1.0 / 30.0);
  const double height = world.props()[0].worldFromProp.translation().y();
  std::printf("ball rests at %.3f m\n", height);
  if (std::abs(height - 0.1) > 0.02) return fail("expected the ball to rest at its radius, 0.1 m");

  // Text needs a font that is installed.
  const std::vector<lorica::Image> picture(1, {64, 48, std::vector<std::uint8_t>(64 * 48 * 4, 255)});
  const std::vector<std::string> label = {"hull"};
  const lorica::Image sheet = lorica::contactSheet(picture, label, 1);
  std::size_t dark = 0;
  for (std::size_t i = 0; i < sheet.rgba.size(); i += 4) dark += sheet.rgba[i] < 128 ? 1 : 0;
  std::printf("%zu pixels of text\n", dark);
  if (dark < 20) return fail("expected a label under the picture");

  int recordings = 0;
  for (const auto& entry : std::filesystem::directory_iterator(LORICA_RECORDINGS_DIR)) {
    if (entry.path().extension() != ".csv") continue;
    const auto frames = lorica::readJointCsv(entry.path());
    if (!frames) return fail(frames.error().message.c_str());
    ++recordings;
  }
  std::printf("%d recordings installed\n", recordings);
  return recordings >= 6 ? 0 : fail("expected at least six recordings in " LORICA_RECORDINGS_DIR);
}
