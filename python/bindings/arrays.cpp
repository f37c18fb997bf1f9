// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string text = "(";
  for (const py::ssize_t extent : shape) {
    if (text.size() > 1) text += ", ";
    text += extent == kAnySize ? "N" : std::to_string(extent);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

std::vector<py::ssize_t> shape_of(const py::array& array) {
  return {array.shape(), array.shape() + array.ndim()};
}

bool is_of_shape(const py::array& array, const std::vector<py::ssize_t>& shape) {
  if (static_cast<std::size_t>(array.ndim()) != shape.size()) return false;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (shape[i] != kAnySize && array.shape(static_cast<py::ssize_t>(i)) != shape[i]) return false;
  }
  return true;
}

/// An array of real numbers, of any shape.
py::array real_array_of(const py::handle& argument, const std::string& name) {
  py::array array;
  if (!argument.is_none()) array = py::array::ensure(argument);
  if (!array || argument.is_none()) {
    throw py::type_error(name + ": an array of numbers is expected, not " +
                         std::string(py::str(py::type::of(argument).attr("__name__"))));
  }
  const bool is_real = std::string_view("fiu").find(array.dtype().kind()) != std::string_view::npos;
  if (!is_real) {
    throw py::type_error(name + ": an array of numbers is expected, not of dtype " +
                         std::string(py::str(array.dtype())));
  }
  return array;
}

void check_shape(const py::array& array, const std::string& name,
                 const std::vector<py::ssize_t>& shape) {
  if (is_of_shape(array, shape)) return;
  raise_error({.message = "an array of shape " + shape_text(shape) + " is expected, not " +
                          shape_text(shape_of(array)),
               .place = name});
}

/// Where in the argument a number of the flat memory stands: "tool[17, 2]".
std::string place_of(const std::string& name, const py::array& array, py::ssize_t index) {
  std::string place = "]";
  for (py::ssize_t axis = array.ndim() - 1; axis >= 0; --axis) {
    place = std::to_string(index % array.shape(axis)) + place;
    if (axis > 0) place = ", " + place;
    index /= array.shape(axis);
  }
  return array.ndim() == 0 ? name : name + '[' + place;
}

Pose pose_of_row(const double* row, const std::string& place) {
  if (auto error = check_unit_quaternion({row + 3, 4})) {
    error->place = place;
    raise_error(*error);
  }
  return {Eigen::Quaterniond(row[6], row[3], row[4], row[5]),
          Eigen::Vector3d(row[0], row[1], row[2])};
}

std::uint32_t vertex_index(std::int64_t index, std::size_t vertices, const std::string& place) {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
    raise_error({.message = std::to_string(index) + " is not the index of one of the " +
                            std::to_string(vertices) + " vertices",
                 .place = place});
  }
  return static_cast<std::uint32_t>(index);
}

}  // namespace

Numbers numbers_of(const py::handle& argument, const std::string& name,
                   const std::vector<py::ssize_t>& shape) {
  const py::array array = real_array_of(argument, name);
  check_shape(array, name, shape);
  Numbers numbers = Numbers::ensure(array);
  if (!numbers) throw py::error_already_set();
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    if (std::isfinite(numbers.data()[i])) continue;
    raise_error({.message = "is not a finite number", .place = place_of(name, numbers, i)});
  }
  return numbers;
}

Eigen::Vector3d vector_of(const py::handle& argument, const std::string& name) {
  const Numbers numbers = numbers_of(argument, name, {3});
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

Pose pose_of(const py::handle& argument, const std::string& name) {
  return pose_of_row(numbers_of(argument, name, {7}).data(), name);
}

Numbers array_of(const Pose& pose) {
  Numbers array(7);
  Eigen::Map<Eigen::Vector3d>(array.mutable_data()) = pose.translation();
  Eigen::Map<Eigen::Vector4d>(array.mutable_data() + 3) = pose.rotation().coeffs();
  return array;
}

Numbers array_of(const Eigen::Vector3d& vector) {
  Numbers array(3);
  Eigen::Map<Eigen::Vector3d>(array.mutable_data()) = vector;
  return array;
}

Numbers array_of(std::span<const Pose> poses) {
  Numbers array({static_cast<py::ssize_t>(poses.size()), py::ssize_t{7}});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double* const row = array.mutable_data() + 7 * i;
    Eigen::Map<Eigen::Vector3d>{row} = poses[i].translation();
    Eigen::Map<Eigen::Vector4d>{row + 3} = poses[i].rotation().coeffs();
  }
  return array;
}

