#include "capture/files/joint_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kMaxPeople = 64;
constexpr double kStep = 1.0 / 30.0;  ///< between frames of nobody [s]
constexpr double kLost = 0.5;         ///< longest gap in which a person counts as there [s]

/// Appends frames of nobody between two times, neither included.
void addNobody(double from, double to, std::vector<SkeletonFrame>& frames) {
  for (int i = 1; from + (i + 0.5) * kStep < to; ++i) {
    SkeletonFrame frame;
    frame.user = kNobody;
    frame.time = from + i * kStep;
    frames.push_back(frame);
  }
}

/// Fills the time in which a person is not there. @param begin, end  of everybody [s]
void fillAbsences(double begin, double end, std::vector<SkeletonFrame>& frames) {
  std::vector<SkeletonFrame> filled;
  double last = begin - kStep;
  for (SkeletonFrame& frame : frames) {
    if (frame.time - last > kLost || filled.empty()) addNobody(last, frame.time, filled);
    last = frame.time;
    filled.push_back(std::move(frame));
  }
  addNobody(last, std::max(end, last) + kStep, filled);
  frames = std::move(filled);
}

}  // namespace

Result<std::vector<JointStream>> readJointStreamOfAll(const std::filesystem::path& file,
                                                      const JointStreamSettings& settings) {
  const Result<JointStream> one = readJointStream(file, settings);
  if (!one) return one.error();
  if (one->people.size() > kMaxPeople) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: found {} people, expected at most {}", file.string(),
                                                          one->people.size(), kMaxPeople)};
  }
  std::vector<JointStream> all;
  JointStreamSettings known = settings;
  known.format = one->format;
  Vec3 middle = Vec3::Zero();
  double start = std::numeric_limits<double>::infinity();
  for (const int person : one->people) {
    known.person = person;
    Result<JointStream> stream = readJointStream(file, known);
    if (!stream) return stream.error();
    middle += stream->origin / static_cast<double>(one->people.size());
    start = std::min(start, stream->start);
    all.push_back(std::move(*stream));
  }
  middle.y() = 0.0;
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (JointStream& stream : all) {
    const Vec3 moved(stream.origin.x() - middle.x(), 0.0, stream.origin.z() - middle.z());  // each on the floor
    for (SkeletonFrame& frame : stream.frames) {
      frame.time += stream.start - start;
      for (TrackedJoint& joint : frame.joints) {
        if (joint.confidence > 0.0) joint.position += moved;
      }
    }
    begin = std::min(begin, stream.frames.front().time);
    end = std::max(end, stream.frames.back().time);
  }
  for (JointStream& stream : all) fillAbsences(begin, end, stream.frames);
  return all;
}

}  // namespace lorica
