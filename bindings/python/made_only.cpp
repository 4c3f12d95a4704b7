#include "bindings/python/made_only.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace lorica {
namespace {

namespace py = pybind11;

thread_local bool called = false;  // a class, by its name: its __new__ follows

PyObject* callClass(PyObject* type, PyObject* arguments, PyObject* named) {
  called = true;
  PyObject* made = py::detail::get_internals().default_metaclass->tp_call(type, arguments, named);
  called = false;
  return made;
}

}  // namespace

py::handle metaclassOfConstructed() {
  static PyObject* const made = [] {
    PyType_Slot slots[] = {{Py_tp_call, reinterpret_cast<void*>(&callClass)}, {0, nullptr}};
    PyType_Spec spec = {"lorica.constructed", 0, 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE, slots};
    const py::tuple bases =
        py::make_tuple(py::handle(reinterpret_cast<PyObject*>(py::detail::get_internals().default_metaclass)));
    return PyType_FromSpecWithBases(&spec, bases.ptr());
  }();
  if (made == nullptr) throw py::error_already_set();
  return made;
}

void refuseUnmadeObjects(const py::module_& module) {
  const py::object asStatic = py::module_::import("builtins").attr("staticmethod");
  const auto* base = reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base);
  for (const auto& [name, value] : py::dict(module.attr("__dict__"))) {
    if (!PyType_Check(value.ptr()) ||
        PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(value.ptr()), const_cast<PyTypeObject*>(base)) == 0) {
      continue;
    }
    const std::string sentence =
        fmt::format("a lorica.{} cannot be copied, pickled or made by __new__: lorica's functions make it",
                    py::str(name).cast<std::string>());
    value.attr("__new__") = asStatic(
        py::cpp_function([sentence](const py::object& type, const py::args& arguments, const py::kwargs& named) {
          if (!std::exchange(called, false)) throw py::type_error(sentence);
          return py::reinterpret_steal<py::object>(py::detail::pybind11_object_new(
              reinterpret_cast<PyTypeObject*>(type.ptr()), arguments.ptr(), named.ptr()));
        }));
    value.attr("__reduce_ex__") = py::cpp_function(
        [sentence](const py::object&, const py::object&) -> py::object { throw py::type_error(sentence); },
        py::is_method(value));
  }
}

}  // namespace lorica
