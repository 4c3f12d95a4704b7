#include "acd/decomposition_file.h"
#include "apps/file_summary.h"
#include "apps/report_parts.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "prepare/cover_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

std::string point(const Vec3& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
}

std::string volumeText(double volume) {
  return std::isfinite(volume) ? fmt::format("{:.6g}", volume) : "too large to be measured";
}

/// A number for JSON, which has no infinity.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json();
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

/// Adds the hull cover and the training range of an animated decomposition.
void addCoverAndTraining(const DecompositionFile& content, FileSummary& summary) {
  addCoverTo(summary.report, content.cover);
  addCoverTo(summary.json, content.cover);
  summary.json["training"] = nullptr;
  if (!content.training) {
    summary.report.line("training", "not in the file");
    return;
  }
  const TrainingRange& training = *content.training;
  summary.report.line("training", fmt::format("{}, {}; training range {:.2f} m around each keyframe",
                                              counted(std::ssize(training.probes), "probe"),
                                              counted(training.keyframeCount, "keyframe"), training.knownDistance));
  summary.json["training"] = {{"probes", training.probes.size()},
                              {"keyframes", training.keyframeCount},
                              {"knownDistance", training.knownDistance}};
}

}  // namespace

Result<FileSummary> describeDecomposition(const fs::path& file) {
  LORICA_TRY(const DecompositionFile content, readDecomposition(file));
  const Decomposition& made = content.decomposition;
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  const bool animated = content.errorPerKeyframe.size() > 1;

  FileSummary summary{Report(file.filename().string() + ": a decomposition"), {}};
  Report& report = summary.report;
  report.line("source mesh", fmt::format("{}: {} vertices, {} triangles", content.source, grouped(made.vertexCount),
                                         grouped(made.triangleCount)));
  report.line("parts", grouped(std::ssize(made.parts)));
  report.line("cut points", grouped(std::ssize(made.cutPoints)));
  report.line("keyframes", grouped(std::ssize(content.errorPerKeyframe)));
  report.line("error", fmt::format("hulls have {} more volume than the mesh{}", percent(content.meanError),
                                   animated ? ", mean over the keyframes" : ""));
  report.line("hash", hexDigits(hashOf(made)));
  report.line("file", fmt::format("{} bytes", grouped(bytes)));
  if (content.detailLevels.empty()) {
    report.line("levels of detail", "not in the file");
  } else {
    report.table(levelTable(content.detailLevels, animated));
  }
  report.table(originTable(content));
  if (made.parts.size() > kRowsInFull) report.note("The tables do not show all rows; --json does.");

  Json& json = summary.json;
  json["kind"] = "decomposition";
  json["name"] = file.filename().string();
  json["source"] = content.source;
  json["meshHash"] = hexDigits(content.meshHash);
  json["vertices"] = made.vertexCount;
  json["triangles"] = made.triangleCount;
  json["parts"] = made.parts.size();
  json["cutPoints"] = made.cutPoints.size();
  json["error"] = content.meanError;
  json["errorPerKeyframe"] = content.errorPerKeyframe;
  if (animated || content.training || content.cover || !content.bonesOfPart.empty())
    addCoverAndTraining(content, summary);
  json["hash"] = hexDigits(hashOf(made));
  json["bytes"] = bytes;
  json["detailLevels"] = Json::array();
  for (std::size_t i = 0; i < content.detailLevels.size(); ++i) {
    const DetailLevel& level = content.detailLevels[i];
    json["detailLevels"].push_back({{"parts", i + 1},
                                    {"error", level.meanError},
                                    {"worstError", level.worstError},
                                    {"hullVertices", level.hullVertices}});
  }
  json["partOrigins"] = partsToJson(content);
  return summary;
}

FileSummary describeMesh(const Subject& subject) {
  const TriMesh& mesh = subject.mesh;
  const Aabb box = boundsOf(mesh.vertices);
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  const double hullVolume = convexHullVolume(mesh.vertices, 1e-7);
  const int components = connectedComponents(mesh.vertices.size(), mesh.triangles).count;
  const Result<void> closed = checkClosedTwoManifold(mesh);

  FileSummary summary{Report(subject.name + (subject.character ? ": a character" : ": a mesh")), {}};
  Report& report = summary.report;
  report.line("vertices", grouped(std::ssize(mesh.vertices)));
  report.line("triangles", grouped(std::ssize(mesh.triangles)));
  report.line("components", grouped(components));
  if (!subject.repaired.empty()) report.line("repaired", subject.repaired);
  const bool measurable = std::isfinite(volume) && std::isfinite(hullVolume) && std::isfinite(box.diagonal());
  const char* remedy = measurable ? "; `lorica decompose` builds a closed body around it" : "";
  report.line("closed", closed ? "yes, it can be decomposed" : "no: " + closed.error().message + remedy);
  report.line("volume", volumeText(volume));
  report.line("hull volume", measurable ? volumeText(hullVolume) : "too large to be measured");
  const double convexity = hullVolume > 0.0 ? volume / hullVolume : 0.0;
  if (closed && hullVolume > 0.0) report.line("convexity", fmt::format("{:.4f} (volume / hull volume)", convexity));
  if (!box.empty()) {
    report.line("bounding box", fmt::format("{} to {}", point(box.min), point(box.max)));
    if (std::isfinite(box.diagonal())) report.line("diagonal", fmt::format("{:.6g}", box.diagonal()));
  }

  Json& json = summary.json;
  json["kind"] = subject.character ? "character" : "mesh";
  json["name"] = subject.name;
  json["vertices"] = mesh.vertices.size();
  json["triangles"] = mesh.triangles.size();
  json["components"] = components;
  json["closed"] = closed.ok();
  json["repaired"] = subject.repaired.empty() ? Json() : Json(subject.repaired);
  json["problem"] = closed ? Json() : Json(closed.error().message);
  json["volume"] = finite(volume);
  json["hullVolume"] = measurable ? Json(hullVolume) : Json();
  json["convexity"] = closed && hullVolume > 0.0 ? Json(convexity) : Json();
  json["boundingBox"] =
      box.empty() ? Json() : Json{{box.min.x(), box.min.y(), box.min.z()}, {box.max.x(), box.max.y(), box.max.z()}};
  return summary;
}

}  // namespace lorica
