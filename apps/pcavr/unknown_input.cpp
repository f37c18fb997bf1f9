// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "unknown_input.hpp"

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

namespace pcavr::app {

Error unknown_input(const std::filesystem::path& path) {
  Error error{.message = "is no recording, scene, run or bag",
              .file = path.string(),
              .hint = "give the folder of a recording, a scene or a run, or a bag"};
  if (!std::filesystem::is_directory(path)) return error;
  error.message = "contains no recording.yaml, scene.yaml or run.yaml, and is no bag";
  std::vector<std::filesystem::path> bags;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(path, code)) {
    if (is_bag(entry.path())) bags.push_back(entry.path());
  }
  if (bags.empty()) return error;
  error.hint = fmt::format("it holds bags: give one, such as {}",
                           std::min_element(bags.begin(), bags.end())->string());
  return error;
}

}  // namespace pcavr::app
