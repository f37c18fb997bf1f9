// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

#include "perception/marker/region.hpp"

namespace pcavr {

/// Detects and decodes tags in a region of an image: a wrapper of one library. Corners have the
/// library's accuracy, and pcavr's order and pixel convention. Not thread-safe.
class QuadFinder {
 public:
  virtual ~QuadFinder() = default;
  /// `region` lies inside the image; its left and top are multiples of 8.
  [[nodiscard]] virtual std::vector<TagDetection> find(const GrayImage& image,
                                                       const Region& region) = 0;
  /// Sets hamming and decision_margin from refined corners if find() cannot provide them.
  virtual void score(const GrayImage& /*image*/, TagDetection& /*detection*/) const {}
};

/// One finder for each library that the families need. An unknown family is an Error.
[[nodiscard]] Expected<std::vector<std::unique_ptr<QuadFinder>>> make_quad_finders(
    const std::vector<std::string>& families, const TagDetectorOptions& options);

}  // namespace pcavr
