// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>

#include "pcavr/teleoperation/link/link_message.hpp"

#include "operator_connection.hpp"

namespace pcavr {

/// The pictures of the robot's camera at the operator's site: the newest wins. One thread.
class PictureView {
 public:
  /// A new session: the robot's clock may be another one.
  void restart() { newest_ = -std::numeric_limits<double>::infinity(); }
  /// Acknowledges a picture that arrives at `now` [s]. False if a newer one has overtaken it.
  [[nodiscard]] bool add(const LinkHeader& header, const LinkPicture& picture, double now,
                         OperatorConnection& link) {
    if (!link.shared_clock().is_known()) return false;
    const double received = link.shared_clock().shared_at(now);
    link.send(LinkPictureReceipt{header.sequence, received});
    if (picture.t <= newest_) return false;
    newest_ = picture.t;
    ++count_;
    sum_of_ages_ += received - picture.t;
    return true;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  /// [s] when they arrived.
  [[nodiscard]] double mean_age() const {
    return count_ > 0 ? sum_of_ages_ / static_cast<double>(count_) : 0.0;
  }

 private:
  double newest_ = -std::numeric_limits<double>::infinity();  ///< [s] shared clock
  std::size_t count_ = 0;
  double sum_of_ages_ = 0.0;  ///< [s]
};

}  // namespace pcavr
