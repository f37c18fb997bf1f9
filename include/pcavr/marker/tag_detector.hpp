// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/recording/manifest.hpp"

namespace pcavr {

/// Four corners of a tag in the image [px; the centre of pixel (0, 0) is at (0, 0)], in the order
/// (-,-) (+,-) (+,+) (-,+) of the marker frame (x right, y up, seen upright).
struct TagDetection {
  MarkerId id;
  std::array<Eigen::Vector2d, 4> corners;
  int hamming = 0;               ///< bits corrected
  double decision_margin = 0.0;  ///< mean contrast between bits and threshold; small is doubtful
};

struct TagDetectorOptions {
  int decimation = 2;       ///< quads are sought in an image shrunk by this; corners are not
  int largest_hamming = 1;  ///< tags with more corrected bits are dropped
  double smallest_margin = 20.0;  ///< of 255; printed tags in ordinary light reach 40 to 120
  /// Besides where tags were seen last, look at the whole image every so many frames.
  int full_search_interval = 5;
  int threads = 1;
};

/// Names of the families that TagDetector knows.
[[nodiscard]] const std::vector<std::string>& tag_families();

/// Finds tags of the families given. AprilTag's by libapriltag, ArUco's by OpenCV. Remembers where
/// tags were, to look there first. Not thread-safe.
class TagDetector {
 public:
  /// An unknown family is an Error.
  [[nodiscard]] static Expected<TagDetector> create(const std::vector<std::string>& families,
                                                    const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Sorted by id, each id at most once.
  [[nodiscard]] std::vector<TagDetection> detect(const GrayImage& image);

 private:
  struct State;
  explicit TagDetector(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
