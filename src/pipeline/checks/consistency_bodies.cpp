// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Larger than the view of a camera with a range of 5 m [m].
constexpr double kMaxSize = 20.0;
/// Smaller than a pixel at half a metre [m].
constexpr double kMinSize = 0.001;
/// Lighter than expanded foam or heavier than any metal [kg/m^3].
constexpr double kMinDensity = 1.0;
constexpr double kMaxDensity = 25000.0;
/// ConsistencyOptions::tag_offset as a share of the body's size, for plates of large bodies.
constexpr double kTagOffsetShare = 0.05;
/// A tag counts as on a scaled body within this distance [share of the scaled body's size].
constexpr double kFitShare = 0.02;
/// A body's shift by depth that is reported [m]: its tolerance of depth.
constexpr double kMinShift = 0.01;
/// Factor from which on the unit is wrong, not just the model.
constexpr double kUnitFactor = 9.0;

std::string shape_of(const Eigen::Vector3f& sizes) {
  return number(static_cast<double>(sizes.x())) + " x " + number(static_cast<double>(sizes.y())) +
         " x " + metres(static_cast<double>(sizes.z()));
}

/// Candidate scales of a mesh: conversions of units, and a fine grid from a quarter to four.
std::vector<double> candidate_scales() {
  std::vector<double> scales = {1e-3, 1e-2, 0.0254, 0.1, 0.3048, 3.2808, 10.0, 39.370, 100.0, 1e3};
  constexpr int kSteps = 100;
  for (int i = 0; i <= kSteps; ++i) scales.push_back(std::exp2(-2.0 + 4.0 * i / kSteps));
  return scales;
}

class TagsOnBody {
 public:
  TagsOnBody(const std::vector<Eigen::Vector3d>& tags, const SurfaceQuery& surface)
      : tags_(tags), surface_(surface), size_(surface.bounds().sizes().cast<double>().norm()) {
    for (const Eigen::Vector3d& tag : tags) reach_ = std::max(reach_, tag.norm());
  }

  /// Distance of the farthest tag from the body, scaled about its frame's origin [m].
  [[nodiscard]] double distance(double scale) const {
    double farthest = 0.0;
    for (const Eigen::Vector3d& tag : tags_) {
      const Eigen::Vector3f p = (tag / scale).cast<float>();
      const double radius = 2.0 * size_ + 2.0 * static_cast<double>(p.norm());
      const auto closest = surface_.closest(p, static_cast<float>(radius));
      farthest =
          std::max(farthest, scale * (closest ? static_cast<double>(closest->distance) : radius));
    }
    return farthest;
  }

  /// The scale at which all tags lie on the body; nothing where there is none.
  [[nodiscard]] std::optional<double> fitting_scale() const {
    std::optional<double> best;
    double best_share = kFitShare;
    for (const double scale : candidate_scales()) {
      // Relative to the smaller of both: at a huge scale, all tags would lie at the frame's origin.
      const double share = distance(scale) / std::min(scale * size_, reach_);
      if (share >= best_share) continue;
      best = scale;
      best_share = share;
    }
    return best;
  }

  [[nodiscard]] double size() const { return size_; }

 private:
  const std::vector<Eigen::Vector3d>& tags_;
  const SurfaceQuery& surface_;
  double size_;
  double reach_ = 0.0;  ///< of the farthest tag from the frame's origin [m]
};

std::optional<ConsistencyFinding> check_size(const std::string& key, const ObjectEntry& entry,
                                             const Eigen::Vector3f& sizes, double max_usual_size) {
  const double largest = static_cast<double>(sizes.maxCoeff());
  if (largest >= kMinSize && largest <= max_usual_size) return std::nullopt;
  return ConsistencyFinding{
      .severity = largest > kMaxSize ? FindingSeverity::contradiction : FindingSeverity::warning,
      .file = "recording.yaml",
      .place = key + ".mesh",
      .message = entry.mesh.string() + " is " + shape_of(sizes) +
                 (largest > max_usual_size ? ", larger than any object that a tool moves on a table"
                                           : ", smaller than a pixel of a depth camera"),
      .hint = "say the mesh's unit: add unit: mm (or cm, in) to the object"};
}

std::optional<ConsistencyFinding> check_density(const std::string& key, const ObjectEntry& entry,
                                                double volume) {
  if (!entry.mass) return std::nullopt;
  const double density = *entry.mass / volume;
  if (density >= kMinDensity && density <= kMaxDensity) return std::nullopt;
  return ConsistencyFinding{.file = "recording.yaml",
                            .place = key + ".mass",
                            .message = number(*entry.mass) + " kg and " + number(1e3 * volume) +
                                       " litres (" + entry.mesh.string() + ") make " +
                                       number(density) + " kg/m^3, which no material has",
                            .hint =
                                "check the unit of the mesh (metres, or as the object's unit: "
                                "says) and of the mass (kg)"};
}

