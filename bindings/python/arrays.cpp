#include "bindings/python/arrays.h"

#include "bindings/mesh_parts.h"
#include "bindings/python/work.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace lorica {
namespace {

namespace py = pybind11;

/// An array of numbers of the given kinds. @param shape  as the error says it
py::array arrayOf(const py::object& given, const char* name, std::string_view kinds, const char* numbers,
                  const char* shape, const std::function<bool(const py::array&)>& fits) {
  py::array array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(fmt::format("{}: found no array, expected {} with shape {}", name, numbers, shape));
  }
  if (!fits(array)) {
    throw py::value_error(fmt::format("{}: found shape {}, expected {}", name,
                                      std::string(py::str(py::object(array.attr("shape")))), shape));
  }
  if (kinds.find(array.dtype().kind()) == std::string_view::npos) {
    throw py::value_error(
        fmt::format("{}: found type {}, expected {}", name, std::string(py::str(py::object(array.dtype()))), numbers));
  }
  return array;
}

bool isTable(const py::array& array) {
  return array.ndim() == 2 && array.shape(1) == 3;
}

template <typename Scalar>
py::array_t<Scalar, py::array::c_style | py::array::forcecast> rowsOf(const py::array& array) {
  return py::array_t<Scalar, py::array::c_style | py::array::forcecast>(array);
}

/// Nothing may be written through a view.
template <typename Scalar>
py::array readOnly(py::array_t<Scalar> array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace

MeshSequence meshFrom(const py::object& vertices, const py::object& faces) {
  const py::array points =
      arrayOf(vertices, "vertices", "fiu", "numbers", "(n, 3) or (frames, n, 3)",
              [](const py::array& a) { return isTable(a) || (a.ndim() == 3 && a.shape(2) == 3 && a.shape(0) > 0); });
  const py::array corners = arrayOf(faces, "faces", "iu", "integers", "(m, 3)", isTable);
  const auto positions = rowsOf<double>(points);
  const auto indices = rowsOf<std::int64_t>(corners);
  Result<MeshSequence> mesh = checkedMesh({positions.data(), static_cast<std::size_t>(positions.size())},
                                          static_cast<std::size_t>(points.shape(points.ndim() - 2)),
                                          {indices.data(), static_cast<std::size_t>(indices.size())});
  return valueOf(std::move(mesh));
}

std::vector<Affine3> transformsFrom(const py::object& matrices, std::size_t count) {
  const std::string shape = fmt::format("({}, 4, 4)", count);
  const py::array array = arrayOf(matrices, "transforms", "fiu", "numbers", shape.c_str(), [&](const py::array& a) {
    return a.ndim() == 3 && a.shape(0) == static_cast<py::ssize_t>(count) && a.shape(1) == 4 && a.shape(2) == 4;
  });
  const auto rows = rowsOf<double>(array);
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  std::vector<Affine3> transforms(count);
  for (std::size_t t = 0; t < count; ++t) {
    const Eigen::Map<const RowMajor> matrix(rows.data() + 16 * t);
    if (!matrix.allFinite() || !matrix.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))) {
      throw py::value_error(fmt::format(
          "transforms: the matrix of joint {} has a number that is not finite, or a last row that is not 0 0 0 1", t));
    }
    transforms[t].matrix() = matrix;
  }
  return transforms;
}

std::vector<Vec3> pointsFrom(const py::object& points) {
  const py::array array = arrayOf(points, "points", "fiu", "numbers", "(n, 3) or (3,)",
                                  [](const py::array& a) { return isTable(a) || (a.ndim() == 1 && a.shape(0) == 3); });
  const auto rows = rowsOf<double>(array);
  std::vector<Vec3> found;
  for (py::ssize_t i = 0; i < rows.size(); i += 3) found.emplace_back(rows.data() + i);
  return found;
}

py::array view(std::span<const Vec3> points, py::handle owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const double* data = points.empty() ? nullptr : points.front().data();
  return readOnly(py::array_t<double>({points.size(), std::size_t{3}}, data, owner));
}

py::array view(std::span<const Triangle> triangles, py::handle owner) {
  static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t));
  const std::int32_t* data = triangles.empty() ? nullptr : triangles.front().data();
  return readOnly(py::array_t<std::int32_t>({triangles.size(), std::size_t{3}}, data, owner));
}

py::array view(std::span<const Affine3> transforms, py::handle owner) {
  static_assert(sizeof(Affine3) == 16 * sizeof(double));
  constexpr py::ssize_t kNumber = sizeof(double);
  const double* data = transforms.empty() ? nullptr : transforms.front().data();
  // Eigen's matrices are stored by columns.
  return readOnly(py::array_t<double>({static_cast<py::ssize_t>(transforms.size()), py::ssize_t{4}, py::ssize_t{4}},
                                      {16 * kNumber, kNumber, 4 * kNumber}, data, owner));
}

}  // namespace lorica
