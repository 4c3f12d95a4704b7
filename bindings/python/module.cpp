#include "bindings/mesh_parts.h"
#include "bindings/python/arrays.h"
#include "bindings/python/made_only.h"
#include "bindings/python/work.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <optional>
#include <utility>

namespace lorica {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using py::literals::operator""_a;

constexpr int kUsualParts = 16;

using PartsPointer = std::shared_ptr<const MeshParts>;

/// A list in Python: the hulls of a mesh.
struct PartList {
  PartsPointer parts;
};

/// The choice of a name. @param choices  three names, and what they choose
template <typename Choice>
Choice choiceOf(const char* argument, const std::string& name,
                const std::array<std::pair<const char*, Choice>, 3>& choices) {
  for (const auto& [known, choice] : choices) {
    if (name == known) return choice;
  }
  throw py::value_error(fmt::format("{}: found {}, expected {}, {} or {}", argument, name, choices[0].first,
                                    choices[1].first, choices[2].first));
}

/// @param make  from a mesh and settings that report progress
template <typename Make>
PartList makeParts(MeshSequence mesh, MeshPartsSettings settings, const py::object& progress, const Make& make) {
  MeshParts made = resultAside<MeshParts>(progress, [&](const DecomposeProgress& report) {
    settings.decompose.progress = report;
    return make(std::move(mesh), settings);
  });
  warnOf(made.warning);
  return {std::make_shared<const MeshParts>(std::move(made))};
}

PartList decomposeMesh(const py::object& vertices, const py::object& faces, std::optional<int> parts, double maxError,
                       double maxDistance, double maxConcavity, const std::string& preset, int hullVertices,
                       int hullPlanes, const std::string& closedBody, const std::string& walls, double thickness,
                       int threads, const py::object& progress, std::optional<int> keyframes, int candidates) {
  const bool limited = maxError > 0.0 || maxDistance > 0.0 || maxConcavity > 0.0;
  MeshPartsSettings settings;
  settings.decompose.maxParts = parts.value_or(limited ? 0 : kUsualParts);
  settings.decompose.maxError = maxError;
  settings.decompose.maxDistance = maxDistance;
  settings.decompose.preset = choiceOf<DecomposePreset>(
      "preset", preset,
      {{{"paper", DecomposePreset::kPaper}, {"fast", DecomposePreset::kFast}, {"quality", DecomposePreset::kQuality}}});
  settings.decompose.threads = threads;
  settings.hullVertices = hullVertices;
  settings.hullPlanes = hullPlanes;
  settings.closed = choiceOf<BodyChoice>(
      "closed_body", closedBody,
      {{{"auto", BodyChoice::kIfNeeded}, {"never", BodyChoice::kNever}, {"always", BodyChoice::kAlways}}});
  settings.walls = choiceOf<WallChoice>(
      "walls", walls, {{{"auto", WallChoice::kByReach}, {"solid", WallChoice::kSolid}, {"shell", WallChoice::kShell}}});
  settings.thickness = thickness;
  settings.keyframes = keyframes.value_or(0);
  settings.decompose.candidateEdges = candidates;
  if (keyframes && *keyframes < 1)
    throw py::value_error(fmt::format("keyframes: found {}, expected at least 1, or None", *keyframes));
  settings.maxConcavity = maxConcavity;
  return makeParts(meshFrom(vertices, faces), settings, progress, partsOfMesh);
}

PartList loadParts(const fs::path& file, const py::object& vertices, const py::object& faces, int hullVertices,
                   int hullPlanes) {
  MeshPartsSettings settings;
  settings.hullVertices = hullVertices;
  settings.hullPlanes = hullPlanes;
  return makeParts(meshFrom(vertices, faces), settings, py::none(),
                   [&](MeshSequence mesh, const MeshPartsSettings& given) -> Result<MeshParts> {
                     LORICA_TRY(EarlierParts earlier, earlierPartsIn(file));
                     return partsAsBefore(std::move(earlier), std::move(mesh), given);
                   });
}

py::tuple readMeshFile(const fs::path& file) {
  const auto mesh = std::make_shared<const TriMesh>(
      resultAside<TriMesh>(py::none(), [&](const DecomposeProgress&) { return readMesh(file); }));
  const py::capsule owner(new std::shared_ptr<const TriMesh>(mesh),
                          [](void* held) { delete static_cast<std::shared_ptr<const TriMesh>*>(held); });
  return py::make_tuple(view(mesh->vertices, owner), view(mesh->triangles, owner));
}

void addHull(py::module_& module) {
  py::class_<HullView>(module, "Hull", "A convex polyhedron.")
      .def_property_readonly(
          "vertices", [](const py::object& self) { return view(self.cast<const HullView&>().hull->vertices, self); },
          "(n, 3) float64, read-only, no copy. Of a mesh in its unit; of a character in metres, in world space.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return view(self.cast<const HullView&>().hull->triangles, self); },
          "(m, 3) int32, read-only, no copy: triangles, counter-clockwise seen from outside. None while it is flat.")
      .def_property_readonly(
          "volume", [](const HullView& self) { return self.hull->volume; }, "In the cubed unit of the vertices.")
      .def("__repr__", [](const HullView& self) {
        return fmt::format("<lorica.Hull with {}>", counted(std::ssize(self.hull->vertices), "vertex", "vertices"));
      });
}

/// An index from Python, which may count from the end.
std::size_t checkedIndex(py::ssize_t index, std::size_t size, const char* what) {
  const auto count = static_cast<py::ssize_t>(size);
  if (index < -count || index >= count) throw py::index_error(fmt::format("{} {} of {}", what, index, count));
  return static_cast<std::size_t>((index + count) % count);
}

void addParts(py::module_& module) {
  py::class_<PartList>(
      module, "Parts",
      "The convex hulls of a mesh: a sequence of Hull; of a mesh in several frames, those of the first.")
      .def("__len__", [](const PartList& self) { return self.parts->hulls().size(); })
      .def("__getitem__",
           [](const PartList& self, py::ssize_t index) {
             const std::vector<ConvexHull>& hulls = self.parts->hulls();
             return HullView{{self.parts, &hulls[checkedIndex(index, hulls.size(), "part")]}};
           })
      .def("__iter__", [](const PartList& self) { return py::iter(hullList(self.parts->hulls(), self.parts)); })
      .def_property_readonly(
          "hulls", [](const PartList& self) { return hullList(self.parts->hulls(), self.parts); }, "A list of Hull.")
      .def_property_readonly(
          "frame_count", [](const PartList& self) { return self.parts->frames.size(); },
          "1, or as many as the vertices had.")
      .def(
          "frame",
          [](const PartList& self, py::ssize_t index) {
            return hullList(self.parts->frames[checkedIndex(index, self.parts->frames.size(), "frame")], self.parts);
          },
          "index"_a, "The hulls of a frame, in the order of the parts: a list of Hull.")
      .def_property_readonly(
          "mesh_volume", [](const PartList& self) { return self.parts->errors.front().meshVolume; },
          "Of the mesh, or of the closed body that was built for it; in the first frame.")
      .def_property_readonly(
          "hull_volume", [](const PartList& self) { return self.parts->errors.front().hullVolume; },
          "The sum over the hulls, in the first frame.")
      .def_property_readonly(
          "error", [](const PartList& self) { return self.parts->meanError(); },
          "(hull volume - mesh volume) / mesh volume; of several frames, the mean.")
      .def_property_readonly(
          "errors",
          [](const PartList& self) {
            py::list errors;
            for (const PoseError& error : self.parts->errors) errors.append(error.relative());
            return errors;
          },
          "The error of each frame.")
      .def_property_readonly(
          "keyframes", [](const PartList& self) { return self.parts->keyframes; },
          "The frames that the mesh was decomposed in; the others are unseen.")
      .def_property_readonly(
          "hash", [](const PartList& self) { return hexDigits(hashOf(self.parts->content.decomposition)); },
          "Of the parts, as `lorica decompose` prints it.")
      .def_property_readonly(
          "repaired", [](const PartList& self) { return self.parts->repaired; },
          "What was done to the mesh first, in words; empty if nothing.")
      .def(
          "save", [](const PartList& self, const fs::path& file) { save(self.parts->content, file); }, "file"_a,
          "Writes a .lorica file. It holds no positions: load_parts() and the command need the mesh, too.")
      .def("__repr__", [](const PartList& self) {
        return fmt::format("<lorica.Parts: {}>", counted(std::ssize(self.parts->hulls()), "hull"));
      });
}

}  // namespace