std::array<py::object, 2> pair_of(const py::handle& argument, const std::string& name,
                                  const std::string& content) {
  const bool is_sequence =
      py::isinstance<py::tuple>(argument) || py::isinstance<py::list>(argument);
  if (!is_sequence || py::len(argument) != 2) {
    throw py::type_error(name + ": a pair " + content + " is expected");
  }
  const auto sequence = py::reinterpret_borrow<py::sequence>(argument);
  return {py::object(sequence[0]), py::object(sequence[1])};
}

std::vector<Stamp> stamps_of(const py::handle& argument, const std::string& name) {
  const Numbers t = numbers_of(argument, name, {kAnySize});
  std::vector<Stamp> stamps;
  stamps.reserve(static_cast<std::size_t>(t.size()));
  for (py::ssize_t i = 0; i < t.size(); ++i) {
    const double seconds = t.at(i);
    const std::string place = place_of(name, t, i);
    if (auto error = check_range(ranges::kStamp, seconds)) {
      error->place = place;
      raise_error(*error);
    }
    const Stamp stamp = Stamp::from_seconds(seconds);
    if (!stamps.empty() && stamp <= stamps.back()) {
      raise_error({.message = "is not after the time before it",
                   .place = place,
                   .hint = "sort the rows by time, and leave out those that repeat one"});
    }
    stamps.push_back(stamp);
  }
  return stamps;
}

Eigen::Vector3d TimedRows::vector(std::size_t row, std::size_t column) const {
  return Eigen::Vector3d::Map(rows.data() + row * columns() + column);
}

TimedRows timed_rows_of(const py::handle& argument, const std::string& name,
                        const std::vector<py::ssize_t>& columns) {
  const auto [t, rows] = pair_of(argument, name, "(t, rows)");
  TimedRows series{stamps_of(t, name + " t"), {}};
  const auto count = static_cast<py::ssize_t>(series.stamps.size());
  const py::array array = real_array_of(rows, name);
  for (const py::ssize_t accepted : columns) {
    if (!is_of_shape(array, {count, accepted})) continue;
    series.rows = numbers_of(array, name, {count, accepted});
    return series;
  }
  std::string expected;
  for (const py::ssize_t accepted : columns) {
    expected += (expected.empty() ? "" : " or ") + shape_text({count, accepted});
  }
  raise_error({.message = "an array of shape " + expected + " is expected, not " +
                          shape_text(shape_of(array)),
               .place = name,
               .hint = "one row for each of the times"});
}

Pose pose_of(const TimedRows& series, std::size_t row, const std::string& name) {
  return pose_of_row(series.rows.data() + row * series.columns(),
                     name + '[' + std::to_string(row) + ']');
}

Trajectory trajectory_of(const py::handle& argument, const std::string& name) {
  const TimedRows series = timed_rows_of(argument, name, {7});
  Trajectory trajectory;
  for (std::size_t i = 0; i < series.stamps.size(); ++i) {
    trajectory.append(series.stamps[i], pose_of(series, i, name));
  }
  return trajectory;
}

std::filesystem::path path_of(const py::handle& argument, const std::string& name) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(argument.ptr(), &bytes) == 0) {
    if (PyErr_ExceptionMatches(PyExc_TypeError) == 0) throw py::error_already_set();
    PyErr_Clear();
    throw py::type_error(name + ": a path is expected, as str or os.PathLike");
  }
  const auto owned = py::reinterpret_steal<py::bytes>(bytes);
  return std::filesystem::path(std::string(owned));
}

TriangleMesh mesh_of(const py::handle& argument, const std::string& name) {
  const auto [vertices, triangles] = pair_of(argument, name, "(vertices, triangles)");
  const Numbers points = numbers_of(vertices, name + " vertices", {kAnySize, 3});
  const py::array corners = real_array_of(triangles, name + " triangles");
  if (corners.dtype().kind() == 'f') {
    throw py::type_error(name + " triangles: indices are expected, not numbers with a fraction");
  }
  check_shape(corners, name + " triangles", {kAnySize, 3});
  const auto indices =
      py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(corners);
  TriangleMesh mesh;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    mesh.vertices.push_back(Eigen::Vector3d::Map(points.data() + 3 * i).cast<float>());
  }
  for (py::ssize_t i = 0; i < indices.shape(0); ++i) {
    const std::string place = name + " triangles[" + std::to_string(i) + ']';
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = vertex_index(indices.data()[3 * i + static_cast<py::ssize_t>(k)],
                                 mesh.vertices.size(), place);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

CadModel cad_of(const py::handle& argument, const std::string& name, double unit) {
  if (py::isinstance<py::tuple>(argument) || py::isinstance<py::list>(argument)) {
    return value_of(make_cad_model(mesh_of(argument, "cad"), name, "cad"));
  }
  return value_of(read_cad_model(path_of(argument, "cad"), name, {}, unit));
}

}  // namespace pcavr::python
