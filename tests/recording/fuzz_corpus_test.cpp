// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "fuzz/targets.hpp"
#include "support/shared_data.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

using Target = std::pair<const char*, void (*)(std::string_view)>;

class FuzzCorpus : public testing::TestWithParam<Target> {};

/// The fuzzers' seeds and past findings (regressions) pass in every build.
TEST_P(FuzzCorpus, PassesForEveryFile) {
  const auto& [name, check] = GetParam();
  const auto folder = source_folder() / "tests/fuzz/corpus" / name;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Expected<std::string> bytes = read_file(entry.path());
    ASSERT_TRUE(bytes.has_value());
    EXPECT_NO_THROW(check(*bytes)) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Each, FuzzCorpus,
    testing::Values(Target{"manifest", fuzz::manifest}, Target{"camera_file", fuzz::camera_file},
                    Target{"image_list", fuzz::image_list}, Target{"series", fuzz::series},
                    Target{"image", fuzz::image}, Target{"parameters", fuzz::parameters}),
    [](const auto& test) { return std::string(test.param.first); });

}  // namespace
}  // namespace pcavr
