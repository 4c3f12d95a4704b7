#include "bindings/python/made_only.h"

#include <fmt/format.h>

#include <cstddef>
#include <string>

namespace lorica {
namespace {

namespace py = pybind11;

/// Called where an object without content is used: pybind11 would give it memory that nothing filled.
void* refuseContent(std::size_t) {
  throw py::type_error("this object was made by __new__ alone and is empty: call its class, or lorica's functions");
}

}  // namespace

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

}  // namespace lorica
