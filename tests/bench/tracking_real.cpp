#include "tests/bench/tracking_real.h"

#include "capture/sensor/oni_file.h"
#include "capture/tracking/track_log.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "tests/bench/composed_rooms.h"
#include "tests/bench/depth_overlay.h"
#include "tests/bench/measure.h"
#include "tests/bench/real_recordings.h"
#include "viewer/pictures/image_files.h"

#include <tbb/parallel_for.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kOff = 0.15;        ///< a joint with a larger error counts as off [m]
constexpr double kSamePlace = 0.6;   ///< a tracked person farther than this from every true one is a false person [m]
constexpr double kOutside = 0.1;     ///< a confident joint seen farther from every true pixel is outside [m]
constexpr double kOtherDepth = 0.6;  ///< a mark farther than this from the person's others is on something else [m]
constexpr double kOtherPlace = 0.5;  ///< a tracked person farther than this from marks is not the marked one [m]
constexpr double kJump = 0.15;       ///< a joint that moves more from one frame to the next has jumped [m]
constexpr double kStill = 0.08;      ///< unless the recorded one moves more than this [m]
constexpr double kSettled = 1.0;     ///< time after which a person should be followed and false people be gone [s]

/// A tracked person in one frame, camera frame.
struct Seen {
  int user = 0;
  SkeletonFrame joints;
};

/// A frame in which a true person is followed.
struct Match {
  bool settled = false;
  bool back = false;                            ///< left and right shoulder are exchanged
  std::array<double, kBodyJointCount> error{};  ///< less the offsets of the joints' definitions [m]
  std::array<bool, kBodyJointCount> sure{};
  std::array<bool, kBodyJointCount> hidden{};  ///< not seen, where masks of all frames tell
};

/// How far a joint is from where it was marked, in the image plane at the marked depth [m].
struct MarkError {
  BodyJoint joint{};
  Eigen::Vector2d off;
  bool sure = false;
};

/// What was measured in one recording, or in several.
struct Measured {
  int frames = 0;         ///< sum over the true people
  int settledFrames = 0;  ///< those later than kSettled
  std::vector<Match> matches;
  int first = -1;  ///< frame in which the last of the people was first followed; -1 = never
  int falseFrames = 0, lateFalseFrames = 0;
  int exchanges = 0;  ///< times at which a person got another person's number
  std::vector<double> overlaps, ms;
  int sureSeen = 0, sureOutside = 0;  ///< confident joints in frames with a mask; those outside of it
  int steps = 0, pops = 0;            ///< pairs of frames of a person; jumps of a joint that hardly moves
  std::vector<MarkError> marks;       ///< see readRealRecordings()
};

Match compare(const Joints& truth, const SkeletonFrame& tracked, const Joints& offsets, const Isometry3& floor) {
  Match match;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const Vec3 off = floor.linear() * (tracked.joints[j].position - truth[j]) - offsets[j];
    match.error[j] = off.norm();
    match.sure[j] = tracked.joints[j].confidence >= 0.5;
  }
  const auto across = [&](const Vec3& left, const Vec3& right) {
    Vec3 v = floor.linear() * (left - right);
    v.y() = 0.0;
    return v;
  };
  const auto l = static_cast<std::size_t>(BodyJoint::kLeftShoulder);
  const auto r = static_cast<std::size_t>(BodyJoint::kRightShoulder);
  const Vec3 shoulders = across(tracked.joints[l].position, tracked.joints[r].position);
  match.back = shoulders.dot(across(truth[l], truth[r])) < 0.0 && shoulders.norm() > 0.12;
  return match;
}

double apart(const Joints& truth, const SkeletonFrame& tracked) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < kBodyJointCount; ++j) sum += tracked.joints[j].position - truth[j];
  return sum.norm() / static_cast<double>(kBodyJointCount);
}

