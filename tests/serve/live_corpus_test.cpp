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

TEST(LiveCorpus, DecodesOrRejectsEveryMessageAndEveryTruncation) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/live")) {
    const std::string bytes = read_file(entry.path()).value();
    for (std::size_t length = 0; length <= bytes.size(); ++length) {
      EXPECT_NO_THROW(fuzz::live(std::string_view(bytes).substr(0, length)))
          << entry.path() << " cut to " << length;
    }
    ++files;
  }
  EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace pcavr
