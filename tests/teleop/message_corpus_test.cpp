// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"
#include "teleoperation/teleop/message.hpp"

namespace pcavr {
namespace {

/// The fuzzer's seeds and former findings pass in every build; at least one is a complete
/// message.
TEST(MessageCorpus, PassesForEveryFile) {
  int decoded = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/message")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(fuzz::message(*bytes)) << entry.path();
    const std::vector<std::uint8_t> content(bytes->begin(), bytes->end());
    decoded += decode(content, 0.0).has_value() ? 1 : 0;
  }
  EXPECT_GT(decoded, 0);
}

}  // namespace
}  // namespace pcavr
