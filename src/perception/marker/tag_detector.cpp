// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "pcavr/perception/marker/tag_sheet.hpp"

#include "perception/marker/corner_refinement.hpp"
#include "perception/marker/quad_finder.hpp"

namespace pcavr {
namespace {

/// Searching regions of more than this share of the image costs as much as the whole image.
constexpr double kMaxRegionShare = 0.6;
/// The libraries need some tiles to threshold; a tag has at least 8 cells with its border [px].
constexpr int kMinEdge = 8;
/// Detections of one id are of one tag where their centres are closer than this [edge lengths]: the
/// squares of two printed tags do not overlap.
constexpr double kSameTagDistance = 0.5;
/// A pattern that is mistaken for a tag needs corrected bits, and has less contrast: at most this
/// share of the margin of a tag read without.
constexpr double kMaxFalseMarginShare = 0.5;

Eigen::Vector2d centre_of(const TagDetection& tag) {
  return 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
}

double longest_edge_of(const TagDetection& tag) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    longest = std::max(longest, (tag.corners[i] - tag.corners[(i + 1) % 4]).norm());
  }
  return longest;
}

/// Whether `other`, of the same id, is another printed tag: neither the same one found twice, nor a
/// pattern mistaken for it. `best` has the larger margin.
bool is_copy(const TagDetection& best, const TagDetection& other) {
  const double edge = std::max(longest_edge_of(best), longest_edge_of(other));
  if ((centre_of(best) - centre_of(other)).norm() < kSameTagDistance * edge) return false;
  return other.hamming <= best.hamming ||
         other.decision_margin > kMaxFalseMarginShare * best.decision_margin;
}

}  // namespace

struct TagDetector::State {
  TagDetectorOptions options;
  std::vector<std::unique_ptr<QuadFinder>> finders;
  std::map<std::string, int> cells_along_edge;  // by family
  std::vector<TagDetection> last;               // with copies
  std::vector<MarkerId> seen_twice;
  int width = 0;
  int height = 0;
  int frames_since_full_search = 0;

  std::vector<TagDetection> search(const GrayImage& image, const std::vector<Region>& regions);
  void refine(const GrayImage& image, TagDetection& detection) const;
  [[nodiscard]] std::vector<Region> plan_regions(const GrayImage& image) const;
  [[nodiscard]] bool has_lost_a_tag(const std::vector<TagDetection>& found) const;
  std::vector<TagDetection> remove_copies(const std::vector<TagDetection>& found);
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
  const auto is_before = [](const TagDetection& a, const TagDetection& b) {
    return a.id != b.id ? a.id < b.id : a.decision_margin > b.decision_margin;
  };
  std::stable_sort(detections.begin(), detections.end(), is_before);
  std::vector<TagDetection> kept;  // of each id the one with the largest margin, then its copies
  for (TagDetection& detection : detections) {
    const auto best = std::find_if(kept.begin(), kept.end(), [&](const TagDetection& other) {
      return other.id == detection.id;
    });
    if (best == kept.end() || is_copy(*best, detection)) kept.push_back(std::move(detection));
  }
  return kept;
}

/// Leaves out every id that is there more than once, and remembers it.
std::vector<TagDetection> TagDetector::State::remove_copies(
    const std::vector<TagDetection>& found) {
  std::vector<TagDetection> unique;
  for (std::size_t first = 0; first < found.size();) {
    std::size_t end = first + 1;
    while (end < found.size() && found[end].id == found[first].id) ++end;
    if (end == first + 1) {
      unique.push_back(found[first]);
    } else {
      seen_twice.push_back(found[first].id);
    }
    first = end;
  }
  return unique;
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
    const auto is_same = [&](const TagDetection& other) { return other.id == one.id; };
    return std::count_if(found.begin(), found.end(), is_same) <
           std::count_if(last.begin(), last.end(), is_same);
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
  state.seen_twice.clear();
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
  state.last = std::move(found);
  return state.remove_copies(state.last);
}

const std::vector<MarkerId>& TagDetector::seen_twice() const { return state_->seen_twice; }

}  // namespace pcavr