/// Matches tracked to true people, the nearest pair first. @return index of the tracked person of each true one, or -1
std::vector<int> matchPeople(const RealRecording& recording, int frame, std::span<const Seen> seen) {
  std::vector<int> result(recording.people.size(), -1);
  std::vector<bool> used(seen.size());
  for (;;) {
    double min = kSamePlace;
    std::size_t bestTruth = 0, bestSeen = 0;
    for (std::size_t b = 0; b < result.size(); ++b) {
      const auto truth = recording.people[b].find(frame);
      if (result[b] >= 0 || truth == recording.people[b].end()) continue;
      for (std::size_t a = 0; a < seen.size(); ++a) {
        const double distance = apart(truth->second, seen[a].joints);
        if (used[a] || distance >= min) continue;
        min = distance;
        bestTruth = b;
        bestSeen = a;
      }
    }
    if (min == kSamePlace) return result;
    result[bestTruth] = static_cast<int>(bestSeen);
    used[bestSeen] = true;
  }
}

/// True pixels of a frame, as labels; empty if they are not known.
using MaskOf = std::function<std::span<const std::uint8_t>(int frame)>;

/// Intersection over union of the labels of all people and the mask; NaN if either is empty.
double overlapOf(std::span<const std::uint8_t> mask, std::span<const std::uint8_t> labels) {
  int both = 0, either = 0, truths = 0, mine = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool truth = mask[i] > 0, label = labels[i] > 0 && labels[i] < 255;
    both += static_cast<int>(truth && label);
    either += static_cast<int>(truth || label);
    truths += static_cast<int>(truth);
    mine += static_cast<int>(label);
  }
  return truths == 0 || mine == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(both) / either;
}

/// Whether a joint is seen farther than kOutside from every true pixel.
bool isOutside(const DepthCamera& camera, std::span<const std::uint8_t> mask, const Vec3& joint) {
  const Eigen::Vector2d at = camera.imagePointOf(joint);
  const double reach = kOutside * camera.focalX() / std::max(0.3, -joint.z());
  const int left = std::max(0, static_cast<int>(at.x() - reach)), top = std::max(0, static_cast<int>(at.y() - reach));
  const int right = std::min(camera.width - 1, static_cast<int>(at.x() + reach));
  const int bottom = std::min(camera.height - 1, static_cast<int>(at.y() + reach));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      if (mask[static_cast<std::size_t>(y) * camera.width + x] == 0) continue;
      if (std::hypot(x + 0.5 - at.x(), y + 0.5 - at.y()) <= reach) return false;
    }
  }
  return true;
}

/// How far tracked people are from marks. Each marked person takes the nearest tracked one, the nearest pair first.
void compareMarks(const DepthCamera& camera, std::span<const std::vector<MarkedJoint>> people,
                  std::span<const Seen> seen, std::vector<MarkError>& errors) {
  struct Pair {
    double apart;
    std::size_t person, one;
    std::vector<MarkError> errors;
  };
  std::vector<Pair> pairs;
  const Eigen::Vector2d middle(0.5 * camera.width, 0.5 * camera.height);
  for (std::size_t p = 0; p < people.size(); ++p) {
    std::vector<double> depths;
    depths.reserve(people[p].size());
    for (const MarkedJoint& mark : people[p]) depths.push_back(mark.depth);
    const double usual = atRank(depths, 0.5);
    for (std::size_t s = 0; s < seen.size(); ++s) {
      Pair& pair = pairs.emplace_back(Pair{0.0, p, s, {}});
      std::vector<double> apart;
      apart.reserve(people[p].size());
      pair.errors.reserve(people[p].size());
      for (const MarkedJoint& mark : people[p]) {
        const TrackedJoint& joint = seen[s].joints[mark.joint];
        // What is measured beside a thin limb is behind it.
        const double depth = std::abs(mark.depth - usual) > kOtherDepth ? usual : mark.depth;
        const Eigen::Vector2d off = camera.imagePointOf(joint.position) - middle - mark.fromMiddle;
        pair.errors.push_back({mark.joint, off * depth / camera.focalX(), joint.confidence >= 0.5});
        apart.push_back(pair.errors.back().off.norm());
      }
      pair.apart = atRank(apart, 0.5);
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::apart);
  std::vector<bool> takenPerson(people.size()), takenOne(seen.size());
  for (const Pair& pair : pairs) {
    if (pair.apart > kOtherPlace || takenPerson[pair.person] || takenOne[pair.one]) continue;
    takenPerson[pair.person] = takenOne[pair.one] = true;
    errors.insert(errors.end(), pair.errors.begin(), pair.errors.end());
  }
}

/// Where people mark a joint is not quite where the model has it: subtracts the mean of those who are cut out.
void subtractDefinitions(std::span<const RealRecording> recordings,
                         std::span<std::optional<Result<Measured>>> measured) {
  std::array<Eigen::Vector2d, kBodyJointCount> sum;
  std::array<int, kBodyJointCount> count{};
  sum.fill(Eigen::Vector2d::Zero());
  for (const bool subtract : {false, true}) {
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      if (!measured[i] || !*measured[i] || (!subtract && recordings[i].kind != "cutout")) continue;
      for (MarkError& error : (*measured[i])->marks) {
        const auto j = static_cast<std::size_t>(error.joint);
        if (subtract && count[j] > 0) {
          error.off -= sum[j] / count[j];
        } else if (!subtract) {
          sum[j] += error.off;
          ++count[j];
        }
      }
    }
  }
}

