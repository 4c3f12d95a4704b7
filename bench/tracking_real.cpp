#include "bench/tracking_real.h"

#include "bench/depth_overlay.h"
#include "bench/measure.h"
#include "capture/sensor/oni_source.h"
#include "capture/tracking/track_log.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/files.h"
#include "viewer/image.h"

#include <tbb/parallel_for.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

using Joints = std::array<Vec3, kBodyJointCount>;

constexpr double kOff = 0.15;       ///< a joint with a larger error counts as off [m]
constexpr double kSamePlace = 0.6;  ///< a tracked person farther than this from every true one is a false person [m]
constexpr double kSettled = 1.0;    ///< time after which a person should be followed and false people be gone [s]

/// A recording and what is true in it.
struct Recording {
  std::string name, kind;
  fs::path file;
  int firstFrame = 0;  ///< with a person
  int peopleVisible = 1;
  double frameSeconds = 1.0 / 30.0;
  Isometry3 floorFromCamera = Isometry3::Identity();
  std::vector<std::map<int, Joints>> people;  ///< by frame, camera frame
};

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
};

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Rows of numbers after a header; an empty field is NaN.
std::vector<std::vector<double>> readTable(const std::string& text) {
  std::vector<std::vector<double>> rows;
  for (std::size_t at = text.find('\n'); at != std::string::npos && at + 1 < text.size();) {
    const std::size_t end = std::min(text.find('\n', at + 1), text.size());
    std::string_view line(text.data() + at + 1, end - at - 1);
    std::vector<double> row;
    while (!line.empty()) {
      const std::size_t comma = std::min(line.find(','), line.size());
      double value = std::numeric_limits<double>::quiet_NaN();
      std::from_chars(line.data(), line.data() + comma, value);
      row.push_back(value);
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    if (!row.empty()) rows.push_back(std::move(row));
    at = end < text.size() ? end : std::string::npos;
  }
  return rows;
}

Result<std::map<int, Joints>> readTruth(const fs::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  std::map<int, Joints> frames;
  for (const std::vector<double>& row : readTable(*text)) {
    if (row.size() != 1 + 3 * kBodyJointCount) {
      return Error{ErrorCode::kBadFormat, fmt::format("{}: a row has {} numbers, expected {}", file.string(),
                                                      row.size(), 1 + 3 * kBodyJointCount)};
    }
    Joints& joints = frames[static_cast<int>(row[0])];
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      joints[j] = Vec3(row[1 + 3 * j], row[2 + 3 * j], row[3 + 3 * j]);
    }
  }
  return frames;
}

Result<nlohmann::json> readJson(const fs::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: expected a JSON object", file.string())};
  }
  return json;
}

/// The truth's floor; a level camera 1.2 m up if it has none.
Isometry3 floorOf(const nlohmann::json& json) {
  Isometry3 result = Isometry3::Identity();
  if (!json.contains("floor") || !json["floor"].is_object()) {
    result.translation().y() = 1.2;
    return result;
  }
  const auto normal = json["floor"]["normal"].get<std::vector<double>>();
  const Vec3 up(normal.at(0), normal.at(1), normal.at(2));
  const Vec3 back = (Vec3::UnitZ() - up.z() * up).normalized();
  Eigen::Matrix3d rows;
  rows << up.cross(back).transpose(), up.transpose(), back.transpose();
  result.linear() = rows;
  result.translation().y() = json["floor"]["height"].get<double>();
  return result;
}

Result<Recording> readRecording(const fs::path& json) {
  const Result<nlohmann::json> meta = readJson(json);
  if (!meta) return meta.error();
  Recording recording;
  recording.name = json.stem().string();
  recording.kind = meta->value("kind", std::string());
  recording.file = fs::path(json).replace_extension(".oni");
  recording.firstFrame = meta->value("first_frame_with_person", 0);
  recording.peopleVisible = meta->value("people_visible", 1);
  recording.frameSeconds = meta->value("frame_seconds", 1.0 / 30.0);
  recording.floorFromCamera = floorOf(*meta);
  for (const char* ending : {".joints.csv", ".joints2.csv"}) {
    const fs::path file = fs::path(json).replace_extension() += ending;
    if (!fs::exists(file)) continue;
    Result<std::map<int, Joints>> truth = readTruth(file);
    if (!truth) return truth.error();
    recording.people.push_back(std::move(*truth));
  }
  return recording;
}

