// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_layout.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "perception/marker/layout_fit.hpp"
#include "perception/marker/layout_frame.hpp"
#include "perception/marker/layout_start.hpp"

namespace pcavr {
namespace {

/// Frames that are used: those of a walk at 30 Hz resemble each other, and more only cost time.
constexpr std::size_t kMaxLayoutFrames = 400;
/// Frames of each tag that are kept for all that.
constexpr std::size_t kMinTagFrames = 30;
constexpr int kRounds = 2;  ///< cameras are placed anew by the tags of the first
/// Corners that are further from where they should be than this many times the typical residual
/// were misread, or their tag is not there.
constexpr double kMaxResidualRatio = 5.0;
/// A tag has moved where at least so many images show it at either place, and at most this part of
/// them does not fit that.
constexpr std::size_t kMinMoveViews = 5;
constexpr double kMaxMoveErrors = 0.1;
/// Smaller moves are those of a lens model that is wrong in a part of the image [m, rad].
constexpr double kMinMoveOffset = 2e-3;
constexpr double kMinMoveRotation = 1.0 * std::numbers::pi / 180.0;
constexpr double kMinMoveStds = 4.0;
/// Added to the number of a tag at its earlier place.
constexpr int kEarlierId = 1 << 24;
/// A tag that does not fit in this part of its images gets a note.
constexpr double kManyRejected = 0.2;

bool has_tag(const std::vector<LayoutTag>& tags, const MarkerId& id) {
  return std::any_of(tags.begin(), tags.end(), [&](const LayoutTag& tag) { return tag.id == id; });
}

/// The frames to use, at their own indices; the others, and tags that are not the body's, are left
/// out.
std::vector<std::vector<TagDetection>> selected_frames(
    const std::vector<LayoutTag>& tags, const std::vector<std::vector<TagDetection>>& frames) {
  std::vector<std::vector<TagDetection>> selected(frames.size());
  std::vector<std::size_t> useful;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const TagDetection& tag : frames[i]) {
      if (has_tag(tags, tag.id)) selected[i].push_back(tag);
    }
    if (selected[i].size() >= 2) useful.push_back(i);
  }
  std::vector<bool> is_chosen(frames.size(), false);
  const auto choose = [&](const std::vector<std::size_t>& from, std::size_t count) {
    const std::size_t n = std::min(count, from.size());
    for (std::size_t i = 0; i < n; ++i) is_chosen[from[i * from.size() / n]] = true;
  };
  choose(useful, kMaxLayoutFrames);
  for (const LayoutTag& tag : tags) {
    std::vector<std::size_t> showing;
    for (const std::size_t i : useful) {
      const bool is_shown = std::any_of(selected[i].begin(), selected[i].end(),
                                        [&](const TagDetection& one) { return one.id == tag.id; });
      if (is_shown) showing.push_back(i);
    }
    choose(showing, kMinTagFrames);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_chosen[i]) selected[i].clear();
  }
  return selected;
}

/// Views whose camera too few tags determine, apart from those that are fitted.
struct FittedLayout {
  LayoutStart start;
  LayoutProblem problem;
  std::vector<LayoutView> left_out = {};
};

/// [stds] typical residual of a corner: the root of the ratio of the corners' squares to what they
/// would be by their stated stds.
double typical_residual(const LayoutProblem& problem) {
  std::vector<double> squares;
  double residuals = 0.0, freedoms = 0.0;
  for (const LayoutView& view : problem.views) {
    for (const SeenCorners& seen : view.seen) {
      if (!seen.is_used) continue;
      squares.push_back(problem.mean_square(view, seen));
      residuals += 8.0;
    }
    freedoms += 8.0 * static_cast<double>(view.used()) - 6.0;
  }
  return std::sqrt(median(std::move(squares)) / (2.0 * freedoms / residuals));
}

void reject_outliers(FittedLayout& fitted) {
  LayoutProblem& problem = fitted.problem;
  const double typical = typical_residual(problem);
  const double max_square = 2.0 * std::pow(kMaxResidualRatio * typical, 2);
  for (LayoutView& view : problem.views) {
    for (SeenCorners& seen : view.seen) {
      seen.is_used = problem.mean_square(view, seen) <= max_square;
      seen.corner_std *= typical;
    }
  }
  const auto kept = std::stable_partition(problem.views.begin(), problem.views.end(),
                                          [](const LayoutView& view) { return view.used() >= 2; });
  fitted.left_out.insert(fitted.left_out.end(), kept, problem.views.end());
  problem.views.erase(kept, problem.views.end());
}