/// The masks that lie beside a recording, of every tenth frame.
MaskOf masksBeside(const RealRecording& recording, const RealVariant& variant) {
  if (variant.sways) return {};
  return [&recording, variant, pixels = std::vector<std::uint8_t>()](int frame) mutable {
    const fs::path file =
        recording.file.parent_path() / "masks" / fmt::format("{}_{:04}.png", recording.name, frame + variant.start);
    pixels.clear();
    if (!fs::exists(file)) return std::span<const std::uint8_t>(pixels);
    const Result<Image> image = readPng(file);
    if (!image) return std::span<const std::uint8_t>(pixels);
    for (std::size_t i = 0; i < image->rgba.size(); i += 4) pixels.push_back(image->rgba[i]);
    if (variant.mirror) {
      for (auto row = pixels.begin(); row != pixels.end(); row += image->width) std::reverse(row, row + image->width);
    }
    return std::span<const std::uint8_t>(pixels);
  };
}

/// Tracked joints in red, recorded ones in green.
Image pictureOf(const DepthCamera& camera, const DepthFrame& depth, std::span<const std::uint8_t> labels,
                const RealRecording& recording, int frame, std::span<const Seen> seen) {
  std::vector<DrawnSkeleton> skeletons;
  for (const std::map<int, Joints>& person : recording.people) {
    const auto truth = person.find(frame);
    if (truth != person.end()) skeletons.push_back({truth->second, {}, kTrueColour});
  }
  for (const Seen& one : seen) skeletons.push_back(trackedSkeleton(one.joints));
  return depthOverlay(camera, depth.depthMm, labels, skeletons);
}

