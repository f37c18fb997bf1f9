// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/model/cad_model.hpp"

#include "diagnosis_rows.hpp"
#include "pipeline/checks/consistency_checks.hpp"
#include "pipeline/checks/consistency_text.hpp"
#include "pipeline/robot/recorded_arm.hpp"

namespace pcavr {
namespace {

std::string figure_of(const CadModel& model, const Eigen::Vector3f& sizes,
                      const std::optional<double>& mass) {
  std::string figure = fmt::format("closed, {:.3g} x {:.3g} x {:.3g} m, {:.3g} litres", sizes.x(),
                                   sizes.y(), sizes.z(), 1e3 * model.volume);
  if (mass) {
    figure += fmt::format(", {:.0f} kg/m^3 with its {:.4g} kg", *mass / model.volume, *mass);
  }
  return figure;
}

bool has_finding(const std::vector<ConsistencyFinding>& findings, const std::string& key) {
  return std::any_of(findings.begin(), findings.end(), [&](const ConsistencyFinding& finding) {
    return finding.place == key + ".mesh" || finding.place == key + ".mass";
  });
}

void add_body(const Recording& recording, const ObjectEntry& object,
              const PerceptionOptions& options, const std::vector<ConsistencyFinding>& findings,
              std::vector<DiagnosisRow>& rows) {
  const std::string what = "CAD of " + object.name;
  if (object.mesh.empty()) {
    rows.push_back(unchecked(what, "no mesh is given: build and identify need one (mesh:)"));
    return;
  }
  const auto model =
      read_cad_model(recording.folder / object.mesh, object.name, options.cad, object.mesh_unit);
  if (!model) {
    rows.push_back(row_of(model.error()));
    return;
  }
  const SurfaceQuery surface(model->mesh_object);
  // The movable bodies have been checked with the images.
  if (!object.is_movable) {
    const auto found = check_body(recording.manifest, object, *model, surface, options.consistency);
    for (const ConsistencyFinding& finding : found) {
      rows.push_back(disagreement(finding.input(), finding.message, finding.hint));
    }
    if (!found.empty()) return;
  }
  if (has_finding(findings, key_of_object(recording.manifest, object.name))) return;
  rows.push_back(agreement(what, figure_of(*model, surface.bounds().sizes(), object.mass)));
  if (!object.mass) rows.push_back(unchecked("mass of " + object.name, "it was not weighed"));
}

void add_robot(const Recording& recording, std::vector<DiagnosisRow>& rows) {
  if (!recording.manifest.robot) {
    rows.push_back(unchecked("robot", "recording.yaml names no URDF"));
    return;
  }
  const auto arm = read_recorded_joints(recording);
  if (!arm) {
    rows.push_back(row_of(arm.error()));
    return;
  }
  rows.push_back(agreement(
      "robot", fmt::format("{}: {} joints, tip {}{}", recording.manifest.robot->urdf.string(),
                           (*arm)->model.dof, (*arm)->model.links[(*arm)->tip].name,
                           recording.joints.empty() ? "" : "; joints.csv has these joints")));
}

}  // namespace

std::vector<DiagnosisRow> body_rows(const Recording& recording, const PerceptionOptions& options,
                                    const std::vector<ConsistencyFinding>& findings) {
  std::vector<DiagnosisRow> rows;
  for (const ObjectEntry& object : recording.manifest.objects) {
    add_body(recording, object, options, findings, rows);
  }
  if (recording.manifest.objects.empty()) {
    rows.push_back(unchecked("objects", "recording.yaml declares none"));
  }
  add_robot(recording, rows);
  return rows;
}

}  // namespace pcavr
