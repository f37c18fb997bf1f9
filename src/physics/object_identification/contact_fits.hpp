// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "pcavr/physics/identification/contact_fit.hpp"

namespace pcavr {

/// The newest fits of the contact law by one set of options: with each further contact, most
/// presses and faces stay what they were, and their fits are the dearest part of a result.
/// Thread-safe.
class ContactFits {
 public:
  /// As `identify_contact`. Of `options`, only whether the surface is shared and the exponent may
  /// differ from call to call.
  [[nodiscard]] ContactIdentification fit(std::span<const ForceMotion> contacts,
                                          const ContactFitOptions& options,
                                          std::span<const ForceMotion> local = {});

 private:
  struct Entry {
    std::vector<double> inputs;  ///< all that the fit depends on
    ContactIdentification found;
  };
  std::mutex mutex_;
  std::array<Entry, 64> entries_;  ///< of two for each face and one for each push
  std::size_t oldest_ = 0;
};

}  // namespace pcavr
