// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// The numbers of motion.csv, row by row.
std::vector<std::vector<double>> written_motion(const Trajectory& tool) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_motion(tool, folder.path()));
  std::istringstream lines(read_file(folder.path() / "motion.csv").value());
  std::vector<std::vector<double>> rows;
  std::string line, cell;
  std::getline(lines, line);
  EXPECT_EQ(line, "t,x,y,z,qw,qx,qy,qz,vx,vy,vz");
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

/// A tool that moves along x at 20 mm/s, at these times [s], from 0.1 s on.
Trajectory straight_motion(const std::vector<double>& times, double noise) {
  Random random(7);
  Trajectory tool;
  for (const double t : times) {
    const Eigen::Vector3d offset(random.normal() * noise, random.normal() * noise,
                                 random.normal() * noise);
    tool.append(Stamp::from_seconds(0.1 + t),
                Pose::from_translation(Eigen::Vector3d(0.02 * t, 0.3, 0.1) + offset));
  }
  return tool;
}

TEST(ExportedMotion, KeepsAStraightMotionAtAnyRate) {
  for (const auto& times :
       {std::vector<double>{0.0, 0.03, 0.05, 0.09}, std::vector<double>{0.0, 0.5}}) {
    const auto rows = written_motion(straight_motion(times, 0.0));
    ASSERT_EQ(rows.size(), times.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_NEAR(rows[i][0], times[i], 1e-9);
      EXPECT_NEAR(rows[i][1], 0.02 * times[i], 1e-9);
      EXPECT_NEAR(rows[i][8], 0.02, 1e-9);
      EXPECT_NEAR(rows[i][9], 0.0, 1e-9);
    }
  }
}

TEST(ExportedMotion, HasNoVelocityOfTheNoise) {
  std::vector<double> times;
  for (int i = 0; i < 500; ++i) times.push_back(0.002 * i);
  const auto rows = written_motion(straight_motion(times, 50e-6));
  double squares = 0.0;
  for (const auto& row : rows) squares += std::pow(row[8] - 0.02, 2) / 500.0;
  // 50 um / (sqrt(21 rows) 12 ms) = 0.9 mm/s; more at the ends. Differences have 35 mm/s.
  EXPECT_LT(std::sqrt(squares), 1.5e-3);
}

TEST(ExportedMotion, RestsWithOneRow) {
  const auto rows = written_motion(straight_motion({0.0}, 0.0));
  ASSERT_EQ(rows.size(), 1U);
  for (int i = 8; i < 11; ++i) EXPECT_EQ(rows.front()[static_cast<std::size_t>(i)], 0.0);
}

}  // namespace
}  // namespace pcavr
