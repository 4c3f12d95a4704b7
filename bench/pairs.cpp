// Every character performs every motion: one CSV row for each pair, and contact sheets of three moments of each, with
// and without hulls.

#include "bench/measure.h"
#include "capture/files/bvh_file.h"
#include "capture/files/joint_stream.h"
#include "capture/retarget/proxy_skeleton.h"
#include "collision/live/live_body.h"
#include "geometry/files.h"
#include "prepare/decomposition_cache.h"
#include "prepare/motion.h"
#include "prepare/training.h"
#include "skinning/body/closed_body.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/edge_stretch.h"
#include "viewer/pictures/image_files.h"
#include "viewer/renderer/renderer.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kMoments = 3;
constexpr int kWidth = 128;
constexpr int kHeight = 160;
constexpr int kColumns = 4 * kMoments;
constexpr int kSampledFrames = 300;  // of each motion, at even intervals

struct Options {
  std::vector<std::string> characters;
  std::vector<std::string> motions;
  std::string sheets;
};

Result<Motion> readMotion(const fs::path& file) {
  Motion motion;
  motion.name = file.stem().string();
  if (file.extension() == ".bvh") {
    Result<BvhFile> read = readBvh(file);
    if (!read) return read.error();
    motion.bones = std::move(read->motion);
    return motion;
  }
  if (isCharacterFile(file)) {
    Result<CharacterFile> read = readCharacterFile(file);
    if (!read) return read.error();
    if (read->clips.empty()) return Error{ErrorCode::kNotFound, file.string() + ": no clips"};
    LORICA_TRY(motion.bones, framesOf(read->character.skeleton, read->clips.front()));
    motion.fromCharacterFile = true;
    return motion;
  }
  Result<JointStream> stream = readJointStream(file, {});
  if (!stream) return stream.error();
  motion.joints = std::move(stream->frames);
  return motion;
}

/// A character with its body and its parts, trained as by `lorica play`.
struct Performer {
  Character character;
  Decomposition decomposition;
};

Result<Performer> readPerformer(const std::string& file, const std::vector<Motion>& usual) {
  Performer performer{makeMannequin(), {}};
  std::vector<Clip> clips;
  if (file != "mannequin") {
    Result<CharacterFile> read = readCharacterFile(file);
    if (!read) return read.error();
    Result<ClosedBody> body = makeBody(read->character);
    if (!body) return body.error();
    performer.character = std::move(body->character);
    clips = std::move(read->clips);
  }
  const Result<Training> training = trainingMotions(performer.character, {}, clips, [&] { return Result(usual); });
  if (!training) return training.error();
  Result<CachedDecomposition> made = defaultDecomposition(performer.character, *training, {}, {userCacheFolder()});
  if (!made) return made.error();
  performer.decomposition = std::move(made->file.decomposition);
  return performer;
}

/// The visible vertices that move with the feet, wherever the feet hang; with the legs if these have no feet.
std::vector<VertexIndex> verticesOfFeet(const Character& character) {
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  if (!proxy) return {};
  const Skeleton& whole = proxy->skeleton();
  const auto isBelowOrSame = [&](JointIndex joint, JointIndex above) {
    while (joint != kNoJoint && joint != above) joint = whole.joint(joint).parent;
    return joint == above;
  };
  std::vector<VertexIndex> vertices;
  for (const auto& [left, right] : {std::pair(HumanBone::kLeftFoot, HumanBone::kRightFoot),
                                    std::pair(HumanBone::kLeftUpperLeg, HumanBone::kRightUpperLeg)}) {
    for (const Triangle& t : character.shown.empty() ? character.mesh.triangles : character.shown) {
      for (const VertexIndex v : t) {
        const JointIndex joint = proxy->proxyOf(test::mainJoint(character, v));
        if (isBelowOrSame(joint, whole.jointOf(left)) || isBelowOrSame(joint, whole.jointOf(right))) {
          vertices.push_back(v);
        }
      }
    }
    if (!vertices.empty()) break;
  }
  return vertices;
}

