// Accuracy and speed of Tracker on rendered people: rows by motion and body as CSV on standard output, then the table
// of targets on lines that start with '#'.

#include "capture/skeleton_frame.h"
#include "capture/tracking/tracker.h"
#include "geometry/files.h"
#include "tests/bench/depth_overlay.h"
#include "tests/bench/generators/near_people.h"
#include "tests/bench/generators/other_cameras.h"
#include "tests/bench/generators/virtual_clothes.h"
#include "tests/bench/measure.h"
#include "tests/bench/tracking_motions.h"
#include "tests/bench/tracking_real.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

/// A joint with a larger error counts as wrong [m].
inline constexpr double kWrong = 0.15;

/// Errors of one person in one frame.
struct JointErrors {
  double time = 0.0;     ///< [s]
  bool visible = false;  ///< according to the ground truth, the person is in the image
  bool tracked = false;
  std::array<double, kBodyJointCount> distance{};  ///< of each joint from the ground truth [m]; if tracked
  std::array<bool, kBodyJointCount> sure{};        ///< confidence 0.5 or more
  bool sidesSwapped = false;                       ///< fits better with left and right swapped

  /// Whether an elbow, hand, knee or foot is wrong; true if the person is not tracked.
  [[nodiscard]] bool limbWrong() const {
    return !tracked || std::ranges::any_of(kLimbJoints, [&](BodyJoint j) { return distance[ordinalOf(j)] > kWrong; });
  }
};

/// Errors of one run or of several.
struct ErrorSummary {
  int frames = 0;  ///< number of frames evaluated
  double trackedPercent = 0.0;
  double meanMm = 0.0, medianMm = 0.0, p95Mm = 0.0;  ///< over all joints in tracked frames
  double limbWrongPercent = 0.0;                     ///< of frames
  double sureWrongPercent = 0.0;                     ///< of joints reported with confidence 0.5 or more
  double surePercent = 0.0;                          ///< of joints
  double swappedPercent = 0.0;                       ///< of tracked frames
};

constexpr std::size_t kSteadyFrames = 5;

double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

/// @param tracked  same frame as the truth; nothing if the person is not tracked
JointErrors errorsOf(const SkeletonFrame& truth, bool visible, const std::optional<SkeletonFrame>& tracked) {
  JointErrors result;
  result.time = truth.time;
  result.visible = visible;
  result.tracked = tracked.has_value();
  if (!tracked) return result;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    result.distance[j] = (tracked->joints[j].position - truth.joints[j].position).norm();
    result.sure[j] = tracked->joints[j].confidence >= 0.5;
  }
  double straight = 0.0, swapped = 0.0;
  for (const BodyJoint left : kLeftJoints) {
    const BodyJoint right = rightOf(left);
    straight += ((*tracked)[left].position - truth[left].position).norm() +
                ((*tracked)[right].position - truth[right].position).norm();
    swapped += ((*tracked)[left].position - truth[right].position).norm() +
               ((*tracked)[right].position - truth[left].position).norm();
  }
  result.sidesSwapped = swapped < straight;
  return result;
}

/// @param runs  frames of each run, in order
/// @param from  time from which frames are evaluated in each run [s]
ErrorSummary summaryOf(std::span<const std::vector<JointErrors>> runs, double from) {
  ErrorSummary result;
  std::vector<double> distances;
  double tracked = 0.0, limbWrong = 0.0, sure = 0.0, sureWrong = 0.0, swapped = 0.0;
  for (const std::vector<JointErrors>& run : runs) {
    for (const JointErrors& frame : run) {
      if (!frame.visible || frame.time < from) continue;
      ++result.frames;
      limbWrong += frame.limbWrong() ? 1.0 : 0.0;
      if (!frame.tracked) continue;
      tracked += 1.0;
      swapped += frame.sidesSwapped ? 1.0 : 0.0;
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        distances.push_back(1000.0 * frame.distance[j]);
        if (!frame.sure[j]) continue;
        sure += 1.0;
        sureWrong += frame.distance[j] > kWrong ? 1.0 : 0.0;
      }
    }
  }
  result.trackedPercent = percent(tracked, result.frames);
  result.limbWrongPercent = percent(limbWrong, result.frames);
  result.sureWrongPercent = percent(sureWrong, sure);
  result.surePercent = percent(sure, tracked * kBodyJointCount);
  result.swappedPercent = percent(swapped, tracked);
  if (distances.empty()) return result;
  result.meanMm = meanOf(distances);
  result.medianMm = medianOf(distances);
  const auto p95 = static_cast<std::ptrdiff_t>(std::floor(0.95 * static_cast<double>(distances.size() - 1)));
  std::nth_element(distances.begin(), distances.begin() + p95, distances.end());
  result.p95Mm = distances[p95];
  return result;
}

