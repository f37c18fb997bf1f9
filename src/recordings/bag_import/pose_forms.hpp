// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "recordings/bag_import/csv_layout.hpp"

namespace pcavr {

/// The numbers of a row [SI] in the order in which ROS has them; `is_y_up`: with axes of which z is
/// up, of the world and of bodies. Gives a text where they make no pose: its fault.
struct MessageNumbers {
  std::vector<double> values = {};
  std::string fault = {};  ///< empty: none
};
[[nodiscard]] MessageNumbers message_numbers(const CsvLayout::Series& series, bool is_y_up,
                                             std::vector<double> numbers);

}  // namespace pcavr
