#include "apps/file_summary.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

void addJoints(const Motion& motion, FileSummary& summary) {
  std::size_t seen = 0, guessed = 0, unknown = 0;
  for (const SkeletonFrame& frame : motion.joints) {
    for (const TrackedJoint& joint : frame.joints) {
      ++(joint.confidence >= 1.0 ? seen : joint.confidence > 0.0 ? guessed : unknown);
    }
  }
  const double all = motion.joints.size() * kBodyJointCount;
  summary.report.line("user", std::to_string(motion.joints.front().user));
  summary.report.line("joints", fmt::format("{}: {} seen, {} guessed, {} unknown", kBodyJointCount, percent(seen / all),
                                            percent(guessed / all), percent(unknown / all)));
  summary.json["user"] = motion.joints.front().user;
  summary.json["jointsSeen"] = seen / all;
  summary.json["jointsGuessed"] = guessed / all;
  summary.json["jointsUnknown"] = unknown / all;
}

void addBones(const Skeleton& skeleton, FileSummary& summary) {
  const auto bones = std::count_if(skeleton.joints().begin(), skeleton.joints().end(),
                                   [](const Joint& joint) { return joint.bone.has_value(); });
  summary.report.line("joints", fmt::format("{}, {} of them humanoid bones", skeleton.jointCount(), bones));
  const Result<std::vector<HumanBone>> atRest = bonesLeftAtRest(skeleton);
  std::string retargeting = "any humanoid can perform it";
  if (!atRest) {
    retargeting = "only for characters with the same joints: " + atRest.error().message;
  } else if (!atRest->empty()) {
    std::vector<std::string_view> names;
    names.reserve(atRest->size());
    for (const HumanBone bone : *atRest) names.push_back(nameOf(bone));
    retargeting += fmt::format("; missing bones stay at rest: {}", fmt::join(names, ", "));
  }
  summary.report.line("retargeting", retargeting);
  summary.json["joints"] = skeleton.jointCount();
  summary.json["humanoidBones"] = bones;
  summary.json["retargetable"] = atRest.ok();
}

}  // namespace

FileSummary describeMotion(const Motion& motion) {
  const double seconds = motion.seconds();
  const double rate = seconds > 0.0 ? (motion.frameCount() - 1) / seconds : 0.0;
  FileSummary summary{
      Report(fmt::format("{}: {}", motion.name, motion.bones ? "a motion of a skeleton" : "a recording of joints")),
      {}};
  summary.report.line("format", motion.format);
  if (!motion.firstGuess.empty()) summary.report.line("first guess", motion.firstGuess);
  summary.report.line("length", fmt::format("{:.2f} s", seconds));
  summary.report.line("frames", fmt::format("{} at {:.1f} per second", grouped(motion.frameCount()), rate));
  Json& json = summary.json;
  json["kind"] = motion.bones ? "motion" : "recording";
  json["name"] = motion.name;
  json["format"] = motion.format;
  json["seconds"] = seconds;
  json["frames"] = motion.frameCount();
  json["framesPerSecond"] = rate;
  if (motion.bones) {
    addBones(motion.bones->skeleton, summary);
  } else {
    addJoints(motion, summary);
  }
  for (const std::string& note : motion.notes) summary.report.note(note);
  json["firstGuess"] = motion.firstGuess;
  json["notes"] = motion.notes;
  return summary;
}

}  // namespace lorica