/// The tags that are used in no view, which the fit does not determine.
std::vector<std::size_t> unused_tags(const LayoutProblem& problem) {
  std::vector<std::size_t> views(problem.sizes.size(), 0);
  for (const LayoutView& view : problem.views) {
    for (const SeenCorners& seen : view.seen) views[seen.tag] += seen.is_used ? 1 : 0;
  }
  std::vector<std::size_t> unused;
  for (std::size_t tag = 0; tag < views.size(); ++tag) {
    if (views[tag] == 0) unused.push_back(tag);
  }
  return unused;
}

/// Without tags that fit in no image, such as those of another size than is stated; the first of
/// the rest is then the datum.
LayoutStart without(const LayoutStart& start, const std::vector<std::size_t>& unused) {
  LayoutStart rest;
  for (std::size_t i = 0; i < start.tags.size(); ++i) {
    if (std::find(unused.begin(), unused.end(), i) != unused.end()) continue;
    rest.tags.push_back(start.tags[i]);
    rest.T_datum_tag.push_back(start.T_datum_tag[i]);
  }
  if (rest.tags.empty()) return rest;
  const Pose T_new_old = rest.T_datum_tag.front().inverse();
  for (Pose& T_datum_tag : rest.T_datum_tag) T_datum_tag = T_new_old * T_datum_tag;
  return rest;
}

/// A layout of the tags of `start`; the tags that have no image left, where it can't be fitted.
struct LayoutTrial {
  std::optional<FittedLayout> fitted = {};
  std::vector<std::size_t> unused = {};
};

LayoutTrial try_layout(const LayoutInput& input, const LayoutStart& start);

/// Nothing where the images do not determine the layout.
std::optional<FittedLayout> fitted_layout(const LayoutInput& input) {
  LayoutStart start = start_layout(input);
  while (start.tags.size() >= 2) {
    LayoutTrial trial = try_layout(input, start);
    if (trial.fitted || trial.unused.empty()) return std::move(trial.fitted);
    start = without(start, trial.unused);
  }
  return std::nullopt;
}

LayoutTrial try_layout(const LayoutInput& input, const LayoutStart& start) {
  FittedLayout fitted{start, {}};
  const auto fits = [&] {
    return unused_tags(fitted.problem).empty() && !fitted.problem.views.empty() &&
           fit_layout(fitted.problem);
  };
  for (int round = 0; round < kRounds; ++round) {
    fitted.left_out.clear();
    fitted.problem = place_cameras(input, fitted.start);
    if (!fits()) return {{}, unused_tags(fitted.problem)};
    for (int i = 0; i < 2; ++i) {
      reject_outliers(fitted);
      if (!fits()) return {{}, unused_tags(fitted.problem)};
    }
    fitted.start.T_datum_tag = fitted.problem.T_layout_tag;
  }
  return {std::move(fitted), {}};
}

/// Whether the tag fits, image by image, in order of time.
struct Fits {
  std::vector<std::size_t> frames = {};
  std::vector<bool> fits = {};
};

Fits fits_of(const FittedLayout& fitted, std::size_t tag) {
  std::vector<std::pair<std::size_t, bool>> seen;
  for (const auto* views : {&fitted.problem.views, &fitted.left_out}) {
    for (const LayoutView& view : *views) {
      for (const SeenCorners& corners : view.seen) {
        if (corners.tag == tag) seen.emplace_back(view.frame, corners.is_used);
      }
    }
  }
  std::sort(seen.begin(), seen.end());
  Fits fits;
  for (const auto& [frame, is_fitting] : seen) {
    fits.frames.push_back(frame);
    fits.fits.push_back(is_fitting);
  }
  return fits;
}

