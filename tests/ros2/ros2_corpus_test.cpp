// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// The fuzzer's seeds and former findings pass in every build.
TEST(Ros2Corpus, PassesForEveryFile) {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/ros2_intake")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(fuzz::ros2_intake(*bytes)) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 2U);
}

}  // namespace
}  // namespace pcavr