/// Time from `from` until no limb joint is wrong for at least a sixth of a second.
/// @return [s]; nothing if that never happens
std::optional<double> secondsToFollow(std::span<const JointErrors> frames, double from) {
  std::size_t steady = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].time < from) continue;
    steady = frames[i].limbWrong() ? 0 : steady + 1;
    if (steady == kSteadyFrames) return std::max(0.0, frames[i + 1 - kSteadyFrames].time - from);
  }
  return std::nullopt;
}

struct Options {
  std::string data;
  std::vector<std::string> motions, bodies;
  std::vector<std::string> noises = {"kinect"}, clothes;
  bool half = false;
  int seeds = 5;
  bool clean = true;
  int frames = 0;
  double from = 1.0;
  bool quick = false;
  std::string real;
  bool four = false;
  bool near = false;
  RealOptions realOptions;
};

/// One run of one motion by one body, or several.
struct Runs {
  std::vector<std::vector<JointErrors>> people;  ///< frames of each person
  std::vector<double> ms;                        ///< CPU time of each frame, all threads
  std::vector<double> awaited;                   ///< time until each person was followed [s]; 1e9 = never
  std::uint64_t hash = 0;                        ///< of all tracked joints

  void add(const Runs& more) {
    people.insert(people.end(), more.people.begin(), more.people.end());
    ms.insert(ms.end(), more.ms.begin(), more.ms.end());
    awaited.insert(awaited.end(), more.awaited.begin(), more.awaited.end());
    hash = contentHash({reinterpret_cast<const char*>(&more.hash), sizeof(more.hash)}, hash);
  }
};

bool named(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::ranges::find(names, name) != names.end();
}

/// Matches tracked people to true people by the distance of the torsos, the nearest pair first.
std::vector<std::optional<SkeletonFrame>> matched(std::span<const VirtualTruth> truth,
                                                  std::vector<SkeletonFrame> tracked) {
  std::vector<std::optional<SkeletonFrame>> result(truth.size());
  for (;;) {
    double min = 1.0;
    std::size_t bestTruth = truth.size(), bestTracked = tracked.size();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (result[i] || !truth[i].present) continue;
      for (std::size_t k = 0; k < tracked.size(); ++k) {
        const double apart =
            (truth[i].joints[BodyJoint::kTorso].position - tracked[k][BodyJoint::kTorso].position).norm();
        if (apart >= min) continue;
        min = apart;
        bestTruth = i;
        bestTracked = k;
      }
    }
    if (bestTruth == truth.size()) return result;
    result[bestTruth] = tracked[bestTracked];
    tracked.erase(tracked.begin() + static_cast<std::ptrdiff_t>(bestTracked));
  }
}

/// Time at which the person enters or reappears, from which recovery is measured [s].
double awaitedFrom(const TrackedMotion& motion, std::span<const JointErrors> frames) {
  if (!motion.screens.empty()) return motion.screens.front().when.to;
  // A person who walks in counts from when most of the body stays in the image.
  for (std::size_t i = frames.size(); i > 0; --i) {
    if (!frames[i - 1].visible) return i < frames.size() ? frames[i].time : frames[i - 1].time;
  }
  return 0.0;
}

