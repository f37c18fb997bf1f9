// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/marker/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "pcavr/marker/tag_sheet.hpp"

#include "marker/corner_refinement.hpp"
#include "marker/quad_finder.hpp"

namespace pcavr {
namespace {

/// Searching regions of more than this share of the image costs as much as the whole image.
constexpr double kMaxRegionShare = 0.6;
/// The libraries need some tiles to threshold; a tag has at least 8 cells with its border [px].
constexpr int kMinEdge = 8;

}  // namespace

struct TagDetector::State {
  TagDetectorOptions options;
  std::vector<std::unique_ptr<QuadFinder>> finders;
  std::map<std::string, int> cells_along_edge;  // by family
  std::vector<TagDetection> last;
  int width = 0;
  int height = 0;
  int frames_since_full_search = 0;

  std::vector<TagDetection> search(const GrayImage& image, const std::vector<Region>& regions);
  void refine(const GrayImage& image, TagDetection& detection) const;
  [[nodiscard]] std::vector<Region> plan_regions(const GrayImage& image) const;
  [[nodiscard]] bool has_lost_a_tag(const std::vector<TagDetection>& found) const;
};

void TagDetector::State::refine(const GrayImage& image, TagDetection& detection) const {
  const int cells = cells_along_edge.at(detection.id.family);
  const auto refined = refine_corners(image, detection.corners, cells, options);
  detection.corner_std =
      refined ? std::hypot(refined->corner_std, options.edge_model_std) : options.unrefined_std;
  if (refined) detection.corners = refined->corners;
}

std::vector<TagDetection> TagDetector::State::search(const GrayImage& image,
                                                     const std::vector<Region>& regions) {
  std::vector<TagDetection> detections;
  for (const auto& finder : finders) {
    for (const Region& region : regions) {
      for (TagDetection& found : finder->find(image, region)) {
        refine(image, found);
        finder->score(image, found);
        if (found.hamming > options.max_hamming) continue;
        if (found.decision_margin < options.min_margin) continue;
        detections.push_back(std::move(found));
      }
    }
  }
  // Of duplicate detections, keep the one with the larger decision margin.
  const auto is_before = [](const TagDetection& a, const TagDetection& b) {
    return a.id != b.id ? a.id < b.id : a.decision_margin > b.decision_margin;
  };
  const auto is_same = [](const TagDetection& a, const TagDetection& b) { return a.id == b.id; };
  std::stable_sort(detections.begin(), detections.end(), is_before);
  detections.erase(std::unique(detections.begin(), detections.end(), is_same), detections.end());
  return detections;
}

/// The regions of interest to search; empty for the whole image.
std::vector<Region> TagDetector::State::plan_regions(const GrayImage& image) const {
  const bool is_due = frames_since_full_search + 1 >= options.full_search_interval;
  if (is_due || image.width() != width || image.height() != height) return {};
  std::vector<std::array<Eigen::Vector2d, 4>> tags;
  for (const TagDetection& detection : last) tags.push_back(detection.corners);
  std::vector<Region> regions = regions_around(tags, width, height, options.motion_share);
  long area = 0;
  for (const Region& region : regions) area += region.area();
  const double max_area = kMaxRegionShare * static_cast<double>(width) * height;
  if (static_cast<double>(area) > max_area) regions.clear();
  return regions;
}

bool TagDetector::State::has_lost_a_tag(const std::vector<TagDetection>& found) const {
  return std::any_of(last.begin(), last.end(), [&](const TagDetection& one) {
    return std::none_of(found.begin(), found.end(),
                        [&](const TagDetection& other) { return other.id == one.id; });
  });
}

TagDetector::TagDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;

Expected<TagDetector> TagDetector::create(const std::vector<std::string>& families,
                                          const TagDetectorOptions& options) {
  PCAVR_REQUIRE(options.decimation >= 1, options.decimation);
  PCAVR_REQUIRE(options.max_hamming >= 0 && options.max_hamming <= 3, options.max_hamming);
  PCAVR_REQUIRE(options.full_search_interval >= 1, options.full_search_interval);
  auto state = std::make_unique<State>();
  auto finders = make_quad_finders(families, options);
  if (!finders) return finders.error();
  state->finders = std::move(*finders);
  for (const std::string& family : families) {
    const Expected<TagPicture> picture = tag_picture(family, 0);
    state->cells_along_edge[family] = picture->cells - 2 * picture->border;
  }
  state->options = options;
  return TagDetector(std::move(state));
}

std::vector<TagDetection> TagDetector::detect(const GrayImage& image) {
  State& state = *state_;
  const int min_size = kMinEdge * state.options.decimation;
  if (image.width() < min_size || image.height() < min_size) return {};
  const std::vector<Region> whole{{0, 0, image.width(), image.height()}};
  std::vector<TagDetection> found;
  const std::vector<Region> regions = state.plan_regions(image);
  bool is_full = regions.empty();
  if (!is_full) {
    found = state.search(image, regions);
    is_full = state.has_lost_a_tag(found);
  }
  if (is_full) found = state.search(image, whole);
  state.frames_since_full_search = is_full ? 0 : state.frames_since_full_search + 1;
  state.width = image.width();
  state.height = image.height();
  state.last = found;
  return found;
}

}  // namespace pcavr
