#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/show.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/snapshots.h"
#include "viewer/player/window_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime = 1e-6;  // [s]

struct PictureOptions {
  CastRequest request;
  SnapshotOptions pictures;  // without a folder
  std::string out;
  std::vector<double> at;   // [s]
  std::vector<int> frames;  // from 0
  double from = 0.0;        // of the video [s]
  double to = 0.0;          // 0 = the end
  std::vector<std::string> show;
  bool strip = false;
};

/// Before a background of the user's own the avatar is alone, unless a scene is asked for.
SceneOptions shownBy(const PictureOptions& options, const Character& character) {
  const std::vector<std::string>& words = options.show;
  SceneOptions show = usualView(character);
  setBackground(options.pictures.background, show);
  show.props = !options.pictures.forKeying() || !options.request.scene.empty();
  if (words.empty()) return show;
  const auto has = [&words](const char* word) { return std::find(words.begin(), words.end(), word) != words.end(); };
  show.colorSkinByPart = has("parts");
  show.skin = has("skin") || show.colorSkinByPart;
  show.hulls = has("hulls");
  show.bones = has("bones");
  show.props = has("props");
  show.contacts = has("contacts");
  show.particles = has("particles");
  show.ground = has("ground");
  return show;
}

/// Whether hulls, what touches them, or their number is in the picture.
bool needsHulls(const std::vector<std::string>& layers) {
  constexpr std::array<std::string_view, 3> kAlone = {"skin", "bones", "ground"};
  return layers.empty() || std::ranges::any_of(layers, [&kAlone](const std::string& layer) {
           return std::ranges::find(kAlone, layer) == kAlone.end();
         });
}

/// A requested picture.
struct Wanted {
  double seconds = 0.0;  // since the first frame; used if frame is negative
  int frame = -1;
};

/// The requested pictures in chronological order.
/// @param choices  the other clips of the motion's file
Result<std::vector<Wanted>> wantedPictures(const PictureOptions& options, const Motion& motion,
                                           const CastChoices& choices) {
  std::vector<Wanted> wanted;
  wanted.reserve(options.at.size() + options.frames.size() + 1);
  for (const double at : options.at) {
    if (!(at >= 0.0 && at <= motion.seconds() + kSameTime)) {
      return invalidArgument(
          "--at {}: {} lasts from 0 to {:.2f} s{}", at, motion.name, motion.seconds(),
          choices.clips.empty() ? "" : fmt::format("; --clip chooses one of {}", fmt::join(choices.clips, ", ")));
    }
    wanted.push_back({at, -1});
  }
  for (const int frame : options.frames) {
    if (frame < 0 || frame >= motion.frameCount()) {
      return invalidArgument("--frame {}: {} has {}, from 0 to {}", frame, motion.name,
                             counted(motion.frameCount(), "frame"), motion.frameCount() - 1);
    }
    wanted.push_back({0.0, frame});
  }
  if (wanted.empty() && options.pictures.video.empty()) wanted.push_back({0.5 * motion.seconds(), -1});
  std::sort(wanted.begin(), wanted.end(), [](const Wanted& a, const Wanted& b) {
    return std::pair(a.frame, a.seconds) < std::pair(b.frame, b.seconds);
  });
  return wanted;
}

struct Outcome {
  std::unique_ptr<Run> run;
  std::vector<fs::path> files;
  std::string renderer;
  int videoFrames = 0;

  [[nodiscard]] const Motion& motion() const { return *run->cast.avatars.front().motion; }  // of the first avatar
};

/// Names of so many pictures.
std::vector<fs::path> pictureFiles(const PictureOptions& options, const std::string& motion, std::size_t count) {
  const fs::path out = options.out.empty() ? fs::path(motion + ".png") : fs::path(options.out);
  if (options.strip || count < 2) return std::vector<fs::path>(std::min<std::size_t>(count, 1), out);
  std::vector<fs::path> files(count, out);
  for (std::size_t i = 0; i < count; ++i)
    files[i].replace_filename(fmt::format("{}_{}.png", out.stem().string(), i + 1));
  return files;
}