Result<Runs> track(const TestPerson& body, const TrackedMotion& motion, const DepthNoiseSettings& noise,
                   const Options& options) {
  DepthCamera camera = noise.sensor;
  if (options.half) {
    camera.width /= 2;
    camera.height /= 2;
  }
  Result<VirtualSensor> sensor = sensorBefore(body, motion, camera, noise);
  if (!sensor) return sensor.error();
  Result<Tracker> tracker = Tracker::create(sensor->camera());
  if (!tracker) return tracker.error();
  const double scale = camera.focalX() / DepthCamera{}.focalX();
  const double visiblePixels = 4000.0 * scale * scale;
  int frames = static_cast<int>(motion.seconds * 30.0);
  if (options.frames > 0) frames = std::min(frames, options.frames);
  Runs run;
  run.people.resize(sensor->truth().size());
  run.ms.reserve(frames);
  DepthFrame depth;
  for (int f = 0; f < frames; ++f) {
    Result<DepthRead> read = sensor->next(depth);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    const double before = cpuSeconds();
    const std::span<const TrackedPerson> people = tracker->track(depth);
    run.ms.push_back(1e3 * (cpuSeconds() - before));

    const Isometry3 cameraFromFloor = tracker->floorFromCamera().inverse();
    std::vector<SkeletonFrame> skeletons;
    skeletons.reserve(people.size());
    for (const TrackedPerson& person : people) skeletons.push_back(moved(person.skeleton, cameraFromFloor));
    for (const SkeletonFrame& one : skeletons) {
      for (const TrackedJoint& joint : one.joints) {
        run.hash = contentHash({reinterpret_cast<const char*>(joint.position.data()), sizeof(Vec3)}, run.hash);
      }
    }
    const std::vector<std::optional<SkeletonFrame>> found = matched(sensor->truth(), std::move(skeletons));
    run.people.resize(found.size());
    for (std::size_t p = 0; p < found.size(); ++p) {
      const VirtualTruth& truth = sensor->truth()[p];
      SkeletonFrame joints = truth.joints;
      joints.time = depth.time;
      run.people[p].push_back(errorsOf(joints, truth.present && truth.pixelCount > visiblePixels, found[p]));
    }
  }
  for (const std::vector<JointErrors>& person : run.people) {
    run.awaited.push_back(secondsToFollow(person, awaitedFrom(motion, person)).value_or(1e9));
  }
  return run;
}

/// The runs of one motion by one body.
struct Row {
  const TrackedMotion* motion = nullptr;
  const TestPerson* body = nullptr;
  std::string noise;
  Runs runs;
};

std::string seconds(double value) {
  return value > 1e8 ? "never" : fmt::format("{:.2f}", value);
}

void print(const Row& row, double from) {
  const Runs& runs = row.runs;
  const ErrorSummary s = summaryOf(runs.people, from);
  fmt::print("{},{},{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.2f},{:.1f},{:.1f},{},{:.2f},{:.2f},{:016x}\n",
             row.motion->name, row.body->name, row.noise, s.frames, s.trackedPercent, s.meanMm, s.medianMm, s.p95Mm,
             s.limbWrongPercent, s.sureWrongPercent, s.surePercent, s.swappedPercent,
             seconds(atRank(runs.awaited, 1.0)), meanOf(runs.ms), atRank(runs.ms, 0.99), runs.hash);
  std::fflush(stdout);
}

