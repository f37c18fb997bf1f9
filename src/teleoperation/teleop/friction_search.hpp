// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// A push in which the object slid, with what is needed to identify from it again.
struct StoredPush {
  IdentifiedContact contact;
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<TrackedPose> tracked;
};

/// The search for M, mu, B and F_M in an object's pushes: 20 to 200 ms of CPU, apart from the
/// knowledge, which goes on meanwhile. Copies are cheap: the pushes are shared.
struct FrictionSearch {
  struct Push {
    std::shared_ptr<const StoredPush> stored;
    std::shared_ptr<const PushEvidence> shown;  ///< by a search before; may be empty
  };
  struct Findings {
    ObjectIdentification object;
    std::vector<Push> pushes;  ///< with what they have shown
  };

  std::vector<Push> pushes = {};         ///< in order of time
  std::vector<double> press_peaks = {};  ///< [N] by which the contact law was seen
  ObjectParameters known = {};           ///< with the mass if it was weighed only
  ContactIdentification presses = {};    ///< that gave the contact law
  double penetration_std = 0.0;          ///< relative, by the contact law; 0: it was given
  IdentificationOptions options = {};
  const CadModel* model = nullptr;  ///< of a tracked object; outlives the search
  double tool_radius = 0.0;         ///< [m]

  /// Findings of `identify_friction_of` in these pushes. Pure function.
  [[nodiscard]] Findings run() const;
};

}  // namespace pcavr
