// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"

namespace pcavr {

/// A picture of a folder, and the number that ends its name.
struct NumberedPicture {
  std::filesystem::path file;
  int number = 0;
};

/// The PNG and JPEG files with a number, sorted by it, of a folder, which may be named by what its
/// files' names begin with ("rig/color"). An Error where there is none, or a number twice.
[[nodiscard]] Expected<std::vector<NumberedPicture>> list_pictures(const std::string& pictures);

/// Reads a PNG or JPEG file of at most 200 million pixels.
[[nodiscard]] Expected<ColorImage> read_picture(const std::filesystem::path& file);

}  // namespace pcavr
