// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/calibration/input_checks.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "robots/calibration/closed_form.hpp"
#include "robots/calibration/refine_rig.hpp"
#include "robots/calibration/rig_fit.hpp"

namespace pcavr {
namespace {

/// A change of the input explains it where the residuals fall to this part: a correct one removes
/// them but for noise, and no other one does.
constexpr double kMaxRest = 0.25;
constexpr double kMisfitLever = 0.3;  ///< [m] by which rotations count against positions
/// Residuals that are no fault of the input: no change is tried.
constexpr double kGoodPosition = 2e-3;  // [m]
constexpr double kGoodRotation = 5e-3;  // [rad]
/// [rad] and [m] Beyond them the poses are not of one board at all.
constexpr double kMaxMisfitRotation = 0.35;
/// Board sizes within these bounds are wrong by a little, and estimated.
constexpr double kMinScale = 0.8, kMaxScale = 1.25;

Pose w_first(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return Pose(Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), pose.translation());
}

Pose degrees(const Pose& pose) {
  const Eigen::AngleAxisd turn(pose.rotation());
  const Eigen::AngleAxisd small(turn.angle() * std::numbers::pi / 180.0, turn.axis());
  return Pose(Eigen::Quaterniond(small), pose.translation());
}

/// The pose in frames whose x axes point the other way, as a mirrored picture shows it.
Pose mirrored(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  const Eigen::Vector3d& p = pose.translation();
  return Pose(Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z()), {-p.x(), p.y(), p.z()});
}

using Change = std::function<Pose(const Pose&)>;

struct InputFault {
  const char* place;
  Change change;
  std::string message;
  std::string hint;
};

std::vector<InputFault> faults_of(CameraMount mount) {
  const auto inverse = [](const Pose& pose) { return pose.inverse(); };
  const char* other = mount == CameraMount::arm ? "base" : "arm";
  const char* where = mount == CameraMount::arm ? "beside the arm" : "on the arm";
  return {{"ROBOT", inverse,
           "the poses fit when they are inverted: they may be those of the base in the "
           "flange",
           fmt::format("give --invert robot; or --camera-on {} where the camera stands {}", other,
                       where)},
          {"CAMERA", inverse,
           "the poses fit when they are inverted: they are those of the camera in the "
           "board's frame",
           "give --invert camera"},
          {"ROBOT", w_first, "the poses fit with quaternions as w x y z", "give --w-first robot"},
          {"CAMERA", w_first, "the poses fit with quaternions as w x y z", "give --w-first camera"},
          {"ROBOT", degrees, "the poses fit with rotation vectors in degrees",
           "name the columns in the header rx_deg, ry_deg, rz_deg"},
          {"CAMERA", degrees, "the poses fit with rotation vectors in degrees",
           "name the columns in the header rx_deg, ry_deg, rz_deg"},
          {"CAMERA", mirrored,
           "the poses fit when they are mirrored: the pictures are mirrored, or the "
           "frames left-handed",
           "give --left-handed x, or pictures that are not mirrored"}};
}

std::vector<std::size_t> all_of(const std::vector<RigView>& views) {
  std::vector<std::size_t> indices(views.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

struct Misfit {
  double value = 0.0;  ///< [m] position and rotation together
  TypicalResidual typical;
};

std::optional<Misfit> misfit_of(const std::vector<RigView>& views) {
  const std::vector<std::size_t> indices = all_of(views);
  std::optional<Rig> rig = find_start(views, indices);
  if (!rig) return std::nullopt;
  const TypicalResidual start = typical_residual(views, indices, *rig);
  *rig = refine_robustly(views, indices, *rig, start.position, start.rotation);
  const TypicalResidual typical = typical_residual(views, indices, *rig);
  return Misfit{typical.position + kMisfitLever * typical.rotation, typical};
}

bool explains(const std::optional<Misfit>& changed, const Misfit& given) {
  return changed && changed->value < kMaxRest * given.value;
}

std::optional<Error> find_scale_error(const std::vector<RigView>& views, const Misfit& given) {
  const std::optional<Rig> scaled = solve_by_park(motion_pairs(views, all_of(views)), true);
  if (!scaled) return std::nullopt;
  const double scale = scaled->board_scale;
  if (!(scale > 0.0) || (scale > kMinScale && scale < kMaxScale)) return std::nullopt;
  std::vector<RigView> changed = views;
  for (RigView& view : changed) {
    view.T_camera_board =
        Pose(view.T_camera_board.rotation(), scale * view.T_camera_board.translation());
  }
  if (!explains(misfit_of(changed), given)) return std::nullopt;
  const double thousand = scale > 1.0 ? scale / 1000.0 : 1000.0 * scale;
  const bool is_unit = thousand > kMinScale && thousand < kMaxScale;
  return Error{
      .message = fmt::format("lengths fit the arm's when they are multiplied by {:.3g}", scale),
      .place = "CAMERA",
      .hint = is_unit ? "one of both inputs is in mm: name its unit in the header (x_mm), or give "
                        "--unit mm"
                      : "check the size of the board's squares that the poses were computed with"};
}

/// The partner of each view is the one before or after.
std::optional<Error> find_shift(const std::vector<RigView>& views, const Misfit& given) {
  constexpr std::size_t kMinShifted = 6;
  if (views.size() < kMinShifted) return std::nullopt;
  for (const bool is_later : {true, false}) {
    std::vector<RigView> shifted;
    for (std::size_t i = 1; i < views.size(); ++i) {
      shifted.push_back(is_later ? RigView{views[i - 1].T_world_mount, views[i].T_camera_board}
                                 : RigView{views[i].T_world_mount, views[i - 1].T_camera_board});
    }
    if (!explains(misfit_of(shifted), given)) continue;
    return Error{.message = fmt::format("each pose of CAMERA fits the pose of ROBOT one view {}",
                                        is_later ? "before" : "after"),
                 .place = "CAMERA",
                 .hint = "pair them anew: one view is missing at the start of one of them"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> find_input_error(const std::vector<RigView>& views, CameraMount mount) {
  const std::optional<Misfit> given = misfit_of(views);
  if (!given) return std::nullopt;
  if (given->typical.position < kGoodPosition && given->typical.rotation < kGoodRotation) {
    return std::nullopt;
  }
  const std::vector<InputFault> faults = faults_of(mount);
  const InputFault* found = nullptr;
  double best = 0.0;
  for (const InputFault& fault : faults) {
    std::vector<RigView> changed = views;
    for (RigView& view : changed) {
      Pose& pose = fault.place[0] == 'R' ? view.T_world_mount : view.T_camera_board;
      pose = fault.change(pose);
    }
    const std::optional<Misfit> misfit = misfit_of(changed);
    if (!explains(misfit, *given) || (found != nullptr && misfit->value >= best)) continue;
    found = &fault;
    best = misfit->value;
  }
  if (found != nullptr) {
    return Error{.message = found->message, .place = found->place, .hint = found->hint};
  }
  if (auto error = find_scale_error(views, *given)) return error;
  if (auto error = find_shift(views, *given)) return error;
  if (given->typical.rotation < kMaxMisfitRotation) return std::nullopt;
  return Error{.message = fmt::format("ROBOT and CAMERA do not show one motion: their rotations "
                                      "differ by {:.0f} degrees",
                                      given->typical.rotation * 180.0 / std::numbers::pi),
               .place = "CAMERA",
               .hint = "check that the board did not move, and which view belongs to which"};
}

}  // namespace pcavr
