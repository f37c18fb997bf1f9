// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// Parameters drawn from what is known of an object: each value with a std from a log-normal
/// distribution of that mean and std, so that none is negative, coupled by the stated correlations
/// (a Gaussian copula). Values without a std stay, and so do the scatter from push to push, which
/// is no uncertainty of a mean, the loading rate, and the limit surface's shape. A draw with a
/// value outside the range of parameter files is drawn again. Sliding forces are scaled by the
/// drawn friction at their speeds. The stds of the result are still those of the distribution.
/// Thread-safe for different generators.
[[nodiscard]] ObjectParameters sample_parameters(const ObjectParameters& known, Random& random);

}  // namespace pcavr
