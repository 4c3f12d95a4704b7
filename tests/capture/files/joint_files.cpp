#include "tests/capture/files/joint_files.h"

#include "capture/files/joint_csv.h"
#include "geometry/files.h"
#include "tests/support/datasets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica::test {
namespace {

using J = BodyJoint;

constexpr std::array<std::string_view, 25> kKinect2Names = {
    "SpineBase",   "SpineMid",      "Neck",         "Head",       "ShoulderLeft", "ElbowLeft", "WristLeft",
    "HandLeft",    "ShoulderRight", "ElbowRight",   "WristRight", "HandRight",    "HipLeft",   "KneeLeft",
    "AnkleLeft",   "FootLeft",      "HipRight",     "KneeRight",  "AnkleRight",   "FootRight", "SpineShoulder",
    "HandTipLeft", "ThumbLeft",     "HandTipRight", "ThumbRight"};
constexpr std::array<std::string_view, 20> kKinect1Names = {
    "HipCenter", "Spine",         "ShoulderCenter", "Head",       "ShoulderLeft", "ElbowLeft", "WristLeft",
    "HandLeft",  "ShoulderRight", "ElbowRight",     "WristRight", "HandRight",    "HipLeft",   "KneeLeft",
    "AnkleLeft", "FootLeft",      "HipRight",       "KneeRight",  "AnkleRight",   "FootRight"};

std::string number(double value, bool comma = false) {
  // Like C# writes a float: the shortest text that reads back, 0.00001 as 1E-05.
  std::string text = fmt::format("{}", static_cast<float>(value));
  std::replace(text.begin(), text.end(), 'e', 'E');
  if (comma) std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

}  // namespace

Vec3 sensorFromWorld(const Vec3& p) {
  return {-p.x(), p.y() - 1.1, 3.2 - p.z()};
}

KinectBody kinectBodyOf(const SkeletonFrame& frame) {
  const auto at = [&](J j) { return frame[j].position; };
  const auto turned = [&](J j, const Vec3& v) { return Vec3(frame[j].orientation.value_or(Quat::Identity()) * v); };
  KinectBody body;
  body[0] = 0.5 * (at(J::kLeftHip) + at(J::kRightHip));
  body[1] = at(J::kTorso);
  body[2] = at(J::kNeck);
  body[3] = at(J::kHead);
  body[20] = at(J::kNeck) - turned(J::kTorso, Vec3(0, 0.06, 0));
  for (std::size_t side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1.0 : -1.0;
    const auto joint = [&](J left) { return static_cast<J>(static_cast<std::size_t>(left) + side); };
    body[4 + 4 * side] = at(joint(J::kLeftShoulder));
    body[5 + 4 * side] = at(joint(J::kLeftElbow));
    body[6 + 4 * side] = at(joint(J::kLeftElbow)) + 0.8 * (at(joint(J::kLeftHand)) - at(joint(J::kLeftElbow)));
    body[7 + 4 * side] = at(joint(J::kLeftHand));
    body[12 + 4 * side] = at(joint(J::kLeftHip));
    body[13 + 4 * side] = at(joint(J::kLeftKnee));
    body[14 + 4 * side] = at(joint(J::kLeftFoot));
    body[15 + 4 * side] = at(joint(J::kLeftFoot)) + turned(joint(J::kLeftFoot), Vec3(0, -0.05, 0.14));
    body[21 + 2 * side] = at(joint(J::kLeftHand)) + turned(joint(J::kLeftHand), Vec3(sign * 0.1, 0, 0));
    body[22 + 2 * side] = at(joint(J::kLeftHand)) + turned(joint(J::kLeftHand), Vec3(sign * 0.04, 0, 0.05));
  }
  for (Vec3& position : body) position = sensorFromWorld(position);
  return body;
}

std::span<const std::string_view> kinect2Names() {
  return kKinect2Names;
}

std::vector<Vec3> kinect1BodyOf(const SkeletonFrame& frame) {
  const KinectBody body = kinectBodyOf(frame);
  std::vector<Vec3> first(body.begin(), body.begin() + 20);
  return first;
}

Vec3 landmarkOf(const SkeletonFrame& frame, int landmark) {
  const std::string_view name = kLandmarks[landmark];
  const bool left = name.find("left") != std::string_view::npos;
  const auto has = [&](auto... words) { return ((name.find(words) != std::string_view::npos) || ...); };
  const J joint = has("shoulder")                                            ? J::kLeftShoulder
                  : has("elbow")                                             ? J::kLeftElbow
                  : has("wrist", "pinky", "_index", "thumb") && !has("foot") ? J::kLeftHand
                  : has("hip")                                               ? J::kLeftHip
                  : has("knee")                                              ? J::kLeftKnee
                  : has("ankle", "heel", "foot")                             ? J::kLeftFoot
                                                                             : J::kHead;
  const int right = joint == J::kHead || left ? 0 : 1;
  Vec3 at = frame.joints[static_cast<int>(joint) + right].position;
  if (has("ear")) at.x() += left ? 0.07 : -0.07;
  if (has("nose", "eye", "mouth")) at.z() += 0.1;
  if (has("foot")) at += Vec3(0, -0.06, 0.15);
  const Vec3 from = at - 0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position);
  return {from.x(), -from.y(), -from.z()};
}

