// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/path_view.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

TEST(PathView, InterpolatesLinearlyAndClampsAtTheEnds) {
  const std::vector<double> t{1.0, 2.0, 4.0};
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 2, 0}, {1, 2, 8}};
  const PathView path(t, points);
  EXPECT_EQ(path.at(-5.0), points[0]);
  EXPECT_EQ(path.at(1.0), points[0]);
  EXPECT_EQ(path.at(1.5), Eigen::Vector3d(0.5, 1, 0));
  EXPECT_EQ(path.at(2.0), points[1]);
  EXPECT_EQ(path.at(3.5), Eigen::Vector3d(1, 2, 6));
  EXPECT_EQ(path.at(4.0), points[2]);
  EXPECT_EQ(path.at(9.0), points[2]);
}

TEST(PathView, IsTheSameWithoutASearchForTimesThatAscend) {
  const std::vector<double> t{1.0, 2.0, 4.0};
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 2, 0}, {1, 2, 8}};
  const PathView path(t, points);
  std::size_t next = 0;
  for (const double at : {-5.0, 1.0, 1.5, 1.7, 2.0, 3.5, 4.0, 9.0}) {
    EXPECT_EQ(path.at(at, next), path.at(at)) << at;
  }
}

TEST(PathView, ThrowsWhenReadWhileEmpty) {
  EXPECT_THROW((void)PathView({}, {}).at(0.0), ContractError);
}

}  // namespace
}  // namespace pcavr