/// How the tracker's joints differ from the recorded ones by definition, floor frame.
Result<Joints> readOffsets(const fs::path& file) {
  const Result<nlohmann::json> json = readJson(file);
  if (!json) return json.error();
  Joints offsets;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const std::string name(nameOf(static_cast<BodyJoint>(j)));
    const auto& one = (*json)["metres_floor_frame"][name];
    if (!one.is_array() || one.size() != 3) {
      return Error{ErrorCode::kBadFormat, fmt::format("{}: no offset of `{}`", file.string(), name)};
    }
    offsets[j] = Vec3(one[0].get<double>(), one[1].get<double>(), one[2].get<double>());
  }
  return offsets;
}

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
std::vector<int> matchPeople(const Recording& recording, int frame, std::span<const Seen> seen) {
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

/// Intersection over union of the labels of all people and the mask; NaN if there is no mask or either is empty.
double overlapOf(const fs::path& mask, std::span<const std::uint8_t> labels, int width) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!fs::exists(mask)) return none;
  const Result<Image> image = readPng(mask);
  if (!image || image->width != width) return none;
  int both = 0, either = 0, truths = 0, mine = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool truth = image->rgba[4 * i] > 0, label = labels[i] > 0 && labels[i] < 255;
    both += static_cast<int>(truth && label);
    either += static_cast<int>(truth || label);
    truths += static_cast<int>(truth);
    mine += static_cast<int>(label);
  }
  return truths == 0 || mine == 0 ? none : static_cast<double>(both) / either;
}

/// Tracked joints in red, recorded ones in green.
Image pictureOf(const DepthCamera& camera, const DepthFrame& depth, std::span<const std::uint8_t> labels,
                const Recording& recording, int frame, std::span<const Seen> seen) {
  std::vector<DrawnSkeleton> skeletons;
  for (const std::map<int, Joints>& person : recording.people) {
    const auto truth = person.find(frame);
    if (truth != person.end()) skeletons.push_back({truth->second, {}, {60, 255, 60}});
  }
  for (const Seen& one : seen) {
    DrawnSkeleton& drawn = skeletons.emplace_back();
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      drawn.joints[j] = one.joints.joints[j].position;
      drawn.sure[j] = one.joints.joints[j].confidence >= 0.5;
    }
    drawn.colour = {255, 50, 40};
  }
  return depthOverlay(camera, depth.depthMm, labels, skeletons);
}

