// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/simulate.hpp"

namespace pcavr::simulation {

/// The camera's trajectory. A camera on a stand is fixed; a hand-held one moves back and forth
/// around the table, looks at changing points on it, and has a hand tremor: sums of sines with
/// phases by seed.
class CameraPath {
 public:
  CameraPath(const SimulationCase& simulation, std::uint64_t seed);

  /// `t` [s] from the recording's start.
  [[nodiscard]] Pose T_base_camera(double t) const;

 private:
  struct Sinusoid {
    double mean = 0.0;
    double amplitude = 0.0;
    double period = 1.0;  ///< [s]
    double phase = 0.0;   ///< [rad]
    [[nodiscard]] double at(double t) const;
  };

  bool is_fixed_ = false;
  Sinusoid azimuth_;    ///< of the camera as seen from the table, from base x towards y [rad]
  Sinusoid elevation_;  ///< [rad]
  Sinusoid distance_;   ///< [m]
  std::array<Sinusoid, 3> target_;  ///< what it looks at, in base [m]
  std::array<Sinusoid, 6> tremor_;  ///< twist in camera axes [m, rad]
};

}  // namespace pcavr::simulation
