#include "viewer/player/snapshots.h"

#include "collision/live/attached_vertices.h"
#include "collision/particles/particles.h"
#include "geometry/errors.h"
#include "skinning/linear_blend.h"
#include "skinning/look/avatar.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/parts_picture.h"
#include "viewer/player/window_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

constexpr double kFilmRate = 30.0;      // [1/s]
constexpr double kFilmEarly = 0.5;      // tolerance in frames: frame times of recordings jitter
constexpr double kLongestStill = 10.0;  // longer gaps in a recording are shortened [s]
constexpr std::string_view kPictureName = "frame_";

std::string pictureName(int frame) {
  return fmt::format("{}{:04}.png", kPictureName, frame);
}

}  // namespace

void AvatarFade::update(const Session& session) {
  const int last = std::exchange(frame_, session.frameCount());
  const double seconds = std::max(session.time() - std::exchange(time_, session.time()), 0.0);
  if (frame_ == last) return;
  const bool first = last == 0 || frame_ < last;
  visible_.resize(session.avatars().size(), 0.0);
  for (std::size_t a = 0; a < visible_.size(); ++a) {
    const bool present = session.avatars()[a].present();
    const double change = first ? 1.0 : seconds / kSeconds;
    visible_[a] = std::clamp(visible_[a] + (present ? change : -change), 0.0, 1.0);
  }
}

double AvatarFade::of(const Session& session, std::size_t avatar) const {
  if (avatar < visible_.size()) return visible_[avatar];
  return session.avatars()[avatar].present() ? 1.0 : 0.0;
}

SceneOptions usualView(const Character& character) {
  SceneOptions show;
  show.colorSkinByPart = show.hulls = character.avatar == nullptr || character.avatar->plain;
  return show;
}

SessionScene::SessionScene(const Session& session) {
  for (const SessionAvatar& avatar : session.avatars()) drawn_.push_back(drawnOf(avatar));
}

SessionScene::Drawn SessionScene::drawnOf(const SessionAvatar& avatar) {
  Drawn drawn;
  const Character& character = avatar.character();
  if (character.avatar != nullptr) drawn.face = SessionFace::of(character.avatar);
  const Decomposition& decomposition = avatar.body().decomposition();
  drawn.colors = colorsOfParts(decomposition, character);
  if (!character.shown.empty()) {
    drawn.triangles = character.shown;
    std::vector<PartIndex> partOfVertex(character.mesh.vertices.size(), drawn.colors.front());
    const std::vector<std::vector<PointIndex>> attached =
        attachedVerticesOf(decomposition, liftPoints(character, decomposition));
    for (std::size_t p = 0; p < attached.size(); ++p) {
      for (const PointIndex v : attached[p]) partOfVertex[v] = drawn.colors[p];
    }
    drawn.partOfTriangle.reserve(drawn.triangles.size());
    for (const Triangle& t : drawn.triangles) drawn.partOfTriangle.push_back(partOfVertex[t[0]]);
    return drawn;
  }
  for (std::size_t p = 0; p < decomposition.parts.size(); ++p) {
    const Part& part = decomposition.parts[p];
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      if (part.sourceTriangle[t] < 0) continue;  // a cap is inside the body
      drawn.triangles.push_back(part.triangles[t]);
      drawn.partOfTriangle.push_back(drawn.colors[p]);
    }
  }
  return drawn;
}

SceneFigure SessionScene::figureOf(Drawn& drawn, const SessionAvatar& avatar, double time, const SceneOptions& show,
                                   const Vec3& watcher) {
  SceneFigure figure;
  figure.avatar = avatar.character().avatar;
  if (figure.avatar == nullptr || (show.skin && show.colorSkinByPart)) {
    figure.vertices = avatar.points();
    figure.triangles = drawn.triangles;
    figure.partOfTriangle = drawn.partOfTriangle;
  }
  const Character& character = figure.avatar != nullptr ? figure.avatar->character : avatar.character();
  drawn.worldFromModel.resize(character.jointFromModel.size());
  computeWorldFromModel(character, avatar.worldFromJoint(), drawn.worldFromModel);
  if (drawn.face) drawn.face->update(avatar, time, watcher, drawn.worldFromModel, figure);
  figure.worldFromModel = drawn.worldFromModel;
  figure.parts = avatar.body().parts();
  figure.colors = drawn.colors;
  figure.skeleton = &avatar.character().skeleton;
  figure.worldFromJoint = avatar.worldFromJoint();
  return figure;
}