Result<Measured> track(DepthSource& source, const RealRecording& recording, const Joints& offsets,
                       const RealOptions& options, const MaskOf& maskOf) {
  Result<Tracker> tracker = Tracker::create(source.camera());
  if (!tracker) return tracker.error();
  Measured measured;
  std::optional<TrackLog> log;
  if (!options.results.empty()) {
    Result<TrackLog> created = TrackLog::create(options.results / recording.name);
    if (!created) return created.error();
    log.emplace(std::move(*created));
  }
  std::vector<int> user(recording.people.size());
  std::vector<std::optional<Seen>> before(recording.people.size());
  std::vector<int> first(recording.people.size(), -1);
  std::vector<Image> pictures;
  std::vector<std::string> captions;
  DepthFrame depth;
  for (int frame = 0;; ++frame) {
    const Result<DepthRead> read = source.next(depth);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    const double begin = threadSeconds();
    const std::span<const TrackedPerson> people = tracker->track(depth);
    measured.ms.push_back(1e3 * (threadSeconds() - begin));
    std::vector<Seen> seen;
    for (const TrackedPerson& person : people) {
      seen.push_back({person.skeleton.user, moved(person.skeleton, tracker->floorFromCamera().inverse())});
    }
    if (log) log->add(frame, people, *tracker);
    if (!options.pictures.empty() && frame % options.pictureStep == 0) {
      pictures.push_back(pictureOf(source.camera(), depth, tracker->labels(), recording, frame, seen));
      captions.push_back(fmt::format("{}", frame));
    }

    const bool settled = (frame - recording.firstFrame) * recording.frameSeconds >= kSettled;
    const std::vector<int> found = matchPeople(recording, frame, seen);
    const std::span<const std::uint8_t> mask = maskOf ? maskOf(frame) : std::span<const std::uint8_t>();
    if (const auto marks = recording.marks.find(frame); marks != recording.marks.end()) {
      compareMarks(source.camera(), marks->second, seen, measured.marks);
    }
    int extra = static_cast<int>(seen.size());
    for (std::size_t b = 0; b < found.size(); ++b) {
      const auto truth = recording.people[b].find(frame);
      if (truth == recording.people[b].end()) continue;
      ++measured.frames;
      measured.settledFrames += static_cast<int>(settled);
      if (found[b] < 0) {
        before[b].reset();
        continue;
      }
      --extra;
      const Seen& one = seen[static_cast<std::size_t>(found[b])];
      Match match = compare(truth->second, one.joints, offsets, recording.floorFromCamera);
      match.settled = settled;
      for (std::size_t j = 0; j < kBodyJointCount && recording.kind == "composed"; ++j) {
        match.hidden[j] = isOutside(source.camera(), mask, truth->second[j]);
      }
      measured.matches.push_back(match);
      if (first[b] < 0) first[b] = frame;
      if (user[b] != 0 && user[b] != one.user) {
        measured.exchanges += static_cast<int>(std::ranges::count(user, one.user) > 0);
      }
      user[b] = one.user;
      const auto truthBefore = recording.people[b].find(frame - 1);
      if (before[b] && before[b]->user == one.user && truthBefore != recording.people[b].end()) {
        ++measured.steps;
        for (std::size_t j = 0; j < kBodyJointCount; ++j) {
          const double moved = (one.joints.joints[j].position - before[b]->joints.joints[j].position).norm();
          measured.pops +=
              static_cast<int>(moved > kJump && (truth->second[j] - truthBefore->second[j]).norm() < kStill);
        }
      }
      before[b] = one;
      for (const TrackedJoint& joint : one.joints.joints) {
        if (mask.empty() || joint.confidence < 0.5) continue;
        ++measured.sureSeen;
        measured.sureOutside += static_cast<int>(isOutside(source.camera(), mask, joint.position));
      }
    }
    if (recording.people.empty()) {
      // Only the number of people is known.
      const int followed = std::min(extra, recording.peopleVisible);
      measured.frames += recording.peopleVisible;
      measured.settledFrames += settled ? recording.peopleVisible : 0;
      for (int i = 0; i < followed; ++i) {
        measured.matches.push_back({settled, false, {}, {}});
      }
      if (followed > 0 && measured.first < 0) measured.first = frame;
      extra -= followed;
    }
    measured.falseFrames += static_cast<int>(extra > 0);
    measured.lateFalseFrames += static_cast<int>(extra > 0 && settled);
    const double overlap = mask.empty() ? std::nan("") : overlapOf(mask, tracker->labels());
    if (!std::isnan(overlap)) measured.overlaps.push_back(overlap);
  }
  if (!first.empty()) measured.first = std::ranges::max(first);
  if (!pictures.empty()) {
    const fs::path file = options.pictures / (recording.name + ".png");
    if (Result<void> written = writePng(file, contactSheet(pictures, captions, 4)); !written) return written.error();
  }
  if (log) {
    if (Result<void> done = log->finish(); !done) return done.error();
  }
  return measured;
}

