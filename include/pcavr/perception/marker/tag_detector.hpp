// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Four corners of a tag in the image [px; the centre of pixel (0, 0) is at (0, 0)], in the order
/// (-,-) (+,-) (+,+) (-,+) of the marker frame (x right, y up, seen upright).
struct TagDetection {
  MarkerId id;
  std::array<Eigen::Vector2d, 4> corners;
  int hamming = 0;               ///< bits corrected
  double decision_margin = 0.0;  ///< mean contrast between bits and threshold; low is unreliable
  /// Of one corner coordinate [px], estimated from the image's noise and blur; 0 if unknown.
  double corner_std = 0.0;
};

/// See src/perception/marker/options.cpp for meanings, ranges and defaults.
struct TagDetectorOptions {
  TagDetectorOptions();

  int decimation;
  int max_hamming;
  double min_margin;         ///< of 255
  int full_search_interval;  ///< [frames]
  double motion_share;       ///< of the image's width
  double edge_reach;         ///< [px]
  double edge_model_std;     ///< [px]
  double unrefined_std;      ///< [px]
  /// The camera model, if the lens has distortion: edges are fitted in undistorted coordinates.
  /// Without it, strong distortion shifts the corners of large tags by some tenths of a pixel.
  std::optional<CameraModel> lens = {};
};

/// The options "marker.detector"; without the lens.
[[nodiscard]] OptionSection section_of(TagDetectorOptions& options);

/// Names of the supported tag families.
[[nodiscard]] const std::vector<std::string>& tag_families();

/// Detects tags of the given families: AprilTag by libapriltag [Wang & Olson 2016], ArUco by
/// OpenCV; corners are refined to subpixel accuracy by fitting the grey values of the edges.
/// Between full searches only regions of interest around the previous frame's tags are searched; if
/// one of those tags is lost, the whole image is. Deterministic: detections depend only on the
/// images processed so far. Not thread-safe: use one detector for each image stream.
class TagDetector {
 public:
  /// An unknown family is an Error. Throws ContractError for an option out of range.
  [[nodiscard]] static Expected<TagDetector> create(const std::vector<std::string>& families,
                                                    const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Sorted by id, each id at most once. An id that is in the image at two places (copies of a
  /// print) is left out: which one is meant is not known.
  [[nodiscard]] std::vector<TagDetection> detect(const GrayImage& image);

  /// The ids that the last detect() left out for that reason, sorted.
  [[nodiscard]] const std::vector<MarkerId>& seen_twice() const;

 private:
  struct State;
  explicit TagDetector(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
