#include "capture/files/joint_stream_layouts.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

/// Converts the parsers' output to one person in Lorica's units and axes.
namespace lorica::joints {
namespace {

using J = BodyJoint;

/// Height of the ankles above the floor for the people in sensor recordings and in the shipped ones [m].
constexpr double kAnkleHeight = 0.08;
/// Height of the hips or shoulders if no ankle is ever seen [m].
constexpr double kHipHeight = 0.9;
constexpr double kShoulderHeight = 1.4;
/// Fraction of frames in which the lower ankle is below the floor because of noise and sinking feet.
constexpr double kFloorShare = 0.1;
/// A larger mean lean of the trunk over the whole recording most often comes from a tilted sensor.
constexpr double kLeanDegrees = 15.0;
/// A clock that goes back by more was restarted; by less, rows are out of order [s].
constexpr double kClockRestart = 1.0;
/// Agreement of toes and knees with the front below which a stream is mirrored.
constexpr double kMirrored = -0.5;
/// No recording is longer: about thirty years [s].
constexpr double kLongestRecording = 1e9;

double degreesBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

/// The value below which a fraction `share` of the values lies. @param values  at least one; reordered
double percentile(std::vector<double>& values, double share) {
  const auto nth = values.begin() + static_cast<int>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The steps by which times increase from row to row.
std::vector<double> stepsOf(std::span<const Observation> rows) {
  std::vector<double> steps;
  steps.reserve(rows.size());
  for (int i = 1; i < countOf(rows); ++i) {
    const double step = rows[i].frame.time - rows[i - 1].frame.time;
    if (step > 0.0) steps.push_back(step);
  }
  return steps;
}

/// Seconds per tick that make the row rate nearest to 30 per second.
double guessedTick(std::span<const Observation> rows, std::vector<std::string>& notes) {
  struct Unit {
    double seconds;
    std::string_view name;
  };
  constexpr std::array<Unit, 4> kUnits = {
      {{1.0, "seconds"}, {1e-3, "milliseconds"}, {1e-6, "microseconds"}, {1e-7, "100 ns"}}};
  std::vector<double> steps = stepsOf(rows);
  const double step = steps.empty() ? 1.0 / 30.0 : percentile(steps, 0.5);
  const auto distance = [&](const Unit& unit) { return std::abs(std::log(step * unit.seconds * 30.0)); };
  const Unit& best = *std::min_element(kUnits.begin(), kUnits.end(),
                                       [&](const Unit& a, const Unit& b) { return distance(a) < distance(b); });
  notes.push_back(fmt::format("Times are assumed to be in {}, based on their spacing.", best.name));
  return best.seconds;
}

/// Rows with the same time but different data were read one after the other: distributes them evenly up to the next
/// time.
void spreadRepeats(std::vector<Observation>& rows, std::vector<std::string>& notes) {
  const auto samePositions = [](const SkeletonFrame& a, const SkeletonFrame& b) {
    return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(),
                      [](const TrackedJoint& x, const TrackedJoint& y) { return x.position == y.position; });
  };
  int spread = 0;
  for (int begin = 0; begin < countOf(rows);) {
    const double time = rows[begin].frame.time;
    int end = begin + 1;
    while (end < countOf(rows) && rows[end].frame.time == time && !samePositions(rows[end].frame, rows[end - 1].frame))
      ++end;
    if (end - begin > 1 && end < countOf(rows) && rows[end].frame.time > time) {
      const double step = (rows[end].frame.time - time) / (end - begin);
      for (int i = begin + 1; i < end; ++i) rows[i].frame.time = time + step * (i - begin);
      spread += end - begin - 1;
    }
    begin = end;
  }
  if (spread > 0) {
    notes.push_back(counted(spread, "row repeats a time with different data: it was",
                            "rows repeat a time with different data: they were") +
                    " distributed up to the next time.");
  }
}

/// Converts times to increasing seconds from the first row on.
void repairTimes(std::vector<Observation>& rows, double secondsPerTick, std::vector<std::string>& notes) {
  const double start = rows.front().frame.time;
  for (Observation& row : rows) row.frame.time = (row.frame.time - start) * secondsPerTick;
  std::vector<double> steps = stepsOf(rows);
  const double usualStep = steps.empty() ? 1.0 / 30.0 : percentile(steps, 0.5);
  double added = 0.0;
  int restarts = 0;
  int kept = 1;
  double last = 0.0;
  for (int i = 1; i < countOf(rows); ++i) {
    double time = rows[i].frame.time + added;
    if (time < last - kClockRestart) {
      added += last + usualStep - time;
      time = last + usualStep;
      ++restarts;
    }
    if (!(time > last)) continue;
    last = time;
    rows[i].frame.time = time;
    if (kept != i) rows[kept] = std::move(rows[i]);
    ++kept;
  }
  if (kept < countOf(rows)) {
    notes.push_back(counted(countOf(rows) - kept, "row repeats a time or goes back in time and was",
                            "rows repeat a time or go back in time and were") +
                    " omitted.");
    rows.resize(kept);
  }
  if (restarts > 0) {
    notes.push_back(
        fmt::format("The clock restarts {}: the rows that follow were appended.", counted(restarts, "time")));
  }
}

/// How well toes and knees agree with the front that left, right and up define: 1 all agree, -1 all point backwards.
double frontAgreement(std::span<const Observation> rows) {
  // Min offset of a knee from its leg's line, and length of a foot, for a usable direction [m]. Sensors place the knees
  // of people who stand up to 7 cm behind that line.
  constexpr double kBentKnee = 0.08;
  constexpr double kFoot = 0.05;
  constexpr double kFewest = 5.0;
  constexpr std::array<std::array<J, 3>, 2> kLegs = {
      {{J::kLeftHip, J::kLeftKnee, J::kLeftFoot}, {J::kRightHip, J::kRightKnee, J::kRightFoot}}};
  double sum = 0.0;
  double count = 0.0;
  for (const Observation& row : rows) {
    std::optional<Vec3> left = between(row.frame, J::kRightHip, J::kLeftHip);
    if (!left) left = between(row.frame, J::kRightShoulder, J::kLeftShoulder);
    if (!left) continue;
    for (int side = 0; side < 2; ++side) {
      const auto [hip, knee, foot] = kLegs[side];
      const std::optional<Vec3> thigh = between(row.frame, knee, hip);
      const std::optional<Vec3> leg = between(row.frame, foot, hip);
      if (!thigh || !leg || leg->norm() < kBentKnee) continue;
      const Vec3 front = left->cross(*leg).normalized();
      const Vec3 knees = (leg->dot(*thigh) / leg->squaredNorm()) * *leg - *thigh;
      if (knees.norm() > kBentKnee) {
        sum += front.dot(knees.normalized());
        count += 1.0;
      }
      if (!row.toes[side]) continue;
      const Vec3 toes = *row.toes[side] - row.frame[foot].position;
      if (toes.norm() < kFoot) continue;
      sum += front.dot(toes.normalized());
      count += 1.0;
    }
  }
  return count < kFewest ? 1.0 : sum / count;
}

/// Turns everybody by the quarter turns after which most look to +Z.
void turnToFront(std::vector<Observation>& rows) {
  Vec3 front = Vec3::Zero();
  for (const Observation& row : rows) {
    for (const auto& [right, left] : {std::pair(J::kRightHip, J::kLeftHip), {J::kRightShoulder, J::kLeftShoulder}}) {
      if (const std::optional<Vec3> across = between(row.frame, right, left)) front += across->cross(Vec3::UnitY());
    }
  }
  if (frontAgreement(rows) < kMirrored) front = -front;
  const long quarters = std::lround(std::atan2(front.x(), front.z()) / (0.5 * std::numbers::pi));
  for (long i = 0; i < (4 - quarters) % 4; ++i) {
    changePositions(rows, [](const Vec3& p) { return Vec3(p.z(), p.y(), -p.x()); });
  }
}

/// The height of the lower of two joints; nullopt if none is seen.
std::optional<double> lowerOf(const SkeletonFrame& frame, J left, J right) {
  const std::optional<Vec3> a = seen(frame, left), b = seen(frame, right);
  if (a && b) return std::min(a->y(), b->y());
  return a ? std::optional(a->y()) : b ? std::optional(b->y()) : std::nullopt;
}

/// Hips that never move: the body stands on its lower foot in every frame instead.
void stand(std::vector<Observation>& rows, std::vector<std::string>& notes) {
  double low = 0.0;
  bool stands = false;
  for (Observation& row : rows) {
    const std::optional<double> lower = lowerOf(row.frame, J::kLeftFoot, J::kRightFoot);
    stands = stands || lower;
    low = lower.value_or(low);
    for (TrackedJoint& joint : row.frame.joints) joint.position.y() -= low;
  }
  if (stands) {
    notes.emplace_back("The hips are at 0 in every frame: the body stands on its lower foot, its way is unknown.");
  }
}

/// Removes all orientations if they do not point along the limbs, because they follow another convention.
void checkOrientations(std::vector<Observation>& rows, std::vector<std::string>& notes) {
  constexpr double kMaxDegrees = 25.0;
  struct Limb {
    J from, to;
    Vec3 axis;
  };
  const std::array<Limb, 5> limbs = {{{J::kLeftShoulder, J::kLeftElbow, Vec3::UnitX()},
                                      {J::kRightShoulder, J::kRightElbow, -Vec3::UnitX()},
                                      {J::kLeftHip, J::kLeftKnee, -Vec3::UnitY()},
                                      {J::kRightHip, J::kRightKnee, -Vec3::UnitY()},
                                      {J::kTorso, J::kNeck, Vec3::UnitY()}}};
  std::vector<double> off;
  bool any = false;
  for (const Observation& row : rows) {
    for (const TrackedJoint& joint : row.frame.joints) any = any || joint.orientation.has_value();
    for (const Limb& limb : limbs) {
      const std::optional<Quat>& turn = row.frame[limb.from].orientation;
      const std::optional<Vec3> direction = between(row.frame, limb.from, limb.to);
      if (turn && direction) off.push_back(degreesBetween(*turn * limb.axis, *direction));
    }
  }
  if (!any || (!off.empty() && percentile(off, 0.5) <= kMaxDegrees)) return;
  notes.emplace_back("Orientations do not point along the limbs and were omitted.");
  for (Observation& row : rows) {
    for (TrackedJoint& joint : row.frame.joints) joint.orientation.reset();
  }
}

/// How far the frames must be lowered so that the person stands on y = 0 [m], and from which joints this follows.
double floorHeight(std::span<const Observation> rows, std::vector<std::string>& firstGuess) {
  struct Guess {
    J left, right;
    double height;
    std::string_view name;
  };
  constexpr std::array<Guess, 3> kGuesses = {{{J::kLeftFoot, J::kRightFoot, kAnkleHeight, "ankles"},
                                              {J::kLeftHip, J::kRightHip, kHipHeight, "hips"},
                                              {J::kLeftShoulder, J::kRightShoulder, kShoulderHeight, "shoulders"}}};
  for (const Guess& guess : kGuesses) {
    std::vector<double> heights;
    heights.reserve(rows.size());
    for (const Observation& row : rows) {
      if (const auto lower = lowerOf(row.frame, guess.left, guess.right)) heights.push_back(*lower);
    }
    if (heights.empty()) continue;
    const bool ankles = guess.left == J::kLeftFoot;
    firstGuess.push_back(fmt::format("floor {:g} m below the {} {}", guess.height,
                                     ankles ? "lowest" : "median height of the", guess.name));
    return percentile(heights, ankles ? kFloorShare : 0.5) - guess.height;
  }
  return 0.0;
}

/// Places the person on the floor, with the centre of the covered ground at the origin. @return where that was [m]
Vec3 placeOnFloor(std::vector<Observation>& rows, std::vector<std::string>& firstGuess) {
  const double floor = floorHeight(rows, firstGuess);
  Eigen::AlignedBox3d ground;
  for (const Observation& row : rows) {
    if (const std::optional<Vec3> position = positionOf(row.frame)) ground.extend(*position);
  }
  if (ground.isEmpty()) return Vec3::Zero();
  const Vec3 origin(ground.center().x(), floor, ground.center().z());
  for (Observation& row : rows) {
    for (TrackedJoint& joint : row.frame.joints) {
      joint.position = joint.confidence > 0.0 ? Vec3(joint.position - origin) : Vec3::Zero();
    }
  }
  return origin;
}

void noteLean(std::span<const Observation> rows, std::vector<std::string>& notes) {
  Vec3 trunk = Vec3::Zero();
  for (const Observation& row : rows) {
    const std::optional<Vec3> left = between(row.frame, J::kLeftHip, J::kNeck);
    const std::optional<Vec3> right = between(row.frame, J::kRightHip, J::kNeck);
    if (left && right && left->norm() > 0.0) trunk += (*left + *right).normalized();
  }
  const double lean = degreesBetween(trunk, Vec3::UnitY());
  if (lean <= kLeanDegrees) return;
  notes.push_back(fmt::format("The trunk leans by {:.0f} degrees on average: perhaps the sensor was tilted.", lean));
}

}  // namespace

void flip(std::vector<Observation>& rows, const Vec3& signs) {
  // A rotation mirrored as its axis and angle are: the vector part flips like that of a half turn.
  const Vec3 turn = signs.prod() * signs;
  changePositions(rows, [&](const Vec3& position) { return Vec3(position.cwiseProduct(signs)); });
  for (Observation& row : rows) {
    for (TrackedJoint& joint : row.frame.joints) {
      if (joint.orientation) joint.orientation->vec() = joint.orientation->vec().cwiseProduct(turn);
    }
  }
}

void WayMeter::add(const SkeletonFrame& frame) {
  constexpr double kStep = 0.05;
  ++frames_;
  const std::optional<Vec3> position = positionOf(frame);
  if (!position) return;
  if (!from_) from_ = position;
  const double step = (*position - *from_).norm();
  if (step < kStep) return;
  way_ += step;
  from_ = position;
}

Result<int> choosePerson(const std::map<int, WayMeter>& ways, std::string_view file,
                         const JointStreamSettings& settings, JointStream& stream) {
  stream.people.reserve(ways.size());
  for (const auto& [person, meter] : ways) stream.people.push_back(person);
  if (settings.person) {
    if (ways.contains(*settings.person)) return *settings.person;
    return invalidArgument("{}: found no person {}, expected {}{}", file, *settings.person,
                           ways.size() > 1 ? "one of " : "", fmt::join(stream.people, ", "));
  }
  const auto movesLess = [](const auto& a, const auto& b) {
    if (a.second.way() != b.second.way()) return a.second.way() < b.second.way();
    return a.second.frames() < b.second.frames();
  };
  const int chosen = std::max_element(ways.begin(), ways.end(), movesLess)->first;
  if (ways.size() > 1) {
    stream.notes.push_back(
        fmt::format("The file has {} people; person {} moves most and was selected.", ways.size(), chosen));
  }
  return chosen;
}

Result<JointStream> finish(RawStream raw, JointFormat format, std::string_view file,
                           const JointStreamSettings& settings) {
  JointStream stream;
  stream.format = format;
  stream.notes = std::move(raw.notes);
  std::map<int, WayMeter> ways;
  for (const Observation& row : raw.rows) ways[row.frame.user].add(row.frame);
  LORICA_TRY(const int person, choosePerson(ways, file, settings, stream));
  if (raw.towardsFront) turnToFront(raw.rows);
  std::vector<Observation> rows = std::move(raw.rows);
  std::erase_if(rows, [&](const Observation& row) { return row.frame.user != person; });

  const double tick = raw.secondsPerTick ? *raw.secondsPerTick : guessedTick(rows, stream.notes);
  stream.start = tick * rows.front().frame.time;
  spreadRepeats(rows, stream.notes);
  repairTimes(rows, tick, stream.notes);
  if (rows.back().frame.time > kLongestRecording) {
    return badFormat("{}: found times above {:.3g} s, expected at most {:g} s", file, rows.back().frame.time,
                     kLongestRecording);
  }

  const double unit = layoutOf(format).unit;
  stream.firstGuess.push_back(!raw.unit.empty()
                                  ? raw.unit
                                  : fmt::format("{}metres, as the layout says", unit == 1.0    ? ""
                                                                                : unit == 0.01 ? "centi"
                                                                                               : "milli"));
  stream.firstGuess.push_back((raw.axes.empty() ? "Y is up" : raw.axes) +
                              (raw.towardsFront ? ", turned so that people face +Z"
                               : raw.worldAxes  ? ""
                                                : ", turned from the sensor's axes"));
  // Half a turn about Y makes a person who looks at the sensor face +Z.
  if (!raw.worldAxes) flip(rows, {-1.0, 1.0, -1.0});
  if (frontAgreement(rows) < kMirrored) {
    flip(rows, {-1.0, 1.0, 1.0});
    stream.notes.emplace_back(
        "Toes and knees point backwards relative to left and right: the stream is mirrored and was mirrored back.");
  }
  checkOrientations(rows, stream.notes);
  if (raw.centred) stand(rows, stream.notes);
  stream.origin = placeOnFloor(rows, stream.firstGuess);
  noteLean(rows, stream.notes);

  stream.frames.reserve(rows.size());
  for (Observation& row : rows) stream.frames.push_back(std::move(row.frame));
  const bool anyoneSeen = std::any_of(stream.frames.begin(), stream.frames.end(),
                                      [](const SkeletonFrame& frame) { return positionOf(frame).has_value(); });
  if (!anyoneSeen) {
    return badFormat("{}: found no seen joint in {}, expected at least one", file,
                     counted(std::ssize(stream.frames), "frame"));
  }
  return stream;
}

}  // namespace lorica::joints