Result<Measured> trackReal(const RealRecording& recording, const Joints& offsets, const RealOptions& options) {
  Result<std::unique_ptr<OniFile>> source = openOni(recording.file);
  if (!source) return source.error();
  const std::unique_ptr<DepthSource> shown = altered(std::move(*source), options.variant);
  return track(*shown, altered(recording, options.variant), altered(offsets, options.variant), options,
               masksBeside(recording, options.variant));
}

/// Real people in composed rooms.
Result<Measured> trackComposed(ComposedRoom& room, const Joints& offsets, const RealOptions& options) {
  if (options.variant.mirror) {
    for (std::vector<std::uint8_t>& mask : room.masks) {
      for (auto row = mask.begin(); row != mask.end(); row += room.camera.width)
        std::reverse(row, row + room.camera.width);
    }
  }
  const std::unique_ptr<DepthSource> shown = altered(sourceOf(room), options.variant);
  return track(*shown, altered(room.truth, options.variant), altered(offsets, options.variant), options,
               [&](int frame) { return std::span<const std::uint8_t>(room.masks[frame + options.variant.start]); });
}

constexpr const char* kColumns =
    "recording,frames,followed_percent,first_frame,median_mm,p95_mm,limb_off_percent,sure_percent,sure_off_percent,"
    "back_percent,false_frames,after_1s_followed_percent,after_1s_median_mm,after_1s_p95_mm,after_1s_limb_off_percent,"
    "after_1s_sure_off_percent,after_1s_back_percent,after_1s_false_frames,exchanges,overlap,sure_outside_percent,pops_"
    "in_1000,cpu_ms_mean,cpu_ms_p99,marked_limbs,marked_limbs_off_percent,marked_limbs_sure,marked_limbs_sure_off_"
    "percent";

void print(const std::string& name, const Measured& m, bool joints) {
  std::string row = fmt::format("{}", name);
  const auto part = [&](bool late) {
    std::vector<double> errors;
    int followed = 0, limbOff = 0, back = 0, sure = 0, sureOff = 0;
    for (const Match& match : m.matches) {
      if (late && !match.settled) continue;
      ++followed;
      back += static_cast<int>(match.back);
      bool off = false;
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        const auto joint = static_cast<BodyJoint>(j);
        if (match.hidden[j]) continue;
        errors.push_back(1e3 * match.error[j]);
        const bool wrong = match.error[j] > kOff;
        const bool limb = joint != BodyJoint::kHead && joint != BodyJoint::kNeck && joint != BodyJoint::kTorso;
        off = off || (limb && wrong);
        sure += static_cast<int>(match.sure[j]);
        sureOff += static_cast<int>(match.sure[j] && wrong);
      }
      limbOff += static_cast<int>(off);
    }
    const auto percent = [](int count, double of) { return of > 0 ? 100.0 * count / of : 0.0; };
    const int frames = late ? m.settledFrames : m.frames;
    if (!late) row += fmt::format(",{}", frames);
    row += fmt::format(",{:.1f}", percent(followed, frames));
    if (!late) row += fmt::format(",{}", m.first);
    if (joints) {
      row +=
          fmt::format(",{:.0f},{:.0f},{:.1f}", atRank(errors, 0.5), atRank(errors, 0.95), percent(limbOff, followed));
      if (!late) row += fmt::format(",{:.1f}", percent(sure, followed * double{kBodyJointCount}));
      row += fmt::format(",{:.1f},{:.1f}", percent(sureOff, sure), percent(back, followed));
    } else {
      row += late ? ",,,,," : ",,,,,,";
    }
    row += fmt::format(",{}", late ? m.lateFalseFrames : m.falseFrames);
  };
  part(false);
  part(true);
  row += fmt::format(",{},{},{},{:.0f},{:.1f},{:.1f}", m.exchanges,
                     m.overlaps.empty() ? std::string() : fmt::format("{:.2f}", meanOf(m.overlaps)),
                     m.sureSeen == 0 ? std::string() : fmt::format("{:.2f}", 100.0 * m.sureOutside / m.sureSeen),
                     1e3 * m.pops / std::max(1, m.steps), meanOf(m.ms), atRank(m.ms, 0.99));
  std::array<int, 2> marked{}, markedOff{};  // limb joints: all; those that are sure
  for (const MarkError& error : m.marks) {
    if (std::ranges::find(kLimbJoints, error.joint) == kLimbJoints.end()) continue;
    for (std::size_t sure = 0; sure <= static_cast<std::size_t>(error.sure); ++sure) {
      ++marked[sure];
      markedOff[sure] += static_cast<int>(error.off.norm() > kOff);
    }
  }
  for (std::size_t i = 0; i < marked.size(); ++i) {
    row += marked[i] == 0 ? ",0," : fmt::format(",{},{:.1f}", marked[i], 100.0 * markedOff[i] / marked[i]);
  }
  fmt::print("{}\n", row);
  std::fflush(stdout);
}

