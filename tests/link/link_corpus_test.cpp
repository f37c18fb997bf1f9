// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

#include "fuzz/targets.hpp"
#include "link/every_message.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

/// The fuzzer's seeds and former findings pass in every build, and contain each type.
TEST(LinkCorpus, PassesForEveryFile) {
  std::set<std::size_t> types;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/link")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(fuzz::link(*bytes)) << entry.path();
    const std::vector<std::uint8_t> content(bytes->begin(), bytes->end());
    const Expected<LinkMessage> message = decode_link_message(content);
    if (message) types.insert(message->content.index());
  }
  EXPECT_EQ(types.size(), test::every_message().size());
}

}  // namespace
}  // namespace pcavr
