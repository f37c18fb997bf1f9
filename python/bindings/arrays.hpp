// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pybind11/numpy.h>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/base/model/cad_model.hpp"

/// Arguments from Python, checked: a wrong type is a TypeError; a wrong shape, a number that is not
/// finite or out of range, and stamps that do not ascend are pcavr.Error, whose `place` names the
/// argument and the row.
namespace pcavr::python {

/// Numbers in C order; the caller's memory where it is that already, else a copy.
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// An extent that a check accepts as it is.
inline constexpr pybind11::ssize_t kAnySize = -1;

/// Any real dtype, order and strides; None and other types are refused. `shape` has kAnySize where
/// any extent is accepted.
[[nodiscard]] Numbers numbers_of(const pybind11::handle& argument, const std::string& name,
                                 const std::vector<pybind11::ssize_t>& shape);

[[nodiscard]] Eigen::Vector3d vector_of(const pybind11::handle& argument, const std::string& name);

/// x y z qx qy qz qw, with a unit quaternion.
[[nodiscard]] Pose pose_of(const pybind11::handle& argument, const std::string& name);
[[nodiscard]] Numbers array_of(const Pose& pose);
[[nodiscard]] Numbers array_of(const Eigen::Vector3d& vector);
/// (N, 7)
[[nodiscard]] Numbers array_of(std::span<const Pose> poses);

/// A pair as tuple or list; `content` is what it has, in messages: "(t, rows)".
[[nodiscard]] std::array<pybind11::object, 2> pair_of(const pybind11::handle& argument,
                                                      const std::string& name,
                                                      const std::string& content);
/// (N,) s in strictly ascending order.
[[nodiscard]] std::vector<Stamp> stamps_of(const pybind11::handle& argument,
                                           const std::string& name);

/// A series: a pair (t, rows), with t [s] in strictly ascending order.
struct TimedRows {
  std::vector<Stamp> stamps;
  Numbers rows;  ///< as many as stamps

  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(rows.shape(1)); }
  /// Three columns of a row, from `column` on.
  [[nodiscard]] Eigen::Vector3d vector(std::size_t row, std::size_t column = 0) const;
};
/// `columns`: the numbers of columns that are accepted.
[[nodiscard]] TimedRows timed_rows_of(const pybind11::handle& argument, const std::string& name,
                                      const std::vector<pybind11::ssize_t>& columns);

/// The pose of a row of seven columns.
[[nodiscard]] Pose pose_of(const TimedRows& series, std::size_t row, const std::string& name);
/// A series of poses.
[[nodiscard]] Trajectory trajectory_of(const pybind11::handle& argument, const std::string& name);

/// A str or os.PathLike.
[[nodiscard]] std::filesystem::path path_of(const pybind11::handle& argument,
                                            const std::string& name);

/// A mesh from a pair (vertices (V, 3) [m], triangles (T, 3)).
[[nodiscard]] TriangleMesh mesh_of(const pybind11::handle& argument, const std::string& name);
/// A body from a mesh file, whose coordinates are in `unit` [m], or from such a pair.
[[nodiscard]] CadModel cad_of(const pybind11::handle& argument, const std::string& name,
                              double unit);

}  // namespace pcavr::python
