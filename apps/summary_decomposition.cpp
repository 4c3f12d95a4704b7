#include "acd/decomposition_file.h"
#include "apps/file_summary.h"
#include "apps/report_parts.h"
#include "collision/hulls/cover_choice.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

std::string point(const Vec3& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
}

std::string volumeText(double volume) {
  return std::isfinite(volume) ? fmt::format("{:.6g}", volume) : "too large to be measured";
}

namespace fs = std::filesystem;

constexpr int kRowsInFull = 32;
constexpr std::size_t kBonesShown = 3;

/// Levels of detail: the first 32, then in steps of one eighth, and the last. --json has all of them.
Table levelTable(const std::vector<DetailLevel>& detailLevels, bool animated) {
  Table table{{"parts", "error", "hull vertices"}, {}};
  if (animated) table.headings.insert(table.headings.begin() + 2, "worst keyframe");
  int next = 1;
  const int all = countOf(detailLevels);
  for (int n = 1; n <= all; ++n) {
    if (n < next && n != all) continue;
    next = n < kRowsInFull ? n + 1 : n + n / 8;
    const DetailLevel& level = detailLevels[n - 1];
    std::vector<std::string> row = {grouped(n), percent(level.meanError), grouped(level.hullVertices)};
    if (animated) row.insert(row.begin() + 2, percent(level.worstError));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The mesh triangles that a part came from, ascending and unique: a part may hold several pieces of a cut triangle.
std::vector<std::int32_t> sourceTriangles(const Part& part) {
  std::vector<std::int32_t> sources = part.sourceTriangle;
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  if (!sources.empty() && sources.front() < 0) sources.erase(sources.begin());  // -1, the caps
  return sources;
}

/// "leftUpperArm 62 %, chest 30 %, hips 5 %"
std::string bonesText(const std::vector<BoneShare>& bones) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(bones.size(), kBonesShown); ++i) {
    words.push_back(fmt::format("{} {:.0f} %", bones[i].bone, 100.0 * bones[i].share));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The origin of each of the first parts; --json has all of them.
Table originTable(const DecompositionFile& content) {
  const std::vector<Part>& parts = content.decomposition.parts;
  Table table{{"part", "source triangles", "triangles"}, {}, 3};
  if (!content.bonesOfPart.empty()) table.headings.push_back("bones, by share of the surface");
  for (std::size_t i = 0; i < std::min<std::size_t>(parts.size(), kRowsInFull); ++i) {
    table.rows.push_back(
        {std::to_string(i), grouped(std::ssize(sourceTriangles(parts[i]))), grouped(std::ssize(parts[i].triangles))});
    if (!content.bonesOfPart.empty()) table.rows.back().push_back(bonesText(content.bonesOfPart[i]));
  }
  return table;
}

Json partsToJson(const DecompositionFile& content) {
  Json parts = Json::array();
  for (std::size_t i = 0; i < content.decomposition.parts.size(); ++i) {
    const Part& part = content.decomposition.parts[i];
    Json json;
    json["splitFrom"] = i == 0 ? Json() : Json(content.decomposition.splitFrom[i - 1]);
    json["triangles"] = part.triangles.size();
    json["sourceTriangles"] = sourceTriangles(part);
    if (!content.bonesOfPart.empty()) {
      json["bones"] = Json::array();
      for (const BoneShare& bone : content.bonesOfPart[i]) {
        json["bones"].push_back({{"name", bone.bone}, {"share", bone.share}});
      }
    }
    parts.push_back(std::move(json));
  }
  return parts;
}

/// The hull cover and the training range of an animated decomposition.
void addCoverAndTraining(const DecompositionFile& content, Report& report) {
  report.add(coverFacts(content.cover));
  if (!content.training) {
    report.add("training", "training", {}, "not in the file");
    return;
  }
  const TrainingRange& training = *content.training;
  report.add(
      "training", "training",
      {{"probes", training.probes.size()},
       {"keyframes", training.keyframeCount},
       {"knownDistance", training.knownDistance}},
      fmt::format("{}, {}; training range {:.2f} m around each keyframe", counted(std::ssize(training.probes), "probe"),
                  counted(training.keyframeCount, "keyframe"), training.knownDistance));
}

}  // namespace

Result<Report> describeDecomposition(const fs::path& file) {
  LORICA_TRY(const DecompositionFile content, readDecomposition(file));
  const Decomposition& made = content.decomposition;
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  const bool animated = content.errorPerKeyframe.size() > 1;
  const std::string name = file.filename().string();

  Report report(name + ": a decomposition",
                "kind name source meshHash vertices triangles parts cutPoints error errorPerKeyframe cover training");
  report.add("kind", "decomposition");
  report.add("name", name);
  report.add("source", "source mesh", content.source,
             fmt::format("{}: {}, {}", content.source, counted(made.vertexCount, "vertex", "vertices"),
                         counted(made.triangleCount, "triangle")));
  report.add("meshHash", hexDigits(content.meshHash));
  report.add("vertices", made.vertexCount);
  report.add("triangles", made.triangleCount);
  report.add("parts", "parts", made.parts.size());
  report.add("cutPoints", "cut points", made.cutPoints.size());
  report.add("errorPerKeyframe", "keyframes", content.errorPerKeyframe, grouped(std::ssize(content.errorPerKeyframe)));
  report.add("error", "error", content.meanError,
             fmt::format("hulls have {} more volume than the mesh{}", percent(content.meanError),
                         animated ? ", mean over the keyframes" : ""));
  report.add("hash", "hash", hexDigits(hashOf(made)));
  report.add("bytes", "file", bytes, fmt::format("{} bytes", grouped(bytes)));
  Json levels = Json::array();
  for (std::size_t i = 0; i < content.detailLevels.size(); ++i) {
    const DetailLevel& level = content.detailLevels[i];
    levels.push_back({{"parts", i + 1},
                      {"error", level.meanError},
                      {"worstError", level.worstError},
                      {"hullVertices", level.hullVertices}});
  }
  if (!levels.empty()) report.table(levelTable(content.detailLevels, animated));
  report.add("detailLevels", "levels of detail", levels, levels.empty() ? "not in the file" : "");
  report.add("partOrigins", partsToJson(content));
  report.table(originTable(content));
  if (made.parts.size() > kRowsInFull) report.note("The tables do not show all rows; --json does.");
  if (animated || content.training || content.cover || !content.bonesOfPart.empty()) {
    addCoverAndTraining(content, report);
  }
  return report;
}

Report describeMesh(const Subject& subject) {
  const TriMesh& mesh = subject.mesh;
  const Aabb box = boundsOf(mesh.vertices);
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  const double hullVolume = convexHullVolume(mesh.vertices, 1e-7);
  const Result<void> closed = checkClosedTwoManifold(mesh);

  const char* kind = subject.character ? "character" : "mesh";
  Report report(fmt::format("{}: a {}", subject.name, kind), "kind name vertices triangles components closed");
  report.add("kind", kind);
  report.add("name", subject.name);
  report.add("vertices", "vertices", mesh.vertices.size());
  report.add("triangles", "triangles", mesh.triangles.size());
  report.add("components", "components", connectedComponents(mesh.vertices.size(), mesh.triangles).count);
  report.add("repaired", "repaired", orNull(subject.repaired));
  const bool measurable = std::isfinite(volume) && std::isfinite(hullVolume) && std::isfinite(box.diagonal());
  const std::string problem = closed ? "" : closed.error().message;
  const char* remedy = measurable ? "; `lorica decompose` builds a closed body around it" : "";
  report.add("closed", "closed", closed.ok(), closed ? "yes, it can be decomposed" : "no: " + problem + remedy);
  report.add("problem", orNull(problem));
  report.add("volume", "volume", std::isfinite(volume) ? Json(volume) : Json(), volumeText(volume));
  report.add("hullVolume", "hull volume", measurable ? Json(hullVolume) : Json(),
             measurable ? volumeText(hullVolume) : "too large to be measured");
  const bool compared = closed && hullVolume > 0.0;
  const double convexity = compared ? volume / hullVolume : 0.0;
  report.add("convexity", "convexity", compared ? Json(convexity) : Json(),
             compared ? fmt::format("{:.4f} (volume / hull volume)", convexity) : "");
  if (box.empty()) {
    report.add("boundingBox", nullptr);
  } else {
    report.add("boundingBox", "bounding box",
               {{box.min.x(), box.min.y(), box.min.z()}, {box.max.x(), box.max.y(), box.max.z()}},
               fmt::format("{} to {}", point(box.min), point(box.max)));
    if (std::isfinite(box.diagonal())) report.line("diagonal", fmt::format("{:.6g}", box.diagonal()));
  }
  return report;
}

}  // namespace lorica
