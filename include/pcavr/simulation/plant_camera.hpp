// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/simulate.hpp"

namespace pcavr {

/// Pictures by the camera of a case, on its stand, of the case's plant while this is moved
/// otherwise than in the recording: at half the width and height, so that a core renders some 20 a
/// second.
class PlantCamera {
 public:
  /// The tool of the case must not be an arm's.
  [[nodiscard]] static Expected<PlantCamera> create(const SimulationCase& simulation,
                                                    std::uint64_t seed);
  PlantCamera(PlantCamera&&) noexcept;
  PlantCamera& operator=(PlantCamera&&) noexcept;
  ~PlantCamera();

  /// Of the pictures.
  [[nodiscard]] const CameraModel& camera() const;
  /// The tip's centre [m], and the bodies in the order of the plant. The noise is that of the
  /// picture's number. Thread-safe.
  [[nodiscard]] ColorImage render(const Eigen::Vector3d& p_base_tip,
                                  std::span<const Pose> T_base_objects, std::uint64_t number) const;

 private:
  struct Content;
  explicit PlantCamera(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