/// Runs the session as far as needed and draws the requested pictures.
Result<Outcome> shoot(const PictureOptions& options, const std::vector<Wanted>& wanted, Cast cast, Host& host) {
  const Motion& motion = *cast.avatars.front().motion;  // leads
  const double length = motion.seconds();
  const CanvasSize size = options.pictures.size;
  LORICA_TRY(SnapshotCamera pictures, SnapshotCamera::create(size.width, size.height));
  Outcome outcome;
  std::optional<VideoWriter> movie;
  if (!options.pictures.video.empty()) {
    const double rate = length > 0.0 ? (motion.frameCount() - 1) / length : 30.0;
    LORICA_TRY(VideoWriter made, VideoWriter::create(options.pictures.video, size.width, size.height, rate));
    movie.emplace(std::move(made));
  }
  const double end = options.to > 0.0 ? options.to : length;
  const double until = std::accumulate(wanted.begin(), wanted.end(), movie ? end : 0.0,
                                       [](double sum, const Wanted& one) { return std::max(sum, one.seconds); });
  const double share = length > 0.0 ? std::min(until / length, 1.0) : 1.0;
  RunSetting setting;
  setting.doing = movie ? "Rendering video of" : "Playing";
  setting.frames = motion.frameCount();
  setting.expected = 1 + int(std::ceil(share * (motion.frameCount() - 1)));  // estimate
  for (const Wanted& one : wanted) setting.expected = std::max(setting.expected, one.frame + 1);
  LORICA_TRY(outcome.run, Run::start(std::move(cast), setting, host));
  Run& run = *outcome.run;
  const Session& session = run.session;

  SessionScene scene(session);
  FollowCamera camera(options.pictures.camera, size.aspect());
  SceneOptions show = shownBy(options, session.character());
  const bool caption = (options.show.empty() && !options.pictures.forKeying()) ||
                       std::find(options.show.begin(), options.show.end(), "caption") != options.show.end();
  std::vector<bool> taken(wanted.size(), false);
  std::vector<Image> images;
  std::vector<std::string> labels;
  images.reserve(wanted.size());
  labels.reserve(wanted.size());
  double previous = 0.0;
  Shown shown;
  shown.picture = [&]() -> Result<bool> {
    const int frame = session.frameCount() - 1;
    const double seconds = run.seconds();
    scene.follow(session);
    if (movie) camera.update(session, seconds - previous);
    previous = seconds;
    const auto draw = [&](const Camera& from) {
      if (caption) show.caption = captionOf(run.name() + run.hits.caption(), session, seconds);
      return pictures.draw(scene.of(session, show, from.eye), show, from);
    };
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Wanted& one = wanted[i];
      const bool last = frame + 1 == setting.frames;
      if (taken[i] || !(one.frame >= 0 ? frame == one.frame : last || seconds >= one.seconds - kSameTime)) continue;
      taken[i] = true;
      images.push_back(draw(camera.still(session)));
      labels.push_back(fmt::format("{:.2f} s", seconds));
    }
    if (movie && seconds >= options.from - kSameTime && seconds <= end + kSameTime) {
      LORICA_TRY_DO(movie->add(draw(camera.camera())));
      ++outcome.videoFrames;
    }
    const bool allTaken = std::find(taken.begin(), taken.end(), false) == taken.end();
    return !allTaken || (movie && seconds <= end);
  };
  LORICA_TRY(const RunEnd ended, play(run, shown, host));
  if (ended == RunEnd::kInterrupted) return cancelled();

  outcome.renderer = pictures.rendererName();
  if (options.strip && images.size() > 1) {
    const Image sheet = contactSheet(images, labels, countOf(images));
    images.assign(1, sheet);
  }
  outcome.files = pictureFiles(options, outcome.motion().name, images.size());
  for (std::size_t i = 0; i < images.size(); ++i) LORICA_TRY_DO(writePng(outcome.files[i], images[i]));
  if (movie) LORICA_TRY_DO(movie->finish());
  return outcome;
}

Result<void> checkSnapshot(const PictureOptions& options, const CommonOptions& common) {
  std::vector<fs::path> others = options.request.files();
  others.insert(others.end(), {options.out, options.pictures.video});
  LORICA_TRY_DO(checkJsonOutput(common, others));
  if (!options.out.empty()) {
    CommonOptions name = common;  // several pictures get a number
    name.force = true;
    LORICA_TRY_DO(checkOutput(name, "--out", options.out, ".png"));
  }
  LORICA_TRY_DO(checkPictures(common, options.pictures));
  if (options.to > 0.0 && options.to < options.from) {
    return invalidArgument("--to {} is before --from {}", options.to, options.from);
  }
  return {};
}

