#include "viewer/player/demo_pictures.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr const char* kVideoName = "demo.mp4";
constexpr const char* kSheetName = "contact_sheet.png";
constexpr int kMoments = 3;  // columns of the sheet

/// @param moment  from 0
std::string momentName(bool hullsOnly, int moment) {
  return fmt::format("{}_{}.png", hullsOnly ? "hulls" : "snapshot", moment + 1);
}

/// Half as wide and high, each pixel the mean of four.
Image halved(const Image& image) {
  Image half = Image::filled(image.width / 2, image.height / 2);
  const auto at = [&image](int x, int y, int channel) {
    return image.rgba[(static_cast<std::size_t>(y) * image.width + x) * 4 + channel];
  };
  std::size_t out = 0;
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < 4; ++c) {
        const int sum =
            at(2 * x, 2 * y, c) + at(2 * x + 1, 2 * y, c) + at(2 * x, 2 * y + 1, c) + at(2 * x + 1, 2 * y + 1, c);
        half.rgba[out++] = (sum + 2) / 4;
      }
    }
  }
  return half;
}

/// Score of a frame as a snapshot: the number and the impulses of its contacts.
double eventsIn(const Session& session) {
  double events = 0.0;
  for (const Contact& contact : session.world().contacts()) events += 0.1 + contact.impulse;
  return events;
}

}  // namespace

bool isOfDemo(const std::string& name) {
  for (int i = 0; i < kMoments; ++i) {
    if (name == momentName(false, i) || name == momentName(true, i)) return true;
  }
  return name == kVideoName || name == kSheetName;
}

DemoPictures::DemoPictures(fs::path folder, SnapshotCamera camera, std::optional<VideoWriter> video)
    : folder_(std::move(folder)),
      camera_(std::move(camera)),
      video_(std::move(video)),
      follow_({"three-quarter"}, 1.0 * kWidth / kHeight),
      moments_(kMoments) {}

Result<DemoPictures> DemoPictures::create(const fs::path& folder, double framesPerSecond, Host& host) {
  LORICA_TRY(SnapshotCamera camera, SnapshotCamera::create(kWidth, kHeight));
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return unwritable("--out: {}: {}", folder.string(), error.message());
  Result<VideoWriter> video = VideoWriter::create(folder / kVideoName, kWidth, kHeight, framesPerSecond);
  if (!video) {
    if (video.error().code != ErrorCode::kUnsupported) return video.error();
    host.warn(video.error().message + "; drawing pictures only");  // the video module is optional
    return DemoPictures(folder, std::move(camera), std::nullopt);
  }
  return DemoPictures(folder, std::move(camera), std::move(*video));
}

Result<void> DemoPictures::add(const Session& session, const std::string& caption, double seconds, int frame,
                               int frames) {
  if (!scene_) scene_ = std::make_unique<SessionScene>(session);
  scene_->follow(session);
  follow_.update(session, seconds - lastSeconds_);
  lastSeconds_ = seconds;
  SceneOptions show;
  show.caption = caption;
  Image image = camera_.draw(scene_->of(session, show, follow_.camera().eye), show, follow_.camera());
  if (video_) {
    LORICA_TRY_DO(video_->add(image));
  }

  // The time is divided evenly among the snapshots; each keeps the most eventful frame of its interval.
  Moment& moment = moments_[static_cast<long long>(frame) * kMoments / frames];
  const double events = eventsIn(session);
  if (events <= moment.events) return {};
  show.skin = false;
  Image hulls = camera_.draw(scene_->of(session, show, follow_.camera().eye), show, follow_.camera());
  moment = {std::move(image), std::move(hulls), fmt::format("{:.1f} s", seconds), events};
  return {};
}

Result<DemoFiles> DemoPictures::finish() {
  DemoFiles files{camera_.rendererName(), std::nullopt, {}, folder_ / kSheetName};
  if (video_) {
    LORICA_TRY_DO(video_->finish());
    files.video = folder_ / kVideoName;
  }
  std::erase_if(moments_, [](const Moment& moment) { return moment.body.rgba.empty(); });  // fewer frames than moments

  // Upper row: the body. Lower row: the hulls at the same moments.
  std::vector<Image> thumbnails;
  std::vector<std::string> labels;
  for (const bool hullsOnly : {false, true}) {
    for (std::size_t i = 0; i < moments_.size(); ++i) {
      const Moment& moment = moments_[i];
      const Image& image = hullsOnly ? moment.hulls : moment.body;
      files.snapshots.push_back(folder_ / momentName(hullsOnly, int(i)));
      LORICA_TRY_DO(writePng(files.snapshots.back(), image, NamedBy::kLorica));
      thumbnails.push_back(halved(image));
      labels.push_back(moment.label + (hullsOnly ? ", collision hulls" : ""));
    }
  }
  const Image sheet = contactSheet(thumbnails, labels, countOf(moments_));
  LORICA_TRY_DO(writePng(files.contactSheet, sheet, NamedBy::kLorica));
  return files;
}

}  // namespace lorica
