#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "capture/sensor/oni_file.h"
#include "capture/tracking/depth_joints.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"
#include "viewer/player/run.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

/// What `live` would show of the recording.
std::vector<std::vector<std::uint8_t>> picturesOf(const std::filesystem::path& file) {
  std::unique_ptr<OniFile> depth = openOni(file).value();
  Tracker tracker = Tracker::create(depth->camera()).value();
  DepthJoints people(std::move(depth), std::move(tracker));
  std::vector<std::vector<std::uint8_t>> pictures;
  while (people.next().value()) {
    Image picture;
    drawDepthPicture(people.source().camera(), people.sight(), picture);
    pictures.push_back(std::move(picture.rgba));
  }
  return pictures;
}

/// A quick body of the mannequin.
void writeTwoParts(const std::filesystem::path& file) {
  const TriMesh mesh = makeMannequin().mesh;
  DecompositionFile content;
  content.decomposition =
      decompose(mesh, {mesh.vertices, static_cast<int>(mesh.vertices.size())}, {.maxParts = 2}).value();
  content.source = "mannequin";
  content.meshHash = topologyHash(mesh);
  content.errorPerKeyframe = {0.0};
  ASSERT_TRUE(writeDecomposition(file, content).ok());
}

TEST(RecordedDepth, EachFrameHasTheImageThatItWasTrackedIn) {
  const std::filesystem::path file = recordingsFolder() / "wave_depth.oni";
  Host host;
  CastRequest request;
  request.motion = file.string();
  const TemporaryFolder folder;
  request.body.decomposition = folder.path() / "body.lorica";
  writeTwoParts(request.body.decomposition);
  Result<Cast> cast = prepareCast(request, host);
  ASSERT_TRUE(cast) << cast.error().message;
  Result<std::unique_ptr<lorica::Run>> run = lorica::Run::start(std::move(*cast), {}, host);
  ASSERT_TRUE(run) << run.error().message;
  std::vector<std::vector<std::uint8_t>> pictures;
  Shown shown;
  shown.picture = [&]() -> Result<bool> {
    const Image* inset = (*run)->drawInset();
    pictures.push_back(inset == nullptr ? std::vector<std::uint8_t>() : inset->rgba);
    return true;
  };
  ASSERT_TRUE(play(**run, shown, host));
  const std::vector<std::vector<std::uint8_t>> expected = picturesOf(file);
  ASSERT_EQ(pictures.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_TRUE(pictures[i] == expected[i]) << i;
  EXPECT_TRUE(expected.front() != expected.back());
}

}  // namespace
}  // namespace lorica::test
