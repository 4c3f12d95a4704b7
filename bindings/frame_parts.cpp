#include "bindings/mesh_parts.h"
#include "collision/hulls/frame_hulls.h"
#include "collision/hulls/hull_fit.h"
#include "collision/hulls/mesh_subject.h"
#include "collision/hulls/quality.h"
#include "geometry/errors.h"
#include "session/prepare/subject.h"
#include "session/prepare/training_motions.h"

#include <optional>
#include <utility>

namespace lorica {

Result<MeshParts> partsOfFrames(MeshSequence mesh, const MeshPartsSettings& settings, const CharacterOptions& reading,
                                const EarlierParts* earlier, Host& host) {
  for (const auto& [name, limit] :
       {std::pair{"hull_vertices", settings.hullVertices}, {"hull_planes", settings.hullPlanes}}) {
    if (limit > 0) {
      return invalidArgument("{}: found {} for several frames, whose hulls are exact: expected 0", name, limit);
    }
  }
  mesh.name = "mesh";
  LORICA_TRY(mesh, checkedSequence(std::move(mesh)));
  LORICA_TRY(const Subject subject, sequenceSubject(std::move(mesh), reading, host));
  if (earlier != nullptr) LORICA_TRY_DO(checkMadeFrom(subject, earlier->content, earlier->from));
  const Character& character = *subject.character;
  const std::optional<int> count = settings.keyframes > 0 ? std::optional(settings.keyframes) : std::nullopt;
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const Keyframes keyframes, prefixed("keyframes", trainingKeyframes(character, training, count)));
  FitRequest request{subject, keyframes, nullptr, {}, false, settings.decompose};
  request.settings.maxConcavity = settings.maxConcavity * concavityUnitOf(subject);
  LORICA_TRY(const Fit fit, earlier != nullptr ? fitOf(request, {earlier->content.decomposition, 0.0}, host)
                                               : fitHulls(request, host));
  LORICA_TRY(const SkeletalMotion motion, framesOf(character.skeleton, subject.file->clips.front()));
  Task task(host, "Hulls of the frames", "frames");
  LORICA_TRY(FrameHulls frames,
             hullsOfFrames(character, fit.held, std::span(&motion, 1), settings.decompose.threads, task.progress()));
  MeshParts result;
  result.keyframes = keyframesAmong(frames, {keyframes.positions, countOf(subject.mesh.vertices)});
  result.frames = std::move(frames.hulls);
  result.errors = std::move(frames.errors);
  result.repaired = repairsOf(subject);
  result.warning = doubtAboutHulls(meanErrorOf(result.errors));
  result.content = earlier != nullptr ? earlier->content : fileContent(request, &training, fit);
  return result;
}

}  // namespace lorica
