// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/occupancy_tree.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// The fuzzer's seeds and former findings, and all of their beginnings, pass in every build.
TEST(OccupancyTree, CorpusOfTheFuzzer) {
  int trees = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/octomap")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    for (std::size_t size = 0; size <= bytes->size(); ++size) {
      EXPECT_NO_THROW(fuzz::octomap(std::string_view(*bytes).substr(0, size))) << entry.path();
    }
    trees += OccupancyTree::parse(*bytes, "tree").has_value() ? 1 : 0;
  }
  EXPECT_GE(trees, 3);
}

}  // namespace
}  // namespace pcavr