/// A character in one frame.
class Figure {
 public:
  explicit Figure(const Performer& performer)
      : character_(performer.character),
        body_(*LiveBody::create(performer.decomposition, performer.character)),
        worldFromJoint_(character_.jointFromModel.size()),
        worldFromModel_(character_.jointFromModel.size()),
        posed_(character_.mesh.vertices.size()),
        feet_(verticesOfFeet(character_)) {}

  void pose(std::span<const JointTransform> pose, bool withHulls) {
    computeWorldFromJoint(character_.skeleton, pose, worldFromJoint_);
    computeWorldFromModel(character_, worldFromJoint_, worldFromModel_);
    skinLinearBlend(character_, worldFromModel_, posed_);
    if (withHulls) body_.update(worldFromModel_);
  }
  [[nodiscard]] std::span<const Triangle> triangles() const {
    return character_.shown.empty() ? character_.mesh.triangles : character_.shown;
  }
  [[nodiscard]] std::span<const Vec3> posed() const { return posed_; }
  [[nodiscard]] const LiveBody& body() const { return body_; }
  /// Of its bounding box [m].
  [[nodiscard]] Vec3 middle() const {
    const Aabb box = boundsOf(posed_);
    return 0.5 * (box.min + box.max);
  }
  /// Height of the feet's lowest vertex [m].
  [[nodiscard]] double lowest() const {
    double lowest = 1e300;
    for (const VertexIndex v : feet_) lowest = std::min(lowest, posed_[v].y());
    return lowest;
  }
  [[nodiscard]] double hullVolume() const {
    double volume = 0.0;
    for (const LivePart& part : body_.parts()) volume += part.shape.volume;
    return volume;
  }

 private:
  const Character& character_;
  LiveBody body_;
  std::vector<Affine3> worldFromJoint_;
  std::vector<Affine3> worldFromModel_;
  std::vector<Vec3> posed_;
  std::vector<VertexIndex> feet_;
};

struct Pictures {
  Renderer& renderer;
  std::array<std::vector<Image>, 2> images;  ///< without and with hulls
  std::vector<std::string> labels;

  void add(const Figure& figure, double height, const std::string& label) {
    Camera camera;
    camera.target = figure.middle();
    camera.target.y() = 0.5 * height;
    camera.eye = camera.target + 2.4 * height * Vec3(0.62, 0.12, 0.78).normalized();
    Scene scene;
    scene.vertices = figure.posed();
    scene.triangles = figure.triangles();
    scene.parts = figure.body().parts();
    for (const bool hulls : {false, true}) {
      SceneOptions show;
      show.hulls = hulls;
      show.skin = !hulls;
      renderer.draw(scene, show, camera, kWidth, kHeight);
      images[hulls ? 1 : 0].push_back(renderer.readBack());
    }
    labels.push_back(label);
  }
};

