// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// The parameters that the operator's site has (transmitted) beside those of the robot's site
/// (running), over the time of a run [paper C, figure 9]. A row where either has changed by more
/// than 0.1 %.
class ParameterHistory {
 public:
  /// `initial`: by object, what both sites have at the start.
  explicit ParameterHistory(std::vector<ObjectParameters> initial);

  /// A message that arrives at `arrival` [s]; messages of one object arrive in order.
  void send(double arrival, std::size_t object, const ObjectParameters& parameters);
  /// The rows of one object at time `t` [s], which does not descend.
  [[nodiscard]] std::vector<ParameterRow> advance(double t, std::size_t object,
                                                  const ObjectParameters& running);

 private:
  struct Arrival {
    double t = 0.0;
    ObjectParameters parameters;
  };
  struct Object {
    ObjectParameters running, transmitted;
    std::deque<Arrival> in_flight = {};
    bool is_written = false;  ///< its first rows
  };
  std::vector<Object> objects_;
};

}  // namespace pcavr
