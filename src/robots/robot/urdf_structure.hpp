// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::robot {

/// An element <link> or <joint> and where it is.
struct UrdfElement {
  std::string name;
  int line = 0;
};

struct UrdfJointElement : UrdfElement {
  std::string type;
  std::size_t parent = 0;  ///< index in UrdfStructure::links
  std::size_t child = 0;
};

/// The tree of a description, checked: one root, no loops, all names unique and known.
struct UrdfStructure {
  std::string robot_name;
  std::vector<UrdfElement> links;        ///< in the order of the file
  std::vector<UrdfJointElement> joints;  ///< in the order of the file
  /// Links from the root on, depth first, in the order of the file; and each one's joint to its
  /// parent (none for the root).
  struct Step {
    std::size_t link = 0;
    std::optional<std::size_t> joint;
  };
  std::vector<Step> order;
};

/// Errors have file, line, link or joint, and a hint.
[[nodiscard]] Expected<UrdfStructure> parse_urdf_structure(const std::string& text,
                                                           const std::filesystem::path& file);

}  // namespace pcavr::robot
