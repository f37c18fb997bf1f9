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

TEST(MeshCorpus, PassesForEveryFile) {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/mesh")) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(fuzz::mesh(*bytes)) << entry.path();
    // Cut anywhere, it is a fault or a part of the mesh.
    for (std::size_t size = 0; size < bytes->size(); ++size) {
      EXPECT_NO_THROW(fuzz::mesh(std::string_view(*bytes).substr(0, size))) << entry.path();
    }
    ++files;
  }
  EXPECT_GE(files, 8U);
}

}  // namespace
}  // namespace pcavr
