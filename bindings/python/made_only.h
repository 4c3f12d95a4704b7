#pragma once

#include <pybind11/pybind11.h>

namespace lorica {

/// Lets no object of the module's classes be used that was not made by its constructor or a function: `__new__` alone,
/// as `copy` and `pickle` call it, leaves an object without content, and any attribute of it would crash the
/// interpreter. It raises TypeError instead, as `copy` and `pickle` do at once.
void refuseUnmadeObjects(const pybind11::module_& module);

}  // namespace lorica
