#include "apps/export_report.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace lorica {
namespace {

std::string growthOf(const HullExport& hulls) {
  if (hulls.maxVertices == hulls.maxVerticesBefore) return fmt::format("at most {}", hulls.maxVertices);
  return fmt::format("at most {}, before {}; volume +{}", hulls.maxVertices, hulls.maxVerticesBefore,
                     percent(hulls.totalGrowth - 1.0));
}

std::vector<std::string> row(const std::string& name, const ColliderFit& fit) {
  return {name,
          millimetres(fit.worstOut),
          millimetres(fit.meanWorstOut),
          percent(fit.shareOut),
          millimetres(fit.meanStandOff),
          millimetres(fit.worstStandOff),
          fmt::format("{:.1f}", 1e3 * fit.volume)};
}

nlohmann::ordered_json jsonOf(const ColliderFit& fit) {
  nlohmann::ordered_json json;
  json["worstOut"] = fit.worstOut;
  json["meanWorstOut"] = fit.meanWorstOut;
  json["shareOut"] = fit.shareOut;
  json["meanStandOff"] = fit.meanStandOff;
  json["worstStandOff"] = fit.worstStandOff;
  json["volume"] = fit.volume;
  return json;
}

}  // namespace

ExportReport::ExportReport(const Subject& subject, const std::string& output) : text(subject.name) {
  json["input"] = subject.name;
  json["output"] = output;
  text.line("output", output);
}

void ExportReport::add(const HullExport& hulls) {
  text.line("hulls", std::to_string(hulls.objects.size()));
  text.line("hull vertices", growthOf(hulls));
  json["hulls"] = hulls.objects.size();
  json["maxVertices"] = hulls.maxVertices;
  json["growth"] = hulls.totalGrowth;
}

void ExportReport::add(const RigidExport& rigid) {
  std::set<JointIndex> bones;
  std::size_t most = 0;
  for (const RigidCollider& collider : rigid.colliders) {
    bones.insert(collider.joint);
    most = std::max(most, collider.hull.vertices.size());
  }
  text.line("hulls", fmt::format("{} on {}, each rigid on one", rigid.colliders.size(), counted(bones.size(), "bone")));
  text.line("hull vertices", fmt::format("at most {}", most));
  text.line("fit", rigid.heldOutPoses > 0 ? fmt::format("measured in {}; made from {} others",
                                                        counted(rigid.heldOutPoses, "pose"), rigid.trainingPoses)
                                          : fmt::format("measured in the {} that they were made from",
                                                        counted(rigid.trainingPoses, "pose")));
  Table table{{"", "skin out, worst", "mean of poses", "skin out > 1 mm", "stands off, mean", "worst", "litres"}, {}};
  table.rows.push_back(row("hulls", rigid.fits.hulls));
  table.rows.push_back(row("capsules", rigid.fits.capsules));
  text.table(std::move(table));
  text.note("Capsules: one around the surface of each hull, for comparison.");
  constexpr double kFarOff = 0.3;  // [m]
  if (rigid.fits.hulls.worstStandOff > kFarOff) {
    note(
        {fmt::format("A hull stands off by {:.2f} m: its part holds what moves apart, such as a cape and a leg. "
                     "--per-bone, or --hide NAME for what physics need not touch, makes tighter ones.",
                     rigid.fits.hulls.worstStandOff)});
  }
  json["hulls"] = rigid.colliders.size();
  json["bones"] = bones.size();
  json["maxVertices"] = most;
  json["trainingPoses"] = rigid.trainingPoses;
  json["heldOutPoses"] = rigid.heldOutPoses;
  json["fit"]["hulls"] = jsonOf(rigid.fits.hulls);
  json["fit"]["capsules"] = jsonOf(rigid.fits.capsules);
}

void ExportReport::add(const RigidModel& model) {
  double mass = 0.0;
  std::size_t hinges = 0;
  for (const RigidBody& body : model.bodies) {
    mass += body.mass;
    hinges += body.hinges.size();
  }
  text.line("bodies",
            fmt::format("{}, {:.4g} kg, {} between them", model.bodies.size(), mass, counted(hinges, "hinge")));
  note(model.notes);
  json["bodies"] = model.bodies.size();
  json["mass"] = mass;
  json["hinges"] = hinges;
}

void ExportReport::add(const RobotReport& robot) {
  text.line("written", fmt::format("{} with shapes for {} meshes", counted(robot.files, "file"), robot.meshes));
  Table table{{kRobotHeadings.begin(), kRobotHeadings.end()}, {}};
  for (const RobotLinkReport& link : robot.links) {
    table.rows.push_back(link.cells());
    json["links"].push_back({{"name", link.name}, {"shapes", link.shapes}, {"volumes", link.volumes}});
    json["links"].back().update({{"covered", link.covered}, {"standOff", link.standOff}});
  }
  text.table(std::move(table));
  json["newContacts"] = robot.newContacts;
  note(robot.notes);
}

void ExportReport::addSprings(int shapes, int springs) {
  text.line("colliders", fmt::format("{} for {}", shapes, counted(springs, "spring")));
  json["springColliders"] = shapes;
}

void ExportReport::note(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) {
    text.note(sentence);
    json["notes"].push_back(sentence);
  }
}

std::vector<std::string> colliderNames(const Character& character, std::span<const RigidCollider> colliders) {
  std::map<JointIndex, int> count;
  std::vector<std::string> names;
  for (const RigidCollider& collider : colliders) {
    names.push_back(fmt::format("{}_{}", character.skeleton.joint(collider.joint).name, count[collider.joint]++));
  }
  return names;
}

std::vector<NamedMesh> namedHulls(const Character& character, std::span<const RigidCollider> colliders) {
  const std::vector<std::string> names = colliderNames(character, colliders);
  std::vector<NamedMesh> meshes;
  for (std::size_t i = 0; i < colliders.size(); ++i) meshes.push_back({names[i], colliders[i].hull});
  return meshes;
}

}  // namespace lorica