Scene SessionScene::of(const Session& session, const SceneOptions& show, const Vec3& watcher) const {
  Scene scene;
  others_.clear();
  bool first = true;
  for (std::size_t a = 0; a < drawn_.size(); ++a) {
    const SessionAvatar& avatar = session.avatars()[a];
    const double opacity = fade_.of(session, a);
    if (opacity <= 0.0) continue;
    SceneFigure figure = figureOf(drawn_[a], avatar, session.time(), show, watcher);
    figure.number = static_cast<int>(a);
    figure.opacity = opacity;
    if (first) {
      static_cast<SceneFigure&>(scene) = figure;
    } else {
      others_.push_back(figure);
    }
    first = false;
  }
  scene.others = others_;
  scene.time = session.time();
  scene.props = session.world().props();
  scene.contacts = session.world().contacts();
  if (const Particles* particles = session.world().particles()) {
    scene.particles = particles->positions();
    scene.particleRadius = particles->settings().radius;
    scene.particleColor = particles->settings().color;
    scene.water = particles->settings().kind == ParticleSettings::Kind::kWater;
    scene.particleVelocities = particles->velocities();
  }
  return scene;
}

SnapshotCamera::SnapshotCamera(OffscreenContext context, Renderer renderer, int width, int height)
    : context_(std::move(context)),
      renderer_(std::move(renderer)),
      rendererName_(context_.description()),
      width_(width),
      height_(height) {}

Result<SnapshotCamera> SnapshotCamera::create(int width, int height) {
  LORICA_TRY(OffscreenContext context, OffscreenContext::create());
  LORICA_TRY(Renderer renderer, Renderer::create(context.getProc()));
  return SnapshotCamera(std::move(context), std::move(renderer), width, height);
}

Image SnapshotCamera::draw(const Scene& scene, const SceneOptions& options, const Camera& camera) {
  renderer_.draw(scene, options, camera, width_, height_);
  return renderer_.readBack();
}

std::optional<CanvasSize> pictureSizeOf(std::string_view text) {
  if (text == "portrait") return CanvasSize{1080, 1920};
  if (text == "square") return CanvasSize{1080, 1080};
  CanvasSize size;
  const char* end = text.data() + text.size();
  const auto [cross, first] = std::from_chars(text.data(), end, size.width);
  if (first != std::errc() || cross == end || *cross != 'x') return std::nullopt;
  const auto [stopped, second] = std::from_chars(cross + 1, end, size.height);
  if (second != std::errc() || stopped != end) return std::nullopt;
  for (const int side : {size.width, size.height}) {
    if (side < kSmallestSide || side > kLargestSide) return std::nullopt;
  }
  return size;
}

std::optional<Background> backgroundNamed(std::string_view text) {
  if (text == "light") return Background{};
  if (text == "dark") return Background{.dark = true};
  if (text == "transparent") return Background{.transparent = true};
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kNames = {
      {{"green", "#00ff00"}, {"blue", "#0000ff"}, {"white", "#ffffff"}, {"black", "#000000"}, {"gray", "#808080"}}};
  for (const auto& [name, meant] : kNames) {
    if (text == name) text = meant;
  }
  std::uint32_t color = 0;
  const char* end = text.data() + text.size();
  const bool written = text.size() == 7 && text[0] == '#';
  if (!written || std::from_chars(text.data() + 1, end, color, 16).ptr != end) return std::nullopt;
  return Background{Vec3f((color >> 16) / 255.0f, (color >> 8 & 0xff) / 255.0f, (color & 0xff) / 255.0f)};
}