std::optional<ConsistencyFinding> check_tags(const Manifest& manifest, const std::string& key,
                                             const ObjectEntry& entry, const SurfaceQuery& surface,
                                             double tag_offset) {
  std::vector<Eigen::Vector3d> tags;
  for (const MarkerEntry& marker : manifest.markers) {
    if (marker.role != MarkerRole::object || marker.object != entry.name) continue;
    tags.push_back(marker.T_parent_marker.translation());
  }
  if (tags.empty()) return std::nullopt;
  const TagsOnBody body(tags, surface);
  const double distance = body.distance(1.0);
  if (distance <= std::max(tag_offset, kTagOffsetShare * body.size())) return std::nullopt;
  ConsistencyFinding finding{
      .file = "recording.yaml",
      .place = key + ".mesh",
      .message = "a tag of " + entry.name + " lies " + measured(distance) +
                 " from the surface of " + entry.mesh.string(),
      .hint = "check the unit of the mesh, and the poses of the object's markers"};
  const std::optional<double> scale = body.fitting_scale();
  if (!scale) return finding;
  finding.factor = std::max(*scale, 1.0 / *scale);
  finding.message += std::string("; ") + (tags.size() > 1 ? "all its tags lie" : "it lies") +
                     " on the mesh scaled by " + number(*scale);
  // A tag on a mast is similar to a small factor; there the depth in the outline decides.
  if (finding.factor >= kUnitFactor) finding.severity = FindingSeverity::contradiction;
  return finding;
}

}  // namespace

std::vector<ConsistencyFinding> check_body(const Manifest& manifest, const ObjectEntry& entry,
                                           const CadModel& model, const SurfaceQuery& surface,
                                           const ConsistencyOptions& options) {
  const std::string key = key_of_object(manifest, entry.name);
  std::vector<ConsistencyFinding> findings;
  for (const auto& finding :
       {check_tags(manifest, key, entry, surface, options.tag_offset),
        check_size(key, entry, surface.bounds().sizes(), options.max_body_size),
        check_density(key, entry, model.volume)}) {
    if (finding) findings.push_back(*finding);
  }
  return findings;
}

std::optional<ConsistencyFinding> check_outline(const Manifest& manifest, const ObjectEntry& entry,
                                                const OutlineFit& fit, std::size_t min_frames,
                                                const ConsistencyOptions& options) {
  /// Another scale is accepted where it explains more pixels by this factor.
  constexpr double kDecisiveFactor = 1.5;
  /// The depth must also lie on this share of the scaled body [share of its outline's pixels].
  constexpr double kMinExplained = 0.6;
  if (fit.frames < min_frames) return std::nullopt;
  const auto best = static_cast<std::size_t>(std::max_element(fit.score.begin(), fit.score.end()) -
                                             fit.score.begin());
  if (best == kUnscaled || fit.outline[best] <= 0.0) return std::nullopt;
  if (fit.explained[best] < kMinExplained * fit.outline[best]) return std::nullopt;
  if (fit.score[best] < kDecisiveFactor * fit.score[kUnscaled]) return std::nullopt;
  const double scale = kOutlineScales[best];
  const double factor = std::max(scale, 1.0 / scale);
  return ConsistencyFinding{
      .severity = factor >= options.contradiction_factor ? FindingSeverity::contradiction
                                                         : FindingSeverity::warning,
      .file = "recording.yaml",
      .place = key_of_object(manifest, entry.name) + ".mesh",
      .message = entry.mesh.string() + " does not have the size that depth measures: scaled by " +
                 number(scale) + " it fits best (" + factor_over_frames(factor, fit.frames) + ")",
      .hint =
          "check the mesh's unit (the object's key unit) and scale, or the sizes and poses of the "
          "object's tags",
      .factor = factor,
      .frames = fit.frames};
}

std::optional<ConsistencyFinding> check_place(const Manifest& manifest, const ObjectEntry& entry,
                                              const OutlineFit& fit, std::size_t min_frames) {
  if (fit.frames < min_frames) return std::nullopt;
  const double shift = fit.shift().norm();
  if (shift < kMinShift) return std::nullopt;
  return ConsistencyFinding{
      .file = "recording.yaml",
      .place = key_of_object(manifest, entry.name) + ".mesh",
      .message = entry.name + " is " + measured(shift) + " by depth from where its tags put " +
                 entry.mesh.string() + " (median of " + std::to_string(fit.frames) +
                 " frames); the std of its pose contains it",
      .hint = "check the poses of the object's tags, and the origin of its mesh",
      .frames = fit.frames};
}

}  // namespace pcavr