Result<Measured> track(const Recording& recording, const Joints& offsets, const RealOptions& options) {
  Result<std::unique_ptr<OniSource>> source = openOni(recording.file);
  if (!source) return source.error();
  Result<Tracker> tracker = Tracker::create((*source)->camera());
  if (!tracker) return tracker.error();
  Measured measured;
  std::optional<TrackLog> log;
  if (!options.results.empty()) {
    Result<TrackLog> created = TrackLog::create(options.results / recording.name);
    if (!created) return created.error();
    log.emplace(std::move(*created));
  }
  std::vector<int> user(recording.people.size());
  std::vector<int> first(recording.people.size(), -1);
  std::vector<Image> pictures;
  std::vector<std::string> captions;
  DepthFrame depth;
  for (int frame = 0;; ++frame) {
    const Result<DepthRead> read = (*source)->next(depth);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    const double before = threadSeconds();
    const std::span<const TrackedPerson> people = tracker->track(depth);
    measured.ms.push_back(1e3 * (threadSeconds() - before));
    std::vector<Seen> seen;
    for (const TrackedPerson& person : people) {
      seen.push_back({person.skeleton.user, moved(person.skeleton, tracker->floorFromCamera().inverse())});
    }
    if (log) log->add(frame, people, *tracker);
    if (!options.pictures.empty() && frame % options.pictureStep == 0) {
      pictures.push_back(pictureOf((*source)->camera(), depth, tracker->labels(), recording, frame, seen));
      captions.push_back(fmt::format("{}", frame));
    }

    const bool settled = (frame - recording.firstFrame) * recording.frameSeconds >= kSettled;
    const std::vector<int> found = matchPeople(recording, frame, seen);
    int extra = static_cast<int>(seen.size());
    for (std::size_t b = 0; b < found.size(); ++b) {
      const auto truth = recording.people[b].find(frame);
      if (truth == recording.people[b].end()) continue;
      ++measured.frames;
      measured.settledFrames += static_cast<int>(settled);
      if (found[b] < 0) continue;
      --extra;
      const Seen& one = seen[static_cast<std::size_t>(found[b])];
      Match match = compare(truth->second, one.joints, offsets, recording.floorFromCamera);
      match.settled = settled;
      measured.matches.push_back(match);
      if (first[b] < 0) first[b] = frame;
      if (user[b] != 0 && user[b] != one.user) {
        measured.exchanges += static_cast<int>(std::ranges::count(user, one.user) > 0);
      }
      user[b] = one.user;
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
    const fs::path mask = recording.file.parent_path() / "masks" / fmt::format("{}_{:04}.png", recording.name, frame);
    const double overlap = overlapOf(mask, tracker->labels(), (*source)->camera().width);
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

constexpr const char* kColumns =
    "recording,frames,followed_percent,first_frame,median_mm,p95_mm,limb_off_percent,sure_percent,sure_off_percent,"
    "back_percent,false_frames,after_1s_followed_percent,after_1s_median_mm,after_1s_p95_mm,after_1s_limb_off_percent,"
    "after_1s_sure_off_percent,after_1s_back_percent,after_1s_false_frames,exchanges,overlap,cpu_ms_mean,cpu_ms_p99";

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
  row += fmt::format(",{},{},{:.1f},{:.1f}", m.exchanges,
                     m.overlaps.empty() ? std::string() : fmt::format("{:.2f}", meanOf(m.overlaps)), meanOf(m.ms),
                     atRank(m.ms, 0.99));
  fmt::print("{}\n", row);
  std::fflush(stdout);
}

void add(const Measured& one, Measured& sum) {
  sum.frames += one.frames;
  sum.settledFrames += one.settledFrames;
  sum.matches.insert(sum.matches.end(), one.matches.begin(), one.matches.end());
  sum.first = std::max(sum.first, one.first);
  sum.falseFrames += one.falseFrames;
  sum.lateFalseFrames += one.lateFalseFrames;
  sum.exchanges += one.exchanges;
  sum.overlaps.insert(sum.overlaps.end(), one.overlaps.begin(), one.overlaps.end());
  sum.ms.insert(sum.ms.end(), one.ms.begin(), one.ms.end());
}

}  // namespace

Result<void> measureRealPeople(const fs::path& folder, const RealOptions& options) {
  std::vector<Recording> recordings;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".json" || !fs::exists(fs::path(entry.path()).replace_extension(".oni"))) continue;
    const auto starts = [&](const std::string& start) { return name.starts_with(start); };
    if (!options.names.empty() && std::ranges::none_of(options.names, starts)) continue;
    Result<Recording> recording = readRecording(entry.path());
    if (!recording) return recording.error();
    recordings.push_back(std::move(*recording));
  }
  if (recordings.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: found no recording NAME.oni with NAME.json", folder.string())};
  }
  std::ranges::sort(recordings, {}, &Recording::name);
  const Result<Joints> offsets = readOffsets(folder / "offsets.json");
  if (!offsets) return offsets.error();
  std::vector<std::optional<Result<Measured>>> measured(recordings.size());
  tbb::parallel_for(std::size_t{0}, recordings.size(),
                    [&](std::size_t i) { measured[i] = track(recordings[i], *offsets, options); });

  fmt::print("{}\n", kColumns);
  const auto hasJoints = [&](std::size_t i) { return !recordings[i].people.empty(); };
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (!*measured[i]) return measured[i]->error();
    print(recordings[i].name, **measured[i], hasJoints(i));
  }
  const auto total = [&](const char* name, const auto& belongs) {
    Measured sum;
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      if (belongs(i)) add(**measured[i], sum);
    }
    if (sum.frames > 0) print(name, sum, !sum.matches.empty());
  };
  for (const char* kind : {"cutout", "A", "B", "C"}) {
    total(kind, [&](std::size_t i) { return recordings[i].kind == kind; });
  }
  total("all rooms", [&](std::size_t i) { return hasJoints(i) && recordings[i].kind != "cutout"; });
  total("all", hasJoints);
  return {};
}

}  // namespace lorica::bench
