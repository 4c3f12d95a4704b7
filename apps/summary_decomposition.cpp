#include "acd/decomposition_file.h"
#include "apps/cover_options.h"
#include "apps/file_summary.h"
#include "geometry/files.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kRowsInFull = 32;
constexpr std::size_t kBonesShown = 3;

/// Levels of detail: all of the first 32, then in steps of an eighth, and the last. --json has every one.
Table ladderTable(const std::vector<DetailLevel>& ladder, bool animated) {
  Table table{{"parts", "error", "hull vertices"}, {}};
  if (animated) table.headings.insert(table.headings.begin() + 2, "worst keyframe");
  int next = 1;
  const int all = static_cast<int>(ladder.size());
  for (int n = 1; n <= all; ++n) {
    if (n < next && n != all) continue;
    next = n < kRowsInFull ? n + 1 : n + n / 8;
    const DetailLevel& level = ladder[static_cast<std::size_t>(n) - 1];
    std::vector<std::string> row = {grouped(n), percent(level.meanError), grouped(level.hullVertices)};
    if (animated) row.insert(row.begin() + 2, percent(level.worstError));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The mesh triangles that a part came from, ascending: a triangle that was cut has several pieces in it.
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

/// Where each part came from. Of many parts the first; --json has every one.
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

/// What a live body made of it promises, and in which poses it was trained: of what moves.
void addPromise(const DecompositionFile& content, Facts& facts) {
  addCoverTo(facts.report, content.cover);
  addCoverTo(facts.json, content.cover);
  facts.json["training"] = nullptr;
  if (!content.training) {
    facts.report.line("training", "not in the file, which an older Lorica wrote");
    return;
  }
  const TrainingRange& training = *content.training;
  facts.report.line("training", fmt::format("{} in {}; poses up to {:.2f} m from one of these are known",
                                            counted(std::ssize(training.probes), "probe"),
                                            counted(training.keyframeCount, "keyframe"), training.knownDistance));
  facts.json["training"] = {{"probes", training.probes.size()},
                            {"keyframes", training.keyframeCount},
                            {"knownDistance", training.knownDistance}};
}

}  // namespace

Result<Facts> describeDecomposition(const fs::path& file) {
  const Result<DecompositionFile> content = readDecomposition(file);
  if (!content) return content.error();
  const Decomposition& made = content->decomposition;
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  const bool animated = content->errorPerKeyframe.size() > 1;

  Facts facts{Report(file.filename().string() + ": a decomposition"), {}};
  Report& report = facts.report;
  report.line("made from", fmt::format("{}: {} vertices, {} triangles", content->source, grouped(made.vertexCount),
                                       grouped(made.triangleCount)));
  report.line("parts", grouped(std::ssize(made.parts)));
  report.line("cut points", grouped(std::ssize(made.cutPoints)));
  report.line("keyframes", grouped(std::ssize(content->errorPerKeyframe)));
  report.line("error", fmt::format("{} more volume than the mesh{}", percent(content->meanError),
                                   animated ? ", mean over the keyframes" : ""));
  report.line("hash", hexDigits(hashOf(made)));
  report.line("file", fmt::format("{} bytes", grouped(static_cast<long long>(bytes))));
  if (content->ladder.empty()) {
    report.line("ladder", "not in the file, which an older Lorica wrote");
  } else {
    report.table(ladderTable(content->ladder, animated));
  }
  report.table(originTable(*content));
  if (made.parts.size() > kRowsInFull) report.note("The tables leave rows out; --json has all of them.");

  Json& json = facts.json;
  json["kind"] = "decomposition";
  json["name"] = file.filename().string();
  json["source"] = content->source;
  json["meshHash"] = hexDigits(content->meshHash);
  json["vertices"] = made.vertexCount;
  json["triangles"] = made.triangleCount;
  json["parts"] = made.parts.size();
  json["cutPoints"] = made.cutPoints.size();
  json["error"] = content->meanError;
  json["errorPerKeyframe"] = content->errorPerKeyframe;
  if (animated || content->training || content->cover || !content->bonesOfPart.empty()) addPromise(*content, facts);
  json["hash"] = hexDigits(hashOf(made));
  json["bytes"] = bytes;
  json["ladder"] = Json::array();
  for (std::size_t i = 0; i < content->ladder.size(); ++i) {
    const DetailLevel& level = content->ladder[i];
    json["ladder"].push_back({{"parts", i + 1},
                              {"error", level.meanError},
                              {"worstError", level.worstError},
                              {"hullVertices", level.hullVertices}});
  }
  json["partOrigins"] = partsToJson(*content);
  return facts;
}

}  // namespace lorica
