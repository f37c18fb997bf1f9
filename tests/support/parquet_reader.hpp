// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"

#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {

inline constexpr char kNoParquetReader[] = "needs npm's hyparquet, which could not be installed";

/// {columns, row_groups, notes, rows} of a Parquet file, by npm's hyparquet; whole numbers are
/// texts in it, NaN is "NaN". Null: the package can't be installed, and the caller skips the test.
inline nlohmann::json read_parquet(const std::filesystem::path& file) {
  static const TemporaryFolder tools;
  const std::string folder = tools.path().string();
  static const bool is_there =
      std::system(
          ("npm install --no-audit --no-fund --no-package-lock hyparquet@1.33.0 --prefix '" +
           folder + "' > /dev/null 2>&1")
              .c_str()) == 0;
  if (!is_there) return nullptr;
  const std::string report = folder + "/read.json";
  const std::string script = (source_folder() / "tests/support/read_parquet.mjs").string();
  const int code = std::system(
      ("node '" + script + "' '" + folder + "' '" + file.string() + "' > '" + report + "' 2>&1")
          .c_str());
  EXPECT_EQ(code, 0) << *read_file(report);
  return nlohmann::json::parse(*read_file(report), nullptr, false);
}

}  // namespace pcavr
