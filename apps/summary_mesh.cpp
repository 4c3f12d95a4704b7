#include "apps/file_summary.h"
#include "geometry/convex_hull.h"
#include "geometry/text.h"

#include <fmt/format.h>

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

}  // namespace

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
