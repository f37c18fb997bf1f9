// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

struct CameraPicture {
  double t = 0.0;  ///< [s] of the scene
  ColorImage image;
  std::optional<CameraModel> camera = {};  ///< of the image; nullopt: not known
};

/// The camera of a robot, for the eyes of its operator. Called from one thread of the robot's site,
/// which is not that of its cycle: it may take its time.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// The newest picture at `t` [s of the scene]; empty if the last call has had it already.
  [[nodiscard]] virtual Expected<std::optional<CameraPicture>> newest(double t) = 0;
};

}  // namespace pcavr