py::list hullList(std::span<const ConvexHull> hulls, const std::shared_ptr<const void>& owner) {
  py::list list;
  for (const ConvexHull& hull : hulls) list.append(HullView{std::shared_ptr<const ConvexHull>(owner, &hull)});
  return list;
}

}  // namespace lorica

PYBIND11_MODULE(_lorica, module) {
  namespace py = pybind11;
  using namespace lorica;
  using py::literals::operator""_a;
  module.doc() = "Convex parts of meshes and of moving characters.";
  module.attr("__version__") = LORICA_VERSION;
  module.attr("Cancelled") = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "lorica.Cancelled", "The progress function returned False.", PyExc_RuntimeError, nullptr));
  addHull(module);
  addParts(module);
  addCharacters(module);
  module.def("decompose", &decomposeMesh, "vertices"_a, "faces"_a, "parts"_a = py::none(), py::kw_only(),
             "max_error"_a = 0.0, "max_distance"_a = 0.0, "max_concavity"_a = 0.0, "preset"_a = "fast",
             "hull_vertices"_a = 0, "hull_planes"_a = 0, "closed_body"_a = "auto", "walls"_a = "auto",
             "thickness"_a = 0.0, "threads"_a = 0, "progress"_a = py::none(), "keyframes"_a = py::none(),
             "candidates"_a = 0,
             R"(Decompose a mesh into nearly convex parts, and return their hulls.

The hulls together contain every vertex of the surface. The same arguments give the same hulls on any number of threads:
there is no seed. A mesh with small faults is repaired; an open one gets a closed body, see `closed_body`.

vertices       (n, 3) finite numbers, in any unit; or (k, n, 3): the mesh in k frames, whose hulls Parts.frame() has
faces          (m, 3) integers: triangles, counter-clockwise seen from outside
parts          at most this many; 0 = until no concave edge remains; None = 16, or with a limit below as many as it takes
max_error      stop when the hulls have at most this much more volume, relative to the mesh; 0 = no limit
max_distance   use the fewest parts with no point of a hull farther than this from the surface; 0 = no limit
max_concavity  use the fewest parts whose concavity, as CoACD measures it, is at most this; 0 = no limit
preset         "paper", "fast" or "quality"
hull_vertices  enclose hulls with more vertices in larger ones with at most this many, at least 4; 0 = no limit. It and
               parts always hold; the limits give where not all can
hull_planes    the same for planes of hulls: flat faces, of any number of corners
closed_body    "auto" builds a closed surface if the mesh cannot be repaired, "never" refuses such a mesh, "always"
walls          what an open surface is: "auto" = a thin wall, unless nothing outside can reach what is behind it; "solid";
               "shell" = a thin wall, also where it is closed
thickness      of thin walls; 0 = 1 % of the longest side, at most half of the narrowest gap
threads        0 = all of the machine's
progress       called with the numbers of parts done and wanted; return False to cancel
keyframes      of several frames, decompose in so many at even intervals; None = up to 12 that differ most
candidates     concave edges that are tried for each cut; 0 = the preset's, 8

Other threads of Python run meanwhile; Ctrl-C cancels. Raises ValueError with a sentence, or Cancelled.
Warns, as a RuntimeWarning, of an error above 50 %.)");
  module.def("load_parts", &loadParts, "file"_a, "vertices"_a, "faces"_a, py::kw_only(), "hull_vertices"_a = 0,
             "hull_planes"_a = 0,
             "The parts in a .lorica file that was made from this mesh, or from one with the same faces.");
  module.def("read_mesh", &readMeshFile, "file"_a,
             "Read .off, .obj, .ply or .stl: (n, 3) float64 vertices and (m, 3) int32 faces, read-only, no copy.");
  refuseUnmadeObjects(module);
}