std::string msrFile(std::span<const SkeletonFrame> frames) {
  // Left and right shoulder, neck, spine, hips, hip centre, elbows, wrists, hands, knees, ankles, feet, head.
  constexpr std::array<std::size_t, 20> kOrder = {4, 8, 2, 1, 12, 16, 0, 5, 9, 6, 10, 7, 11, 13, 17, 14, 18, 15, 19, 3};
  std::string text;
  for (const SkeletonFrame& frame : frames) {
    const KinectBody body = kinectBodyOf(frame);
    for (const std::size_t j : kOrder) {
      const bool derived = j < 3 || j == 15 || j == 19;
      text += fmt::format("{:.6f} {:.6f} {:.6f} {:.6f}\n", body[j].x(), body[j].y(), body[j].z(), derived ? 0.0 : 1.0);
    }
  }
  return text;
}

std::string utKinectFile(std::span<const SkeletonFrame> frames, std::span<const int> numbers) {
  std::string text;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    text += fmt::format("{:.6f} ", static_cast<double>(numbers[f]));
    for (const Vec3& p : kinect1BodyOf(frames[f])) text += fmt::format("{:.6f} {:.6f} {:.6f} ", p.x(), p.y(), p.z());
    text += '\n';
  }
  return text;
}

std::string bodiesFile(std::span<const BodiesRow> rows) {
  std::string text;
  for (const BodiesRow& row : rows) {
    text += fmt::format("{:.3f}|kb,{},6,25", 1e-7 * static_cast<double>(row.ticks), row.ticks);
    for (std::size_t b = 0; b < 6; ++b) {
      if (row.bodies[b] == nullptr) {
        text += ",0";
        continue;
      }
      text += fmt::format(",1,{}", row.ids[b]);
      const KinectBody body = kinectBodyOf(*row.bodies[b]);
      for (std::size_t j = 0; j < body.size(); ++j) {
        const bool hand = j == 6 || j == 7 || j == 10 || j == 11 || j > 20;
        text +=
            fmt::format(",{},{:.7g},{:.7g},{:.7g}", hand ? row.stateOfHands : 2, body[j].x(), body[j].y(), body[j].z());
      }
      text += ",2,3";
    }
    text += '\n';
  }
  return text;
}

std::string wideFile(std::span<const SkeletonFrame> frames, const WideSettings& settings) {
  const std::string d(1, settings.delimiter);
  using Cells = std::vector<std::string>;
  const auto row = [&](const Cells& person, const std::vector<Cells>& joints) {
    Cells cells;
    const auto add = [&](const Cells& more) { cells.insert(cells.end(), more.begin(), more.end()); };
    if (!settings.shuffled) add(person);
    for (const Cells& joint : joints) {
      if (settings.shuffled) {
        add({joint[4], joint[0], joint[2], joint[1], joint[8], joint[3], joint[5], joint[6], joint[7]});
      } else {
        add(joint);
      }
    }
    if (settings.shuffled) add({person[1], person[5], person[2], person[3], person[4], person[0], person[6]});
    return fmt::format("{}\n", fmt::join(cells, d));
  };
  const Cells jointHeader = {"Joint",     "Status",    "PositionX", "PositionY", "PositionZ",
                             "RotationW", "RotationX", "RotationY", "RotationZ"};
  std::string text = row({"EventIndex", "Time", "SkeletonId", "HandLeftConfidence", "HandLeftState",
                          "HandRightConfidence", "HandRightState"},
                         std::vector<Cells>(25, jointHeader));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const KinectBody body = kinectBodyOf(frames[f]);
    std::vector<Cells> joints;
    for (std::size_t j = 0; j < body.size(); ++j) {
      const auto n = [&](double v) { return number(v, settings.decimalCommas); };
      // Head, feet, hand tips and thumbs have no rotation: four zeros.
      const bool end = j == 3 || j == 15 || j == 19 || j > 20;
      const Quat q =
          end ? Quat(0, 0, 0, 0) : Quat(Eigen::AngleAxisd(0.3 + 0.1 * double(j), Vec3(1, 2, 3).normalized()));
      joints.push_back({std::string(kKinect2Names[j]), j == 7 ? "INFERRED" : "TRACKED", n(body[j].x()), n(body[j].y()),
                        n(body[j].z()), n(q.w()), n(q.x()), n(q.y()), n(q.z())});
    }
    const auto ticks = static_cast<std::int64_t>(std::llround(frames[f].time * 1e7));
    text +=
        row({std::to_string(f), std::to_string(90000000 + ticks), "72057594037935056", "HIGH", "OPEN", "LOW", "CLOSED"},
            joints);
  }
  return text;
}

