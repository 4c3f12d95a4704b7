#include "apps/file_summary.h"
#include "capture/retarget/skeletal_retarget.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

void addJoints(const Motion& motion, Facts& facts) {
  std::size_t seen = 0, guessed = 0, unknown = 0;
  for (const SkeletonFrame& frame : motion.joints) {
    for (const TrackedJoint& joint : frame.joints) {
      ++(joint.confidence >= 1.0 ? seen : joint.confidence > 0.0 ? guessed : unknown);
    }
  }
  const double all = static_cast<double>(motion.joints.size()) * kBodyJointCount;
  facts.report.line("user", std::to_string(motion.joints.front().user));
  facts.report.line(
      "joints",
      fmt::format("{}: {} seen, {} guessed, {} unknown", kBodyJointCount, percent(static_cast<double>(seen) / all),
                  percent(static_cast<double>(guessed) / all), percent(static_cast<double>(unknown) / all)));
  facts.json["user"] = motion.joints.front().user;
  facts.json["jointsSeen"] = static_cast<double>(seen) / all;
  facts.json["jointsGuessed"] = static_cast<double>(guessed) / all;
  facts.json["jointsUnknown"] = static_cast<double>(unknown) / all;
}

void addBones(const Skeleton& skeleton, Facts& facts) {
  const auto bones = std::count_if(skeleton.joints().begin(), skeleton.joints().end(),
                                   [](const Joint& joint) { return joint.bone.has_value(); });
  facts.report.line("joints", fmt::format("{}, {} of them humanoid bones", skeleton.jointCount(), bones));
  const Result<std::vector<HumanBone>> atRest = bonesLeftAtRest(skeleton);
  std::string retargeting = "any humanoid can perform it";
  if (!atRest) {
    retargeting = "only characters with the same joints: " + atRest.error().message;
  } else if (!atRest->empty()) {
    std::vector<std::string_view> names;
    names.reserve(atRest->size());
    for (const HumanBone bone : *atRest) names.push_back(nameOf(bone));
    retargeting += fmt::format("; it lacks {}, which stay at rest", fmt::join(names, ", "));
  }
  facts.report.line("retargeting", retargeting);
  facts.json["joints"] = skeleton.jointCount();
  facts.json["humanoidBones"] = bones;
  facts.json["retargetable"] = atRest.ok();
}

}  // namespace

Facts describeMotion(const Motion& motion) {
  const double seconds = motion.seconds();
  const double rate = seconds > 0.0 ? (motion.frameCount() - 1) / seconds : 0.0;
  Facts facts{
      Report(fmt::format("{}: {}", motion.name, motion.bones ? "a motion of a skeleton" : "a recording of joints")),
      {}};
  facts.report.line("format", motion.format);
  facts.report.line("length", fmt::format("{:.2f} s", seconds));
  facts.report.line("frames", fmt::format("{} at {:.1f} a second", grouped(motion.frameCount()), rate));
  Json& json = facts.json;
  json["kind"] = motion.bones ? "motion" : "recording";
  json["name"] = motion.name;
  json["format"] = motion.format;
  json["seconds"] = seconds;
  json["frames"] = motion.frameCount();
  json["framesPerSecond"] = rate;
  if (motion.bones) {
    addBones(motion.bones->skeleton, facts);
  } else {
    addJoints(motion, facts);
  }
  for (const std::string& note : motion.notes) facts.report.note(note);
  json["notes"] = motion.notes;
  return facts;
}

}  // namespace lorica
