// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// The fuzzer's seeds and former findings pass in every build, whole or cut.
TEST(SceneFiles, CorpusOfTheFuzzer) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/scene")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(fuzz::scene(*bytes)) << entry.path();
    for (std::size_t size = 0; size < bytes->size(); size += 1 + size / 50) {
      EXPECT_NO_THROW(fuzz::scene(std::string_view(*bytes).substr(0, size))) << entry.path();
    }
    ++files;
  }
  EXPECT_GE(files, 4);
}

}  // namespace
}  // namespace pcavr
