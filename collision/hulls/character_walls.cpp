#include "collision/hulls/character_walls.h"

#include "collision/hulls/mesh_walls.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/triangle_tree.h"
#include "skinning/body/body_assembly.h"
#include "skinning/body/transfer_weights.h"
#include "skinning/body/weld.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

std::vector<Influence> influencesOf(const Character& character, VertexIndex v) {
  return {character.influences.begin() + character.influenceBegin[v],
          character.influences.begin() + character.influenceBegin[v + 1]};
}

/// Those of the nearest point of the sheets, for each vertex of their walls.
std::vector<std::vector<Influence>> weightsOfWalls(const Character& character, const TriMesh& sheets,
                                                   const TriMesh& walls) {
  const TriangleTree tree(sheets.vertices, sheets.triangles);
  std::vector<std::vector<Influence>> weights;
  weights.reserve(walls.vertices.size());
  for (const Vec3& p : walls.vertices) {
    const TriangleTree::Hit hit = tree.nearest(p);
    std::array<std::vector<Influence>, 3> lists;
    for (std::size_t i = 0; i < 3; ++i) lists[i] = influencesOf(character, sheets.triangles[hit.triangle][i]);
    weights.push_back(pruned(blended(std::array<const std::vector<Influence>*, 3>{&lists[0], &lists[1], &lists[2]},
                                     std::array{hit.shares[0], hit.shares[1], hit.shares[2]})));
  }
  return weights;
}

/// "Hat (Cone.001) and Cape": the file's meshes that have sheets.
std::string meshesOf(const CharacterFile& file, const std::vector<bool>& sheet) {
  std::vector<std::string> names;
  for (const LookGroup& group : file.look.groups) {
    const auto first = sheet.begin() + static_cast<std::ptrdiff_t>(group.firstTriangle);
    if (std::find(first, first + static_cast<std::ptrdiff_t>(group.triangleCount), true) ==
        first + static_cast<std::ptrdiff_t>(group.triangleCount)) {
      continue;
    }
    const auto named = std::find_if(file.meshNames.begin(), file.meshNames.end(),
                                    [&](const MeshName& name) { return name.mesh == group.mesh; });
    std::string name = named == file.meshNames.end() ? group.mesh : named->text();
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  constexpr std::size_t kMostNames = 5;
  if (names.size() > kMostNames) {
    const std::size_t more = names.size() - kMostNames;
    names.resize(kMostNames);
    names.push_back(fmt::format("{} more", more));
  }
  return names.empty() ? "" : " (of " + listed(names) + ")";
}

}  // namespace

Result<ClosedBody> bodyWithWalls(const CharacterFile& file, const CharacterOptions& options, const MakeRest& makeRest) {
  const Character& character = file.character;
  if (options.walls.value_or(WallChoice::kSolid) == WallChoice::kSolid) {
    if (options.thickness <= 0.0) {
      Result<ClosedBody> solid = makeRest(character);
      const bool flat = solid ? solid->onlySheets : solid.error().code == ErrorCode::kBadMesh;
      if (options.walls || !flat) return solid;
      CharacterOptions thin = options;
      thin.walls = WallChoice::kShell;
      Result<ClosedBody> walls = bodyWithWalls(file, thin, makeRest);
      return walls ? walls : solid;
    }
    return invalidArgument("{}: a thickness is for thin walls, expected --walls auto or shell beside it",
                           character.name);
  }
  LORICA_TRY_DO(checkThickness(character.name, options.thickness, character.mesh.vertices));
  const WallTriangles found = trianglesOfWalls(character.mesh, options);
  if (std::find(found.which.begin(), found.which.end(), true) == found.which.end()) return makeRest(character);

  // Copies of triangles lie where the one lies that is left of them.
  const TriangleTree tree(found.mesh.vertices, found.mesh.triangles);
  Character rest = character;
  rest.mesh.triangles.clear();
  TriMesh sheets{character.mesh.vertices, {}};
  std::vector<bool> sheet;
  sheet.reserve(character.mesh.triangles.size());
  for (const Triangle& t : character.mesh.triangles) {
    const Vec3 middle =
        (character.mesh.vertices[t[0]] + character.mesh.vertices[t[1]] + character.mesh.vertices[t[2]]) / 3.0;
    sheet.push_back(found.which[tree.nearest(middle).triangle]);
    (sheet.back() ? sheets : rest.mesh).triangles.push_back(t);
  }
  CharacterOptions wanted = options;
  wanted.walls = WallChoice::kShell;
  LORICA_TRY(const std::optional<WallBody> walls, prefixed(character.name, makeWalls(sheets, wanted, {})));
  if (!walls) return makeRest(character);

  ClosedBody body;
  if (!rest.mesh.triangles.empty()) {
    LORICA_TRY(body, makeRest(rest));
  }
  TriMesh surface{{}, body.character.mesh.triangles};
  std::vector<std::vector<Influence>> weights;
  surface.vertices.reserve(body.bodyVertices + walls->mesh.vertices.size());
  weights.reserve(body.bodyVertices + walls->mesh.vertices.size());
  for (VertexIndex v = 0; v < body.bodyVertices; ++v) {
    surface.vertices.push_back(body.character.mesh.vertices[v]);
    weights.push_back(influencesOf(body.character, v));
  }
  append(surface, walls->mesh);
  for (std::vector<Influence>& list : weightsOfWalls(character, sheets, walls->mesh)) {
    weights.push_back(std::move(list));
  }
  body.character = assembleBody(character, surface, weights);
  body.made = true;
  body.bodyVertices = countOf(surface.vertices);
  body.distances = distancesInPose(body, std::vector<Affine3>(character.jointFromModel.size(), Affine3::Identity()));
  const double share =
      surfaceArea(sheets.vertices, sheets.triangles) / surfaceArea(character.mesh.vertices, character.mesh.triangles);
  body.walls = fmt::format("{} of {}, {:.0f} % of the surface{}; {}", counted(walls->figures.shells, "thin wall"),
                           millimetres(walls->figures.thickness), 100.0 * share, meshesOf(file, sheet),
                           rest.mesh.triangles.empty() ? "nothing is solid" : "the rest is solid");
  body.notes.push_back(body.walls);
  return body;
}

}  // namespace lorica
