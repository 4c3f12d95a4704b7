#include "session/prepare/played_mesh.h"

#include "geometry/errors.h"
#include "session/prepare/smpl.h"
#include "skinning/morphs/shapes.h"

#include <utility>

namespace lorica {

Result<CharacterFile> playedFile(MeshSequence sequence) {
  const std::span<const Vec3> first = sequence.frame(0);
  TriMesh mesh{{first.begin(), first.end()}, std::move(sequence.triangles)};
  std::vector<double> times;
  for (int f = 0; f < sequence.frameCount(); ++f) times.push_back(f / sequence.framesPerSecond);
  LORICA_TRY(PlayedMesh played, playedMesh(sequence.name, std::move(mesh), sequence.positions, times));
  CharacterFile file;
  file.character = std::move(played.character);
  file.nodeOfJoint.assign(file.character.skeleton.jointCount(), -1);
  if (sequence.frameCount() > 1) {
    played.clip.framesPerSecond = sequence.framesPerSecond;
    file.clips.push_back(std::move(played.clip));
  }
  file.format = kSequence;
  file.meshes = file.primitives = file.maxInfluences = 1;
  file.notes = std::move(sequence.notes);
  return file;
}

Result<CharacterFile> readPlayed(const std::string& input, Host& host, std::vector<std::string> hidden) {
  if (!namesSequence(input)) return readCharacterFile(input, host.characterFiles(std::move(hidden)));
  if (archiveKindOf(input) == ArchiveKind::kSmplModel) return readSmplModel(input);
  if (!hidden.empty()) return invalidArgument("{}: is one mesh in several poses: expected no --hide", input);
  Task task(host, "Reading " + input, "files");
  LORICA_TRY(MeshSequence sequence, readMeshSequence(input, task.progress()));
  return prefixed(input, playedFile(std::move(sequence)));
}

}  // namespace lorica