std::string longFile(std::span<const SkeletonFrame> frames, int leaveOut, bool decimalCommas) {
  std::string text = "Time(ms),JointType,X,Y,Z\n";
  int row = 0;
  for (const SkeletonFrame& frame : frames) {
    const std::vector<Vec3> body = kinect1BodyOf(frame);
    for (std::size_t j = 0; j < body.size(); ++j) {
      if (leaveOut > 0 && ++row % leaveOut == 0) continue;
      text += fmt::format("{},{},{},{},{}\n", std::llround(1000.0 * frame.time), kKinect1Names[j],
                          number(body[j].x(), decimalCommas), number(body[j].y(), decimalCommas),
                          number(body[j].z(), decimalCommas));
    }
  }
  return text;
}

std::string plainFile(std::span<const SkeletonFrame> frames, bool decimalCommas) {
  std::string text;
  for (const SkeletonFrame& frame : frames) {
    const KinectBody body = kinectBodyOf(frame);
    for (std::size_t j = 0; j < body.size(); ++j) {
      text += fmt::format("{}{};{};{}", j == 0 ? "" : ";", number(body[j].x(), decimalCommas),
                          number(body[j].y(), decimalCommas), number(body[j].z(), decimalCommas));
    }
    text += '\n';
  }
  return text;
}

std::string upperBodyFile(std::span<const SkeletonFrame> frames, bool leftFirst) {
  std::string text;
  for (const SkeletonFrame& frame : frames) {
    std::string row;
    for (const std::size_t arm : {leftFirst ? 0 : 1, leftFirst ? 1 : 0}) {
      for (const J joint : {J::kLeftShoulder, J::kLeftElbow, J::kLeftHand}) {
        const Vec3 p = sensorFromWorld(frame.joints[static_cast<std::size_t>(joint) + arm].position);
        row += fmt::format("{}{:.6f},{:.6f},{:.6f}", row.empty() ? "" : ",", p.x(), p.y(), p.z());
      }
    }
    text += row + '\n';
  }
  return text;
}

std::string niteFile(std::span<const SkeletonFrame> frames, bool orientations, double ticksPerSecond) {
  std::string text;
  for (const SkeletonFrame& frame : frames) {
    text += fmt::format("{},{}", frame.time * ticksPerSecond, frame.user);
    for (const TrackedJoint& joint : frame.joints) {
      const Vec3 p = 1000.0 * sensorFromWorld(joint.position);
      text += fmt::format(",{:.3f},{:.3f},{:.3f},{}", p.x(), p.y(), p.z(), joint.confidence);
      if (!orientations) continue;
      // Half a turn about Y on both sides converts the world's axes to the sensor's.
      const Quat half(0, 0, 1, 0);
      const Quat q = half.conjugate() * joint.orientation.value_or(Quat::Identity()) * half;
      text += joint.orientation ? fmt::format(",{:.7f},{:.7f},{:.7f},{:.7f}", q.x(), q.y(), q.z(), q.w()) : ",,,,";
    }
    text += '\n';
  }
  return text;
}

std::vector<JointFile> oneOfEach(std::span<const SkeletonFrame> frames) {
  std::vector<int> numbers;
  std::vector<BodiesRow> bodies;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    numbers.push_back(100 + 2 * static_cast<int>(f));
    BodiesRow row{.ticks = 43271723768560000 + static_cast<std::int64_t>(std::llround(frames[f].time * 1e7))};
    row.bodies[3] = &frames[f];
    bodies.push_back(row);
  }
  const TemporaryFolder folder;
  const std::filesystem::path lorica = folder.path() / "lorica.csv";
  const Result<void> written = writeJointCsv(lorica, frames);
  return {{JointFormat::kLorica, written ? readFile(lorica).value() : written.error().message},
          {JointFormat::kMsrAction3d, msrFile(frames)},
          {JointFormat::kUtKinect, utKinectFile(frames, numbers)},
          {JointFormat::kKinect2Bodies, bodiesFile(bodies)},
          {JointFormat::kKinect2Wide, wideFile(frames)},
          {JointFormat::kKinect1Long, longFile(frames)},
          {JointFormat::kKinect2Plain, plainFile(frames)},
          {JointFormat::kUpperBody, upperBodyFile(frames)},
          {JointFormat::kNite2, niteFile(frames, true, 1.0)}};
}

std::string inWindowsDress(const std::string& text) {
  std::string dressed = "\xef\xbb\xbf";
  for (const char c : text) {
    if (c == '\n') {
      dressed += "\r\n\r\n   \r\n";
    } else {
      dressed += c;
    }
  }
  return dressed;
}

}  // namespace lorica::test