/// @param noise  name of the noise that is shown beside clean depth
void printTable(const std::vector<Row>& rows, const std::string& noise, double from) {
  fmt::print("#\n# {:<46} {:<16} {:<26} {:<26} {:<26}\n", "", "target", noise + ", other bodies", "clean, other bodies",
             noise + ", the mannequin");
  const auto line = [&](const char* name, const char* target, const auto& holds, const auto& text) {
    std::string cells;
    for (const auto& [clean, own] : {std::pair{false, false}, std::pair{true, false}, std::pair{false, true}}) {
      Runs group;
      for (const Row& row : rows) {
        if (row.noise == (clean ? "clean" : noise) && row.body->own == own && holds(row)) group.add(row.runs);
      }
      cells += fmt::format(" {:<26}", group.people.empty() ? std::string("-") : text(group));
    }
    fmt::print("# {:<46} {:<16}{}\n", name, target, cells);
  };
  const auto of = [](MotionKind kind, bool odd = false) {
    return [=](const Row& row) { return row.motion->kind == kind && row.body->odd == odd; };
  };
  const auto errors = [&](const Runs& g) {
    const ErrorSummary s = summaryOf(g.people, from);
    return fmt::format("{:.0f} / {:.0f} / {:.0f}", s.meanMm, s.medianMm, s.p95Mm);
  };
  const auto limbs = [&](const Runs& g) { return fmt::format("{:.1f}", summaryOf(g.people, from).limbWrongPercent); };
  const auto meanAndLimbs = [&](const Runs& g) {
    const ErrorSummary s = summaryOf(g.people, from);
    return fmt::format("{:.0f}, {:.1f}", s.meanMm, s.limbWrongPercent);
  };
  const auto swapped = [&](const Runs& g) {
    const ErrorSummary s = summaryOf(g.people, 2.0);
    return fmt::format("{:.1f}, limbs {:.1f}", s.swappedPercent, s.limbWrongPercent);
  };
  const auto awaited = [&](const Runs& g) {
    return fmt::format("{} / {}", seconds(atRank(g.awaited, 0.5)), seconds(atRank(g.awaited, 1.0)));
  };
  const auto human = [](const Row& row) { return !row.body->odd; };
  line("ordinary motion: mean / median / p95 [mm]", "35 / 28 / 80", of(MotionKind::kOrdinary), errors);
  line("ordinary: frames with a limb joint > 150 mm [%]", "4", of(MotionKind::kOrdinary), limbs);
  line("boxing: the same [%]", "10", of(MotionKind::kBoxing), limbs);
  line("crossed arms: the same [%]", "25", of(MotionKind::kCrossedArms), limbs);
  line("unusual body, ordinary: mean [mm], limbs [%]", "60, 15", of(MotionKind::kOrdinary, true), meanAndLimbs);
  line("confidence >= 0.5 and error > 150 mm [%]", "2", human, [&](const Runs& g) {
    const ErrorSummary s = summaryOf(g.people, from);
    return fmt::format("{:.2f} of {:.0f}", s.sureWrongPercent, s.surePercent);
  });
  line("recovery after occlusion: median / max [s]", "0.5", of(MotionKind::kOcclusion), awaited);
  line("turn on the spot: sides swapped [%], after 2 s", "0", of(MotionKind::kTurn), swapped);
  line("starting with the back to the camera: the same", "0", of(MotionKind::kBackTurned), swapped);
  line("sitting on a chair: mean [mm], limb joint [%]", "tracked", of(MotionKind::kSitting), meanAndLimbs);
  line("walking up to 6 m away: mean [mm], limb joint [%]", "-", of(MotionKind::kFar), meanAndLimbs);
  line("two people: mean [mm], limb joint [%]", "both", of(MotionKind::kTwo), meanAndLimbs);
  line(
      "one person: CPU ms per frame, mean / p99", "12 / 25",
      [](const Row& row) { return row.motion->kind != MotionKind::kTwo; },
      [&](const Runs& g) { return fmt::format("{:.1f} / {:.1f}", meanOf(g.ms), atRank(g.ms, 0.99)); });
  line("two people: CPU ms per frame, mean / p99", "30 Hz, 2 cores", of(MotionKind::kTwo),
       [&](const Runs& g) { return fmt::format("{:.1f} / {:.1f}", meanOf(g.ms), atRank(g.ms, 0.99)); });
  line("followed after entering: median / max [s]", "1", of(MotionKind::kEntering), awaited);
}

