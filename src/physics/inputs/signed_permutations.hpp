// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// All 48 signed permutation matrices: the axes that a driver may permute.
[[nodiscard]] inline std::vector<Eigen::Matrix3d> signed_permutations() {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
  std::vector<Eigen::Matrix3d> all;
  for (const auto& order : kOrders) {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) {
        axes(row, order[row]) = (signs & (1 << row)) != 0 ? -1.0 : 1.0;
      }
      all.push_back(axes);
    }
  }
  return all;
}

/// "(fy, -fx, fz)".
[[nodiscard]] inline std::string components_text(const Eigen::Matrix3d& axes) {
  constexpr const char* kNames[3] = {"fx", "fy", "fz"};
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (axes(row, column) == 0.0) continue;
      text += (text.empty() ? "(" : ", ") + std::string(axes(row, column) < 0.0 ? "-" : "") +
              kNames[column];
    }
  }
  return text + ")";
}

}  // namespace pcavr
