#include "bindings/mesh_parts.h"
#include "bindings/python/arrays.h"
#include "bindings/python/docstrings.h"
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
                     LORICA_TRY(const EarlierParts earlier, earlierPartsIn(file));
                     return partsAsBefore(earlier, std::move(mesh), given);
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
  py::class_<HullView>(module, "Hull", docOf("Hull"))
      .def_property_readonly(
          "vertices", [](const py::object& self) { return view(self.cast<const HullView&>().hull->vertices, self); },
          docOf("Hull.vertices"))
      .def_property_readonly(
          "faces", [](const py::object& self) { return view(self.cast<const HullView&>().hull->triangles, self); },
          docOf("Hull.faces"))
      .def_property_readonly(
          "volume", [](const HullView& self) { return self.hull->volume; }, docOf("Hull.volume"))
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
  py::class_<PartList>(module, "Parts", docOf("Parts"))
      .def("__len__", [](const PartList& self) { return self.parts->hulls().size(); })
      .def("__getitem__",
           [](const PartList& self, py::ssize_t index) {
             const std::vector<ConvexHull>& hulls = self.parts->hulls();
             return HullView{{self.parts, &hulls[checkedIndex(index, hulls.size(), "part")]}};
           })
      .def("__iter__", [](const PartList& self) { return py::iter(hullList(self.parts->hulls(), self.parts)); })
      .def_property_readonly(
          "hulls", [](const PartList& self) { return hullList(self.parts->hulls(), self.parts); }, docOf("Parts.hulls"))
      .def_property_readonly(
          "frame_count", [](const PartList& self) { return self.parts->frames.size(); }, docOf("Parts.frame_count"))
      .def(
          "frame",
          [](const PartList& self, py::ssize_t index) {
            return hullList(self.parts->frames[checkedIndex(index, self.parts->frames.size(), "frame")], self.parts);
          },
          "index"_a, docOf("Parts.frame"))
      .def_property_readonly(
          "mesh_volume", [](const PartList& self) { return self.parts->errors.front().meshVolume; },
          docOf("Parts.mesh_volume"))
      .def_property_readonly(
          "hull_volume", [](const PartList& self) { return self.parts->errors.front().hullVolume; },
          docOf("Parts.hull_volume"))
      .def_property_readonly(
          "error", [](const PartList& self) { return self.parts->meanError(); }, docOf("Parts.error"))
      .def_property_readonly(
          "errors",
          [](const PartList& self) {
            py::list errors;
            for (const PoseError& error : self.parts->errors) errors.append(error.relative());
            return errors;
          },
          docOf("Parts.errors"))
      .def_property_readonly(
          "keyframes", [](const PartList& self) { return self.parts->keyframes; }, docOf("Parts.keyframes"))
      .def_property_readonly(
          "hash", [](const PartList& self) { return hexDigits(hashOf(self.parts->content.decomposition)); },
          docOf("Parts.hash"))
      .def_property_readonly(
          "repaired", [](const PartList& self) { return self.parts->repaired; }, docOf("Parts.repaired"))
      .def(
          "save", [](const PartList& self, const fs::path& file) { save(self.parts->content, file); }, "file"_a,
          docOf("Parts.save"))
      .def("__repr__", [](const PartList& self) {
        return fmt::format("<lorica.Parts: {}>", counted(std::ssize(self.parts->hulls()), "hull"));
      });
}

/// Called where an object without content is used: pybind11 would give it memory that nothing filled.
void* refuseContent(std::size_t) {
  throw py::type_error("this object was made by __new__ alone and is empty: call its class, or lorica's functions");
}

/// Lets no object of the module's classes be used that was not made by its constructor or a function: `__new__` alone,
/// as `copy` and `pickle` call it, leaves an object without content, and any attribute of it would crash the
/// interpreter. It raises TypeError instead, as `copy` and `pickle` do at once.
void refuseUnmadeObjects(const py::module_& module) {
  const auto* base = reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base);
  for (const auto& [name, value] : py::dict(module.attr("__dict__"))) {
    auto* type = reinterpret_cast<PyTypeObject*>(value.ptr());
    if (!PyType_Check(value.ptr()) || PyType_IsSubtype(type, const_cast<PyTypeObject*>(base)) == 0) continue;
    py::detail::get_type_info(type)->operator_new = &refuseContent;
    const std::string sentence = fmt::format("a lorica.{} cannot be copied or pickled: lorica's functions make it",
                                             py::str(name).cast<std::string>());
    const auto refuse = [sentence](const py::args&, const py::kwargs&) -> py::object {
      throw py::type_error(sentence);
    };
    value.attr("__reduce_ex__") = py::cpp_function(refuse, py::is_method(value));
  }
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
  module.attr("Cancelled") = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc("lorica.Cancelled", docOf("Cancelled"), PyExc_RuntimeError, nullptr));
  addHull(module);
  addParts(module);
  addCharacters(module);
  module.def("decompose", &decomposeMesh, "vertices"_a, "faces"_a, "parts"_a = py::none(), py::kw_only(),
             "max_error"_a = 0.0, "max_distance"_a = 0.0, "max_concavity"_a = 0.0, "preset"_a = "fast",
             "hull_vertices"_a = 0, "hull_planes"_a = 0, "closed_body"_a = "auto", "walls"_a = "auto",
             "thickness"_a = 0.0, "threads"_a = 0, "progress"_a = py::none(), "keyframes"_a = py::none(),
             "candidates"_a = 0, docOf("decompose"));
  module.def("load_parts", &loadParts, "file"_a, "vertices"_a, "faces"_a, py::kw_only(), "hull_vertices"_a = 0,
             "hull_planes"_a = 0, docOf("load_parts"));
  module.def("read_mesh", &readMeshFile, "file"_a, docOf("read_mesh"));
  refuseUnmadeObjects(module);
}