Result<void> measure(const Options& options) {
  std::vector<TrackedMotion> motions = formulaMotions();
  Result<std::vector<TrackedMotion>> more = dataMotions(options.data);
  if (!more) return more.error();
  for (TrackedMotion& one : *more) motions.push_back(std::move(one));
  Result<std::vector<TestPerson>> bodies = trackedBodies(options.data);
  if (!bodies) return bodies.error();
  const auto check = [](const char* what, const std::vector<std::string>& names, const auto& known) -> Result<void> {
    for (const std::string& name : names) {
      if (std::ranges::any_of(known, [&](const auto& one) { return one.name == name; })) continue;
      return Error{ErrorCode::kInvalidArgument, fmt::format("--{0} {1}: no {0} has this name", what, name)};
    }
    return {};
  };
  if (Result<void> checked = check("motion", options.motions, motions); !checked) return checked;
  if (Result<void> checked = check("body", options.bodies, *bodies); !checked) return checked;

  std::erase_if(*bodies, [&](const TestPerson& one) { return !named(options.bodies, one.name); });
  const std::size_t bare = bodies->size();
  for (const std::string& name : options.clothes) {
    const Clothes piece = *clothesNamed(name);
    for (std::size_t b = 0; b < bare; ++b) {
      TestPerson dressed = (*bodies)[b];
      dressed.name += "+" + name;
      dressed.character = withClothes(dressed.character, {&piece, 1});
      dressed.own = false;
      bodies->push_back(std::move(dressed));
    }
  }

  fmt::print(
      "motion,body,noise,frames,tracked_percent,mean_mm,median_mm,p95_mm,limb_wrong_percent,sure_wrong_percent,"
      "sure_percent,swapped_percent,followed_after_s,cpu_ms_mean,cpu_ms_p99,hash\n");
  std::vector<Row> rows;
  for (const TrackedMotion& motion : motions) {
    if (!named(options.motions, motion.name)) continue;
    for (const TestPerson& body : *bodies) {
      const auto measureRow = [&](const std::string& name, DepthNoiseSettings noise, int seeds) -> Result<void> {
        Row row{&motion, &body, name, {}};
        for (int seed = 1; seed <= seeds; ++seed) {
          noise.seed = static_cast<std::uint64_t>(seed);
          Result<Runs> run = track(body, motion, noise, options);
          if (!run) {
            return Error{run.error().code, fmt::format("{} by {}: {}", motion.name, body.name, run.error().message)};
          }
          row.runs.add(*run);
        }
        if (row.runs.people.empty()) return {};
        print(row, options.from);
        rows.push_back(std::move(row));
        return {};
      };
      for (const std::string& name : options.noises) {
        const DepthNoiseSettings noise = noiseNamed(name);
        if (Result<void> done = measureRow(name, noise, options.seeds); !done) return done;
      }
      if (!options.clean) continue;
      if (Result<void> done = measureRow("clean", DepthNoiseSettings::clean(), 1); !done) return done;
    }
  }
  for (const std::string& name : options.noises) printTable(rows, name, options.from);
  return {};
}