void setBackground(const std::optional<Background>& background, SceneOptions& show) {
  if (!background) return;
  if (background->isForKeying()) show.ground = false;
  show.transparent = background->transparent;
  show.background = background->color;
  show.dark = background->dark;
}

bool SnapshotOptions::draws(const std::string& name) const {
  int frame = -1;
  if (name.starts_with(kPictureName))
    std::from_chars(name.data() + kPictureName.size(), name.data() + name.size(), frame);
  return frame >= 0 && frame % every == 0 && name == pictureName(frame);
}

Result<std::optional<SnapshotSeries>> SnapshotSeries::create(const SnapshotOptions& options, const Session& session) {
  if (!options.any()) return std::optional<SnapshotSeries>();
  const CanvasSize size = options.size;
  LORICA_TRY(SnapshotCamera pictures, SnapshotCamera::create(size.width, size.height));
  if (!options.folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error) return unwritable("--snapshots: {}: {}", options.folder, error.message());
  }
  SnapshotSeries series(options, std::move(pictures), session);
  if (!options.video.empty()) {
    LORICA_TRY(VideoWriter movie, VideoWriter::create(options.video, size.width, size.height, kFilmRate));
    series.movie_.emplace(std::move(movie));
  }
  return std::optional<SnapshotSeries>(std::move(series));
}

SnapshotSeries::SnapshotSeries(const SnapshotOptions& options, SnapshotCamera pictures, const Session& session)
    : options_(options),
      pictures_(std::move(pictures)),
      scene_(session),
      follow_(options.camera, options.size.aspect()),
      drawn_{options.folder, options.video} {}

bool SnapshotSeries::snapshotDue(const Session& session) const {
  return !options_.folder.empty() && (session.frameCount() - 1) % options_.every == 0;
}

/// Duration of the video up to the session's current frame. It follows the session's time, so the video is real-time.
double SnapshotSeries::filmSeconds(const Session& session) const {
  return filmSeconds_ + std::clamp(session.time() - previousTime_.value_or(session.time()), 0.0, kLongestStill);
}

/// Number of video frames that show the session's current frame.
int SnapshotSeries::filmFrames(const Session& session) const {
  if (!movie_) return 0;
  return 1 + std::floor(filmSeconds(session) * kFilmRate + kFilmEarly) - filmed_;
}

Result<void> SnapshotSeries::add(const Session& session, const std::string& name, const Image* inset) {
  scene_.follow(session);
  if (!firstTime_) firstTime_ = session.time();
  const int film = filmFrames(session);
  filmSeconds_ = filmSeconds(session);
  if (movie_) follow_.update(session, session.time() - previousTime_.value_or(session.time()));
  previousTime_ = session.time();
  if (film <= 0 && !snapshotDue(session)) return {};
  SceneOptions show = usualView(session.character());
  if (!options_.forKeying()) show.caption = captionOf(name, session, session.time() - *firstTime_);
  setBackground(options_.background, show);
  const auto draw = [&](const Camera& from) {
    Scene scene = scene_.of(session, show, from.eye);
    scene.inset = inset;
    return pictures_.draw(scene, show, from);
  };
  if (film > 0) {
    const Image image = draw(follow_.camera());
    for (int i = 0; i < film; ++i, ++filmed_) {
      LORICA_TRY_DO(movie_->add(image));
    }
  }
  if (!snapshotDue(session)) return {};
  const Image image = draw(follow_.still(session));
  const std::filesystem::path file = std::filesystem::path(options_.folder) / pictureName(session.frameCount() - 1);
  LORICA_TRY_DO(writePng(file, image, NamedBy::kLorica));
  ++drawn_.snapshots;
  return {};
}

Result<DrawnFiles> SnapshotSeries::finish() {
  if (movie_ && filmed_ > 0) {
    drawn_.videoFrames = filmed_;
    LORICA_TRY_DO(movie_->finish());
  }
  return drawn_;
}

}  // namespace lorica
