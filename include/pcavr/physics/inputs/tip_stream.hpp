// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/input_options.hpp"
#include "pcavr/physics/inputs/noise_tracker.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"

namespace pcavr {

/// The tip's path without outliers, as it comes: by the rules of `clean_tip_path`, with a sample's
/// fate decided three samples later, but no later than 8 ms. The newest samples are stored,
/// `discard_before` removes old ones. Not thread-safe.
class TipStream {
 public:
  /// `prior_noise` [m]: std of one sample until it is measured.
  TipStream(double prior_noise, const InputOptions& options);

  /// `t` [s] later than the one before.
  void add(double t, const Eigen::Vector3d& p_base_tip);

  [[nodiscard]] std::span<const double> t() const { return t_; }  ///< [s] of accepted samples
  [[nodiscard]] std::span<const Eigen::Vector3d> p_base() const { return p_base_; }  ///< [m]
  /// Linear interpolation; constant beyond the stored samples. Needs an accepted sample.
  [[nodiscard]] Eigen::Vector3d at(double time) const;
  [[nodiscard]] bool empty() const { return t_.empty(); }
  /// [s] up to which all samples were accepted or rejected; empty before the first.
  [[nodiscard]] std::optional<double> known_until() const { return known_until_; }
  [[nodiscard]] double interval() const;                           ///< mean [s]
  [[nodiscard]] double noise() const { return noise_.largest(); }  ///< [m] std, largest axis
  /// Around jumps and dropouts, of the stored time, in order.
  [[nodiscard]] const std::vector<UnusableInterval>& bad() const { return bad_; }
  /// Samples before `time` [s] will not be requested again.
  void discard_before(double time);

 private:
  struct Raw {
    double t = 0.0;
    Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  };
  [[nodiscard]] bool is_spike(std::size_t index) const;
  void decide(const Raw& sample, bool is_spike);
  void accept(const Raw& sample);
  void reject(const Raw& sample);
  void find_jump();
  void note_bad(double begin, double end);

  InputOptions options_;
  NoiseTracker noise_;
  std::deque<Raw> raw_;  ///< the newest: undecided ones, and those before that their filter needs
  std::size_t decided_ = 0;  ///< of raw_
  std::optional<double> known_until_ = {};
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> p_base_;
  std::size_t rejected_in_a_row_ = 0;
  double rejected_since_ = 0.0;           ///< [s]
  std::optional<double> last_jump_ = {};  ///< [s]
  std::vector<UnusableInterval> bad_;
};

}  // namespace pcavr
