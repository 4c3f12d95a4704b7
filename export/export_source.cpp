#include "export/export_source.h"

#include "acd/held_vertices.h"
#include "collision/hulls/mesh_subject.h"
#include "collision/live/attached_vertices.h"
#include "collision/live/live_body.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/body.h"
#include "session/prepare/training_motions.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// What a .lorica file was made from: a built-in character, or a file next to it.
std::string sourceNextTo(const fs::path& lorica, const std::string& source) {
  return isBareName(source) ? source : (lorica.parent_path() / fs::path(source).filename()).string();
}

/// Hulls within a budget.
Result<PartHulls> limited(std::span<const ConvexHull> hulls, const HullBudget& budget, Host& host) {
  Task task(host, "Making hulls", "hulls");
  PartHulls made = simplifyHulls(hulls, budget, host.threads, task.progress());
  if (host.cancelled()) return cancelled();
  return made;
}

}  // namespace

Result<ExportSource> readExportSource(const ExportSourceOptions& options, Host& host) {
  std::string input = options.input;
  std::string decomposition = options.decomposition;
  if (lowerCase(fs::path(input).extension().string()) == ".lorica") {
    if (!decomposition.empty()) {
      return invalidArgument("{}: IN is a decomposition already, expected no --decomposition", input);
    }
    LORICA_TRY(const DecompositionFile content, readDecomposition(input));
    decomposition = input;
    input = sourceNextTo(input, content.source);
    if (!isBareName(input) && !fs::exists(input)) {
      return notFound("{}: made from {}, which is not beside it; expected `lorica export {} OUT --decomposition {}`",
                      decomposition, content.source, content.source, decomposition);
    }
  }
  LORICA_TRY(Subject subject, readSubject(input, options.reading, host));
  if (subject.character && (options.parts > 0 || options.preset)) {
    const char* given = options.parts > 0 ? "--parts" : "--preset";
    return invalidArgument(
        "{} is for meshes, but {} is a character: expected `lorica decompose {} {} ... -o FILE.lorica`, then "
        "--decomposition FILE.lorica",
        given, subject.name, input, given);
  }
  ExportSource source{input, std::move(subject), {}};
  if (!decomposition.empty()) {
    LORICA_TRY(source.content, readDecompositionOf(source.subject, decomposition));
  } else if (source.subject.character && !options.divided) {
    source.content.decomposition.vertexCount = countOf(source.subject.mesh.vertices);
    source.content.decomposition.triangleCount = countOf(source.subject.mesh.triangles);
  } else if (source.subject.character) {
    LORICA_TRY(CachedDecomposition made, defaultDecomposition(source.subject, host));
    source.content = std::move(made.file);
  } else {
    return divideMesh(std::move(source.subject), options, host);
  }
  return source;
}

Result<ExportSource> divideMesh(Subject subject, const ExportSourceOptions& options, Host& host) {
  DecomposeSettings settings;
  settings.maxParts = options.parts > 0 ? options.parts : kExportParts;
  // Hulls that hold every vertex may be larger than their parts.
  settings.maxConcavity = 0.99 * options.maxConcavity * concavityUnitOf(subject);
  if (options.preset) settings.preset = *options.preset;
  settings.threads = host.threads;
  LORICA_TRY(CachedDecomposition made, meshDecomposition(subject.name, subject.mesh, settings, host));
  return ExportSource{options.input, std::move(subject), std::move(made.file)};
}

Result<PartHulls> restHulls(const ExportSource& source, const HullBudget& budget, Host& host) {
  const Subject& subject = source.subject;
  const Decomposition& decomposition = source.content.decomposition;
  const std::vector<std::vector<PointIndex>> attached =
      subject.character ? attachedVerticesOf(decomposition, liftPoints(*subject.character, decomposition))
                        : assignHeldVertices(decomposition, subject.mesh.vertices, subject.held);
  LORICA_TRY(PartHulls hulls,
             limited(hullsIn(withHeldVertices(decomposition, attached), subject.mesh.vertices), budget, host));
  LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(hulls, subject.mesh.vertices, verticesToHold(subject))));
  return hulls;
}

Result<PartHulls> hullsAt(const ExportSource& source, const std::string& motion, const MotionOptions& reading,
                          double at, const HullBudget& budget, Host& host) {
  const Character& character = *source.subject.character;
  LORICA_TRY(const Motion read, readMotion(motion, reading, host));
  if (!(at <= read.seconds())) {
    return invalidArgument("--at {:g}: {} lasts {:g} s, expected 0 to that", at, read.name, read.seconds());
  }
  LORICA_TRY(const SkeletalMotion performed, performedBy(character, read, reading.joints()));
  Pose pose = restPose(character.skeleton);
  poseAt(performed, performed.times.front() + at, pose);
  std::vector<Affine3> bones(pose.size());
  computeWorldFromJoint(character.skeleton, pose, bones);
  computeWorldFromModel(character, bones, bones);
  LORICA_TRY(LiveBody body, LiveBody::create(source.content.decomposition, character, source.content.cover));
  body.update(bones);

  std::vector<ConvexHull> hulls;
  for (const LivePart& part : body.parts()) hulls.push_back(worldHull(part));
  return limited(hulls, budget, host);
}

Result<CoverPoses> exportPoses(const Subject& subject) {
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  return coverPoses(*subject.character, training.motions);
}

}  // namespace lorica