Result<void> runSnapshot(const PictureOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkSnapshot(options, common));
  CastRequest request = options.request;
  request.reading.drawn = true;
  request.hulls = needsHulls(options.show);
  std::vector<Wanted> wanted;
  request.check = [&](std::span<const PreparedAvatar> avatars) -> Result<void> {
    const Motion& motion = *avatars.front().motion;
    LORICA_TRY(wanted, wantedPictures(options, motion, choicesOf(request, avatars)));
    for (const fs::path& file : pictureFiles(options, motion.name, wanted.size())) {
      LORICA_TRY_DO(checkOutput(common, "--out", file));
    }
    return {};
  };
  LORICA_TRY(Cast cast, prepareCast(request, host));
  LORICA_TRY(const Outcome outcome, shoot(options, wanted, std::move(cast), host));

  const Session& session = outcome.run->session;
  const Motion& motion = outcome.motion();
  Report report(fmt::format("{} performed {}: {}", whoOf(*outcome.run), outcome.run->name(),
                            counted(session.frameCount(), "frame")));
  report.add("recording", motion.name);
  report.add("character", session.character().name);
  report.add("frames", session.frameCount());
  Json pictures = Json::array();
  for (const fs::path& picture : outcome.files) {
    pictures.push_back(picture.string());
    report.line("picture", picture.string());
  }
  report.add("pictures", std::move(pictures));
  const std::string& video = options.pictures.video;
  report.add("video", "video", orNull(video),
             video.empty() ? "" : fmt::format("{}, {}", video, counted(outcome.videoFrames, "frame")));
  report.add("videoFrames", outcome.videoFrames);
  report.add("firstGuess", "first guess", motion.firstGuess);
  report.add("renderer", "renderer", outcome.renderer);
  const std::string hash = outcome.run->cast.request.hulls ? hexDigits(session.hash()) : "";
  report.add("hash", "hash", orNull(hash), hash);
  for (const std::string& note : motion.notes) report.note(note);
  return publish(common, report);
}

}  // namespace

Command addSnapshot(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<PictureOptions>();
  CLI::App* app =
      addSubcommand(parent, common, "snapshot", "Draw pictures or a video of a motion, without a display.",
                    "  lorica snapshot walk --at 1.5 -o walk.png\n"
                    "      the pose 1.5 s after the start\n"
                    "  lorica snapshot punch_and_kick --at 1,2,3,4 --strip -o kick.png\n"
                    "      four moments side by side; without --strip kick_1.png, kick_2.png, ...\n"
                    "  lorica snapshot walk --frame 45 --camera front --show hulls,bones,ground --size 640x480\n"
                    "      the collision hulls and the bones\n"
                    "  lorica snapshot punch_and_kick --scene bowling --video kick.mp4 --eye 2,1.5,3 --target 0,0.9,0\n"
                    "      the whole motion from a fixed camera\n"
                    "\nThe hulls of each frame are the same as in `lorica play`: compare the hashes. Skin, bones\n"
                    "and ground alone need no hulls: then none are made, and there is no hash.");
  addMotionOptions(*app, options->request);
  addOption(*app, "-o,--out", options->out, "FILE",
            "Output file; several pictures get a numbered suffix [default: MOTION.png]");
  addOption(*app, "--at", options->at, "S",
            "Times in seconds since the first frame, separated by commas [default: halfway]")
      ->delimiter(',')
      ->check(numberError<double>);
  addOption(*app, "--frame", options->frames, "N", "Frames, counted from 0, separated by commas")
      ->delimiter(',')
      ->check(numberError<int>);
  CLI::Option* video =
      addOption(*app, "--video", options->pictures.video, "FILE", "Write a real-time video of all frames, as .mp4");
  addMoment(*app, "--from", options->from, "Start of the video")->needs(video);
  addSeconds(*app, "--to", options->to, "End of the video [default: the end of the motion]")->needs(video);
  addLookOptions(*app, options->pictures);
  addOption(*app, "--show", options->show, "WHAT",
            "Draw only these: skin (as the character's maker drew it), parts (its body coloured by part), hulls, "
            "bones, props, particles, contacts, ground, caption [default: all except bones; of a character with "
            "materials the skin without parts and hulls]")
      ->delimiter(',')
      ->transform(oneOf({"skin", "parts", "hulls", "bones", "props", "particles", "contacts", "ground", "caption"}));
  addTextureOption(*app, options->request.reading.textureSize);
  app->add_flag("--strip", options->strip, "Combine several pictures side by side in one file");
  addCameraOptions(*app, options->pictures.camera);
  addBodyOptions(*app, options->request.body);
  addSceneOption(*app, options->request.scene);
  return {app, [options](const CommonOptions& given, Host& host) { return runSnapshot(*options, given, host); }};
}

}  // namespace lorica
