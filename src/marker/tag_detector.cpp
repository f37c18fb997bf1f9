// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/marker/tag_detector.hpp"

#include <algorithm>

#include "marker/quad_finder.hpp"

namespace pcavr {

struct TagDetector::State {
  TagDetectorOptions options;
  std::vector<std::unique_ptr<QuadFinder>> finders;
};

TagDetector::TagDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;

Expected<TagDetector> TagDetector::create(const std::vector<std::string>& families,
                                          const TagDetectorOptions& options) {
  auto finders = make_quad_finders(families, options);
  if (!finders) return finders.error();
  return TagDetector(std::make_unique<State>(State{options, std::move(*finders)}));
}

std::vector<TagDetection> TagDetector::detect(const GrayImage& image) {
  std::vector<TagDetection> detections;
  if (image.empty()) return detections;
  for (const auto& finder : state_->finders) {
    for (TagDetection& found : finder->find(image, {0, 0, image.width(), image.height()})) {
      detections.push_back(std::move(found));
    }
  }
  std::erase_if(detections, [&](const TagDetection& one) {
    return one.hamming > state_->options.largest_hamming ||
           one.decision_margin < state_->options.smallest_margin;
  });
  // Of tags seen twice the clearer one stays.
  std::stable_sort(detections.begin(), detections.end(),
                   [](const TagDetection& a, const TagDetection& b) {
                     if (a.id != b.id) return a.id < b.id;
                     return a.decision_margin > b.decision_margin;
                   });
  detections.erase(
      std::unique(detections.begin(), detections.end(),
                  [](const TagDetection& a, const TagDetection& b) { return a.id == b.id; }),
      detections.end());
  return detections;
}

}  // namespace pcavr
