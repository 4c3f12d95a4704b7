#pragma once

#include <pybind11/pybind11.h>

namespace lorica {

/// The metaclass of classes with a constructor, which tells calls of the class from calls of its `__new__`.
[[nodiscard]] pybind11::handle metaclassOfConstructed();

/// Lets no object of the module's classes exist that was not made by its constructor or a function: `__new__` alone, as
/// `copy` and `pickle` call it, leaves an object without content, and any attribute of it would crash the interpreter.
void refuseUnmadeObjects(const pybind11::module_& module);

}  // namespace lorica