/// Measures one pair, and adds its pictures.
Result<void> perform(const Performer& performer, const Motion& motion, Figure& figure, Pictures* pictures) {
  const Character& character = performer.character;
  const Result<SkeletalMotion> performed = performedBy(character, motion);
  if (!performed) return performed.error();
  const auto joints = static_cast<std::size_t>(character.skeleton.jointCount());
  const auto poseOf = [&](int frame) {
    return std::span(performed->poses).subspan(static_cast<std::size_t>(frame) * joints, joints);
  };
  figure.pose(restPose(character.skeleton), true);
  const double restVolume = figure.hullVolume();
  const double restLowest = figure.lowest() / character.height;
  const test::EdgeStretch edges(character);
  test::EdgeStretch::Worst stretch;
  std::vector<double> lowest;
  std::array<double, 2> volume = {1e300, 0.0};
  const int frames = performed->frameCount();
  const int step = std::max(1, frames / kSampledFrames);
  for (int frame = 0; frame < frames; frame += step) {
    const bool withHulls = (frame / step) % 10 == 0;
    figure.pose(poseOf(frame), withHulls);
    lowest.push_back(figure.lowest() / character.height);
    if (const auto worst = edges.in(figure.posed()); worst.stretch > stretch.stretch) stretch = worst;
    if (!withHulls) continue;
    volume[0] = std::min(volume[0], figure.hullVolume() / restVolume);
    volume[1] = std::max(volume[1], figure.hullVolume() / restVolume);
  }
  for (int moment = 0; moment < kMoments && pictures != nullptr; ++moment) {
    figure.pose(poseOf((2 * moment + 1) * frames / (2 * kMoments)), true);
    pictures->add(figure, character.height, motion.name.substr(0, 12));
  }
  std::sort(lowest.begin(), lowest.end());
  const auto percent = [&](double share) {
    return 100.0 * lowest[static_cast<std::size_t>(share * static_cast<double>(lowest.size() - 1))];
  };
  const auto jointAt = [&](VertexIndex v) { return character.skeleton.joint(test::mainJoint(character, v)).name; };
  fmt::print("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{},{}\n", character.name, motion.name,
             100.0 * restLowest, percent(0.0), percent(0.5), percent(1.0), volume[0], volume[1], stretch.stretch,
             jointAt(stretch.a), jointAt(stretch.b));
  return {};
}

int run(const Options& options) {
  std::vector<Motion> motions;
  std::vector<Motion> usual;
  for (const std::string& file : options.motions) {
    Result<Motion> motion = readMotion(file);
    if (!motion) {
      fmt::print(stderr, "{}\n", motion.error().message);
      return 1;
    }
    if (fs::path(file).extension() == ".csv") usual.push_back(*motion);
    motions.push_back(std::move(*motion));
  }
  std::optional<OffscreenContext> context;
  std::optional<Renderer> renderer;
  if (!options.sheets.empty()) {
    Result<OffscreenContext> made = OffscreenContext::create();
    if (!made) return fmt::print(stderr, "{}\n", made.error().message), 1;
    context.emplace(std::move(*made));
    renderer.emplace(*Renderer::create(context->getProc()));
    fs::create_directories(options.sheets);
  }
  fmt::print(
      "character,motion,rest_lowest_percent,lowest_percent,lowest_median_percent,lowest_max_percent,volume_min,volume_"
      "max,"
      "stretch,stretch_from,stretch_to\n");
  int failed = 0;
  for (const std::string& file : options.characters) {
    const Result<Performer> performer = readPerformer(file, usual);
    if (!performer) {
      fmt::print(stderr, "{}\n", performer.error().message);
      ++failed;
      continue;
    }
    Figure figure(*performer);
    std::optional<Pictures> pictures;
    if (renderer) pictures.emplace(Pictures{*renderer, {}, {}});
    for (const Motion& motion : motions) {
      const Result<void> done = perform(*performer, motion, figure, pictures ? &*pictures : nullptr);
      if (done) continue;
      fmt::print(stderr, "{}\n", done.error().message);
      ++failed;
    }
    std::fflush(stdout);
    if (!pictures || pictures->labels.empty()) continue;
    for (const bool hulls : {false, true}) {
      const fs::path sheet =
          fs::path(options.sheets) / fmt::format("{}{}.png", fs::path(file).stem().string(), hulls ? "_hulls" : "");
      const Image image = contactSheet(pictures->images[hulls ? 1 : 0], pictures->labels, kColumns);
      if (Result<void> written = writePng(sheet, image); !written) return 1;
    }
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Every character performs every motion: figures and contact sheets.");
  app.add_option("--characters", options.characters, "Character files, or mannequin")->required();
  app.add_option("--motions", options.motions, "Motions: .csv, .txt, .bvh, or a character's first clip")->required();
  app.add_option("--sheets", options.sheets, "Write contact sheets to this folder");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
