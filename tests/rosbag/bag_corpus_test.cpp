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

/// The fuzzers' seeds and former findings pass in every build.
TEST(BagCorpus, PassesForEveryFile) {
  const std::pair<const char*, void (*)(std::string_view)> kTargets[] = {
      {"mcap", fuzz::mcap},
      {"ros1_bag", fuzz::ros1_bag},
      {"sqlite_bag", fuzz::sqlite_bag},
      {"ros_message", fuzz::ros_message}};
  for (const auto& [name, target] : kTargets) {
    std::size_t files = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus" / name)) {
      const Expected<std::string> bytes = read_file(entry.path());
      ASSERT_TRUE(bytes.has_value());
      EXPECT_NO_THROW(target(*bytes)) << entry.path();
      ++files;
    }
    EXPECT_GE(files, 2U) << name;
  }
}

}  // namespace
}  // namespace pcavr
