// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/support_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "pcavr/base/geometry/convex_hull.hpp"
#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/friction/patch.hpp"
#include "pcavr/physics/friction/point_push.hpp"

namespace pcavr::detail {
namespace {

constexpr int kCells = 16;    // across the patch: its surface is then accurate to 1 %
constexpr int kTwists = 200;  // a dozen for each of a quartic's coefficients

/// The convex hull of points with z = 0.
std::vector<Eigen::Vector2d> flat_hull(std::vector<Eigen::Vector3d> points) {
  std::vector<Eigen::Vector2d> outline;
  for (const Eigen::Vector3d& p : convex_hull_xy(std::move(points))) {
    outline.emplace_back(p.head<2>());
  }
  return outline;
}

bool is_inside(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d edge = outline[(k + 1) % outline.size()] - outline[k];
    const Eigen::Vector2d offset = p - outline[k];
    if (edge.x() * offset.y() - edge.y() * offset.x() < 0.0) return false;
  }
  return true;
}

/// The centres of a grid's cells that lie inside a convex outline.
std::vector<Eigen::Vector2d> cells_of(const std::vector<Eigen::Vector2d>& outline) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : outline) box.extend(corner);
  std::vector<Eigen::Vector2d> cells;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Eigen::Vector2d share((i + 0.5) / kCells, (j + 0.5) / kCells);
      const Eigen::Vector2d p = box.min() + share.cwiseProduct(box.sizes());
      if (is_inside(outline, p)) cells.push_back(p);
    }
  }
  return cells;
}

}  // namespace

SupportPatch support_patch(const CadModel& model, const Pose& T_base_object, double height) {
  const Eigen::Vector3d centre = T_base_object * model.centre_of_mass_object;
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& v : model.mesh_object.vertices) {
    lowest = std::min(lowest, (T_base_object * v.cast<double>()).z());
  }
  std::vector<Eigen::Vector3d> all, in_contact;
  for (const auto& v : model.mesh_object.vertices) {
    const Eigen::Vector3d p = T_base_object * v.cast<double>();
    all.emplace_back(p.x() - centre.x(), p.y() - centre.y(), 0.0);
    if (p.z() <= lowest + height) in_contact.push_back(all.back());
  }
  SupportPatch patch;
  patch.outline = flat_hull(std::move(in_contact));
  patch.projection = flat_hull(std::move(all));
  return patch;
}

double radius_of(const SupportPatch& patch) {
  const double radius = mean_radius(patch.outline, Eigen::Vector2d::Zero());
  if (radius > 0.0) return radius;
  // It stands on an edge or a point, which in reality is a small patch: the mean of none and the
  // whole projection.
  return 0.5 * mean_radius(patch.projection, Eigen::Vector2d::Zero());
}

std::optional<LimitSurface> surface_of(const SupportPatch& patch, double radius, double heading) {
  std::vector<Eigen::Vector2d> cells = cells_of(patch.outline);
  double mean = 0.0;
  for (const Eigen::Vector2d& cell : cells) mean += cell.norm() / static_cast<double>(cells.size());
  if (!(mean > 0.0)) return std::nullopt;
  const Eigen::Matrix2d placing = radius / mean * Eigen::Rotation2Dd(-heading).toRotationMatrix();
  for (Eigen::Vector2d& cell : cells) cell = placing * cell;

  std::vector<PushSample> pushes(kTwists);
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kTwists; ++i) {  // a Fibonacci spiral over the sphere of twists
    const double turning = 1.0 - (2.0 * i + 1.0) / kTwists;
    const double moving = std::sqrt(1.0 - turning * turning);
    PushSample& push = pushes[static_cast<std::size_t>(i)];
    push.twist = {moving * std::cos(golden * i), moving * std::sin(golden * i), turning / radius};
    for (const Eigen::Vector2d& cell : cells) {
      const Eigen::Vector2d force = velocity_of(cell, push.twist).normalized();
      push.wrench += wrench_of(force, cell) / static_cast<double>(cells.size());
    }
  }
  const LimitSurfaceFit fit = fit_limit_surface(pushes);
  if (fit.status != LimitSurfaceFitStatus::fitted) return std::nullopt;
  return fit.surface;
}

}  // namespace pcavr::detail
