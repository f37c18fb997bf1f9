// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

/// Receives what the operator's site predicts, at that site for each command that it sends, at the
/// robot's site for each one that is executed.
class PredictionSink {
 public:
  virtual ~PredictionSink() = default;
  /// The predictions of all objects, in the scene's order, for `ahead` seconds from now. From the
  /// site's thread, up to once a cycle: it must neither allocate, lock nor wait.
  virtual void on_predictions(double ahead,
                              const std::vector<LinkPrediction>& predictions) noexcept = 0;
};

}  // namespace pcavr