/// The split before which the tag fits and after which it does not, or the reverse.
std::optional<TagMove> split_of(const Fits& fits) {
  const std::size_t n = fits.fits.size();
  const auto fitting =
      static_cast<std::size_t>(std::count(fits.fits.begin(), fits.fits.end(), true));
  std::size_t before = 0, best = n, at = 0;  // fitting ones before the split
  for (std::size_t k = 1; k < n; ++k) {
    before += fits.fits[k - 1] ? 1 : 0;
    if (k < kMinMoveViews || n - k < kMinMoveViews) continue;
    const std::size_t wrong = (k - before) + (fitting - before);
    const std::size_t errors = std::min(wrong, n - wrong);
    if (errors >= best) continue;
    best = errors;
    at = k;
  }
  if (at == 0 || static_cast<double>(best) > kMaxMoveErrors * static_cast<double>(n)) {
    return std::nullopt;
  }
  return TagMove{.last_before = fits.frames[at - 1], .first_after = fits.frames[at]};
}

/// A layout in which the tag at its earlier place is another tag, the last one.
std::optional<FittedLayout> split_layout(LayoutInput& input, std::size_t tag, TagMove& move) {
  LayoutInput split = input;
  LayoutTag earlier{.id = input.tags[tag].id, .size = input.tags[tag].size};
  earlier.id.id += kEarlierId;
  split.tags.push_back(earlier);
  for (std::size_t i = 0; i <= move.last_before; ++i) {
    for (TagDetection& detection : split.frames[i]) {
      if (detection.id == input.tags[tag].id) detection.id = earlier.id;
    }
  }
  std::optional<FittedLayout> fitted = fitted_layout(split);
  if (!fitted) return std::nullopt;
  const auto place = [&](std::size_t index) {
    const auto& tags = fitted->start.tags;
    return static_cast<std::size_t>(std::find(tags.begin(), tags.end(), index) - tags.begin());
  };
  const std::size_t a = place(split.tags.size() - 1), b = place(tag);
  if (a == fitted->start.tags.size() || b == fitted->start.tags.size()) return std::nullopt;
  const Pose T_earlier_later =
      fitted->problem.T_layout_tag[a].inverse() * fitted->problem.T_layout_tag[b];
  move.offset = T_earlier_later.translation().norm();
  move.rotation = rotation_distance(Pose(), T_earlier_later);
  const Eigen::MatrixXd covariance = layout_covariance(fitted->problem).matrix;
  const auto variance = [&](std::size_t index, Eigen::Index row) {
    return covariance.diagonal().segment<3>(6 * static_cast<Eigen::Index>(index) + row).sum();
  };
  const double position_std = std::sqrt(variance(a, 0) + variance(b, 0));
  const double rotation_std = std::sqrt(variance(a, 3) + variance(b, 3));
  const bool is_move =
      (move.offset > kMinMoveOffset && move.offset > kMinMoveStds * position_std) ||
      (move.rotation > kMinMoveRotation && move.rotation > kMinMoveStds * rotation_std);
  if (!is_move) return std::nullopt;
  input = std::move(split);
  return fitted;
}

/// Splits the tags that were moved while the images were taken.
std::map<MarkerId, TagMove> find_moves(LayoutInput& input, FittedLayout& fitted) {
  std::map<MarkerId, TagMove> moves;
  const std::size_t count = input.tags.size();
  // Of two tags either may have moved: at least two others show which.
  for (std::size_t i = 0; i < count && count > 2; ++i) {
    const auto& placed = fitted.start.tags;
    const auto found = std::find(placed.begin(), placed.end(), i);
    if (found == placed.end()) continue;
    std::optional<TagMove> move =
        split_of(fits_of(fitted, static_cast<std::size_t>(found - placed.begin())));
    if (!move) continue;
    std::optional<FittedLayout> split = split_layout(input, i, *move);
    if (!split) continue;
    fitted = *std::move(split);
    moves.emplace(input.tags[i].id, *move);
  }
  return moves;
}