void add(const Measured& one, Measured& sum) {
  sum.marks.insert(sum.marks.end(), one.marks.begin(), one.marks.end());
  sum.frames += one.frames;
  sum.settledFrames += one.settledFrames;
  sum.matches.insert(sum.matches.end(), one.matches.begin(), one.matches.end());
  sum.first = std::max(sum.first, one.first);
  sum.falseFrames += one.falseFrames;
  sum.lateFalseFrames += one.lateFalseFrames;
  sum.exchanges += one.exchanges;
  sum.sureSeen += one.sureSeen;
  sum.sureOutside += one.sureOutside;
  sum.steps += one.steps;
  sum.pops += one.pops;
  sum.overlaps.insert(sum.overlaps.end(), one.overlaps.begin(), one.overlaps.end());
  sum.ms.insert(sum.ms.end(), one.ms.begin(), one.ms.end());
}

}  // namespace

Result<void> measureRealPeople(const fs::path& folder, const RealOptions& options) {
  Result<std::vector<RealRecording>> read =
      readRealRecordings(folder, options.composed > 0 ? std::vector<std::string>() : options.names);
  if (!read) return read.error();
  std::vector<RealRecording>& recordings = *read;
  const Result<Joints> offsets = readOffsets(folder / "offsets.json");
  if (!offsets) return offsets.error();
  const std::size_t count = options.composed > 0 ? static_cast<std::size_t>(options.composed) : recordings.size();
  std::vector<RealRecording> composed(count);
  std::vector<std::optional<Result<Measured>>> measured(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (options.composed > 0) {
      Result<ComposedRoom> room = composeRoom(recordings, i);
      measured[i] = room ? trackComposed(*room, *offsets, options) : room.error();
      if (room) composed[i] = std::move(room->truth);
    } else {
      measured[i] = trackReal(recordings[i], *offsets, options);
    }
  });
  if (options.composed > 0) recordings = std::move(composed);
  subtractDefinitions(recordings, measured);
  const auto hasJoints = [&](std::size_t i) { return !recordings[i].people.empty(); };

  fmt::print("{}\n", kColumns);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (!measured[i]) continue;
    if (!*measured[i]) return measured[i]->error();
    print(recordings[i].name, **measured[i], hasJoints(i));
  }
  const auto total = [&](const char* name, const auto& belongs) {
    Measured sum;
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      if (measured[i] && belongs(i)) add(**measured[i], sum);
    }
    if (sum.frames > 0) print(name, sum, !sum.matches.empty());
  };
  // Those whose first word ends in 2 have nothing missing around the people.
  const auto isComplete = [&](std::size_t i) { return recordings[i].name.find("2_") == 1; };
  for (const char* kind : {"cutout", "A", "B", "C", "composed"}) {
    total(kind, [&](std::size_t i) { return recordings[i].kind == kind && !isComplete(i); });
  }
  total("without a ring", isComplete);
  if (options.composed > 0) return {};
  total("all rooms", [&](std::size_t i) { return hasJoints(i) && recordings[i].kind != "cutout"; });
  total("all", hasJoints);
  return {};
}

}  // namespace lorica::bench