/// A row for each scene of somebody near the camera.
Result<void> measureNear(const Options& options) {
  fmt::print(
      "scene,seed,frames,first_frame,followed_percent,others,heading_off,sure,sure_off,legs_known,trunk_mm,cpu_ms_mean,"
      "cpu_ms_p99\n");
  for (const NearScene& scene : nearScenes()) {
    if (!named(options.motions, std::string(scene.name))) continue;
    for (int seed = 1; seed <= options.seeds; ++seed) {
      VirtualSensor sensor = nearSensor(scene, static_cast<std::uint64_t>(seed));
      Result<Tracker> tracker = Tracker::create(sensor.camera());
      if (!tracker) return tracker.error();
      NearFigures figures;
      std::vector<double> ms;
      std::vector<Image> pictures;
      std::vector<std::string> captions;
      DepthFrame depth;
      for (int f = 0; f < kNearFrames; ++f) {
        sensor.render(static_cast<std::uint64_t>(f), depth);
        const double before = cpuSeconds();
        const std::span<const TrackedPerson> people = tracker->track(depth);
        ms.push_back(1e3 * (cpuSeconds() - before));
        std::vector<SkeletonFrame> seen;
        for (const TrackedPerson& person : people) {
          seen.push_back(moved(person.skeleton, tracker->floorFromCamera().inverse()));
        }
        figures.add(sensor.truth()[0], seen);
        if (options.realOptions.pictures.empty() || f % options.realOptions.pictureStep != 0) continue;
        std::vector<DrawnSkeleton> drawn = {{positionsOf(sensor.truth()[0].joints), {}, kTrueColour}};
        for (const SkeletonFrame& one : seen) drawn.push_back(trackedSkeleton(one));
        pictures.push_back(depthOverlay(sensor.camera(), depth.depthMm, tracker->labels(), drawn));
        captions.push_back(fmt::format("{}", f));
      }
      fmt::print("{},{},{},{},{:.1f},{},{},{},{},{},{:.0f},{:.1f},{:.1f}\n", scene.name, seed, figures.frames,
                 figures.first, percent(figures.followed, figures.frames), figures.others, figures.headingOff,
                 figures.sure, figures.sureOff, figures.legsKnown, figures.trunkMm, meanOf(ms), atRank(ms, 0.99));
      std::fflush(stdout);
      if (pictures.empty()) continue;
      const auto file = options.realOptions.pictures / fmt::format("{}_{}.png", scene.name, seed);
      if (Result<void> written = writePng(file, contactSheet(pictures, captions, 5)); !written) return written;
    }
  }
  return {};
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  using namespace lorica::bench;
  Options options;
  CLI::App app{"Tracks rendered people and compares with the ground truth."};
  app.add_option("data", options.data, "folder of third-party data: more bodies and motions");
  app.add_option("--motion", options.motions, "only these motions")->delimiter(',');
  app.add_option("--body", options.bodies, "only these bodies")->delimiter(',');
  app.add_option("--noise", options.noises, "errors of these cameras")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(lorica::kCameraNames.begin(), lorica::kCameraNames.end())));
  app.add_flag("--half", options.half, "half of the camera's pixels along each side");
  app.add_option("--clothes", options.clothes, "also bodies that wear one of these")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(lorica::kClothesNames.begin(), lorica::kClothesNames.end())));
  app.add_option("--seeds", options.seeds, "noisy runs of each motion and body")->check(CLI::Range(0, 100));
  app.add_flag("!--no-clean", options.clean, "leave out depth without noise");
  app.add_option("--frames", options.frames, "maximum number of frames of each motion")->check(CLI::Range(1, 100'000));
  app.add_option("--from", options.from, "time from which errors are evaluated [s]");
  app.add_flag("--quick", options.quick, "one seed, 120 frames, two bodies, no clean depth");
  app.add_option("--real", options.real, "measure on the depth recordings of real people in this folder instead");
  app.add_option("--name", options.realOptions.names, "with --real: only recordings whose name begins like this")
      ->delimiter(',');
  app.add_option("--start", options.realOptions.variant.start, "with --real: frames left out at the beginning")
      ->check(CLI::Range(0, 10'000));
  app.add_flag("--mirror", options.realOptions.variant.mirror, "with --real: left and right exchanged");
  app.add_flag("--near", options.near, "measure on rendered people near the camera, from the waist up, instead");
  CLI::Option* four =
      app.add_flag("--four", options.four, "with --real: four runs, from the first frame and two later, both mirrored");
  CLI::Option* composed =
      app.add_option(
             "--composed", options.realOptions.composed,
             "with --real: so many rooms composed of its people, its empty rooms and rendered furniture instead")
          ->check(CLI::Range(1, 10'000));
  app.add_flag("--sway", options.realOptions.variant.sways, "with --real: the camera rolls and pans to and fro")
      ->excludes(four)
      ->excludes(composed);
  app.add_option("--results", options.realOptions.results, "with --real: folder for the joints and labels");
  app.add_option("--pictures", options.realOptions.pictures,
                 "with --real: folder for pictures of the tracked (red) and recorded (green) joints over the depth");
  app.add_option("--picture-step", options.realOptions.pictureStep, "with --pictures: draw every n-th frame")
      ->check(CLI::Range(1, 10'000));
  CLI11_PARSE(app, argc, argv);
  if (options.quick) {
    options.seeds = 1;
    options.clean = false;
    if (options.frames == 0) options.frames = 120;
    if (options.bodies.empty()) options.bodies = {"tall", "heavy"};
  }
  std::vector<RealVariant> variants = {options.realOptions.variant};
  if (options.four) variants = {{0, false}, {0, true}, {2, false}, {2, true}};
  for (const RealVariant& variant : variants) {
    options.realOptions.variant = variant;
    if (lorica::Result<void> done = options.near           ? measureNear(options)
                                    : options.real.empty() ? measure(options)
                                                           : measureRealPeople(options.real, options.realOptions);
        !done)
      return fail(done.error());
  }
  return 0;
}