LaidOutTag laid_out(const FittedLayout& fitted, std::size_t index, const LayoutTag& tag) {
  LaidOutTag result{.id = tag.id, .size = tag.size};
  double squares = 0.0;
  for (const auto* views : {&fitted.problem.views, &fitted.left_out}) {
    for (const LayoutView& view : *views) {
      for (const SeenCorners& seen : view.seen) {
        if (seen.tag != index) continue;
        const bool is_used = seen.is_used && views == &fitted.problem.views;
        ++(is_used ? result.views : result.rejected);
        if (!is_used) continue;
        squares += fitted.problem.mean_square(view, seen) * seen.corner_std * seen.corner_std;
      }
    }
  }
  result.pixel_rms =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, result.views)));
  return result;
}

std::string views_note(const LaidOutTag& tag) {
  return fmt::format("{} does not fit in {} of {} images: left out there", tag.id.to_string(),
                     tag.rejected, tag.rejected + tag.views);
}

double worst_std(const Matrix6d& covariance, Eigen::Index row) {
  const Eigen::Matrix3d block = covariance.block<3, 3>(row, row);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

Error undetermined(const std::vector<LayoutTag>& tags) {
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, tags.size()); ++i) {
    names += (i > 0 ? ", " : "") + tags[i].id.to_string();
  }
  if (tags.size() > 3) names += ", ...";
  return {.message = "no two of the tags " + names +
                     " are together in images from which their places follow",
          .hint = "take pictures that show two tags and more at once, each from several sides"};
}

}  // namespace

double LaidOutTag::position_std() const { return worst_std(covariance, 0); }

double LaidOutTag::rotation_std() const { return worst_std(covariance, 3); }

Expected<TagLayout> solve_tag_layout(const std::vector<LayoutTag>& tags,
                                     const std::vector<std::vector<TagDetection>>& frames,
                                     const CameraModel& camera, const BodyPoseOptions& options) {
  LayoutInput input{tags, selected_frames(tags, frames), camera, options};
  std::optional<FittedLayout> fitted = fitted_layout(input);
  if (!fitted) return undetermined(tags);
  const std::map<MarkerId, TagMove> moves = find_moves(input, *fitted);
  const LayoutProblem& problem = fitted->problem;

  std::vector<LayoutTag> placed;
  for (const std::size_t index : fitted->start.tags) placed.push_back(input.tags[index]);
  const Expected<LayoutFrame> frame = find_layout_frame(placed, problem.T_layout_tag);
  if (!frame) return frame.error();
  const LayoutCovariance spread = layout_covariance(problem);
  // Without stated poses the frame is that of the datum, the first of `placed`.
  const std::vector<std::size_t> references =
      frame->references.empty() ? std::vector<std::size_t>{0} : frame->references;
  const Eigen::MatrixXd covariance =
      covariance_in_frame(placed, problem.T_layout_tag, references, spread.matrix);

  TagLayout layout{.correlation = spread.correlation};
  double squares = 0.0, corners = 0.0;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto& order = fitted->start.tags;
    const auto found = std::find(order.begin(), order.end(), i);
    if (found == order.end()) {
      layout.unlinked.push_back(tags[i].id);
      continue;
    }
    const auto index = static_cast<std::size_t>(found - order.begin());
    LaidOutTag tag = laid_out(*fitted, index, tags[i]);
    tag.T_body_tag = frame->T_body_layout * problem.T_layout_tag[index];
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(index);
    tag.covariance = covariance.block<6, 6>(row, row);
    tag.is_reference = std::find(references.begin(), references.end(), index) != references.end();
    if (tags[i].T_body_tag) tag.shift = shift_of(tag.T_body_tag, *tags[i].T_body_tag);
    const auto move = moves.find(tag.id);
    if (move != moves.end()) tag.move = move->second;
    if (static_cast<double>(tag.rejected) >
        kManyRejected * static_cast<double>(tag.rejected + tag.views)) {
      layout.notes.push_back(views_note(tag));
    }
    squares += tag.pixel_rms * tag.pixel_rms * static_cast<double>(tag.views);
    corners += static_cast<double>(tag.views);
    layout.tags.push_back(std::move(tag));
  }
  layout.pixel_rms = std::sqrt(squares / std::max(1.0, corners));
  layout.T_body_camera.resize(frames.size());
  for (const LayoutView& view : problem.views) {
    layout.T_body_camera[view.frame] = frame->T_body_layout * view.T_camera_layout.inverse();
  }
  return layout;
}

}  // namespace pcavr
