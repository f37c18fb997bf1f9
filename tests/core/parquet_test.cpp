// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Parquet files, read by npm's hyparquet, another implementation.
#include "pcavr/base/core/parquet.hpp"

#include <array>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"

#include "support/parquet_reader.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// All types, with what is special in each.
ParquetColumns all_types() {
  return {{"whole", std::vector<std::int64_t>{-5, 9007199254740993, 0}},
          {"double", std::vector<double>{0.1, -1e300, 0.0}},
          {"float", std::vector<float>{1.5F, -2.25F, 0.1F}},
          {"flag", std::vector<bool>{true, false, true}},
          {"text", std::vector<std::string>{"\xC3\xA9t\xC3\xA9", "", "a,\"b\"\n"}},
          {"maybe", std::vector<std::optional<double>>{std::nullopt, 2.5, std::nullopt}},
          {"floats", std::vector<std::vector<float>>{{1.0F, 2.0F}, {}, {3.0F}}},
          {"doubles", std::vector<std::vector<double>>{{}, {}, {0.1, 0.2, 0.3}}},
          {"texts", std::vector<std::vector<std::string>>{{"a", "bc"}, {""}, {}}}};
}

TEST(Parquet, HasTheValuesOfAllTypesInEachRowGroup) {
  const TemporaryFolder folder;
  const std::vector<ParquetColumns> groups{all_types(), all_types()};
  ASSERT_TRUE(
      write_file(folder.path() / "all.parquet", format_parquet(groups, {{"key", "value"}})));
  const nlohmann::json read = read_parquet(folder.path() / "all.parquet");
  if (read.is_null()) GTEST_SKIP() << kNoParquetReader;
  EXPECT_EQ(read["notes"], nlohmann::json({{"key", "value"}}));
  EXPECT_EQ(read["row_groups"], 2);
  const nlohmann::json once = nlohmann::json::parse(R"([
    {"whole": "-5", "double": 0.1, "float": 1.5, "flag": true, "text": "été", "maybe": null,
     "floats": [1, 2], "doubles": [], "texts": ["a", "bc"]},
    {"whole": "9007199254740993", "double": -1e300, "float": -2.25, "flag": false, "text": "",
     "maybe": 2.5, "floats": [], "doubles": [], "texts": [""]},
    {"whole": "0", "double": 0, "float": 0.10000000149011612, "flag": true, "text": "a,\"b\"\n",
     "maybe": null, "floats": [3], "doubles": [0.1, 0.2, 0.3], "texts": []}])");
  ASSERT_EQ(read["rows"].size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(read["rows"][i], once[i % 3]) << i;
}

// Lengths and levels beyond a byte: more than 15 columns and notes, runs of more than 63 levels.
TEST(Parquet, HoldsLongTables) {
  const TemporaryFolder folder;
  ParquetColumns columns;
  std::vector<bool> flags;
  std::vector<std::vector<float>> lists;
  for (std::size_t i = 0; i < 3000; ++i) {
    flags.push_back(i % 3 == 0);
    lists.push_back(i < 1000 ? std::vector<float>{} : std::vector<float>(i % 200, 0.5F));
  }
  columns.push_back({"flag", flags});
  columns.push_back({"list", lists});
  for (int i = 0; i < 20; ++i)
    columns.push_back({"column " + std::to_string(i), std::vector<std::int64_t>(3000, -i)});
  ASSERT_TRUE(write_file(folder.path() / "long.parquet", format_parquet(std::array{columns})));
  const nlohmann::json read = read_parquet(folder.path() / "long.parquet");
  if (read.is_null()) GTEST_SKIP() << kNoParquetReader;
  ASSERT_EQ(read["rows"].size(), 3000U);
  for (std::size_t i = 0; i < 3000; ++i) {
    const nlohmann::json& row = read["rows"][i];
    ASSERT_EQ(row["flag"], i % 3 == 0) << i;
    ASSERT_EQ(row["list"].size(), lists[i].size()) << i;
    ASSERT_EQ(row["column 19"], "-19") << i;
  }
}

TEST(Parquet, OfNoRowsHasItsColumns) {
  const TemporaryFolder folder;
  const std::vector<ParquetColumns> table{{{"a", std::vector<double>{}}}};
  ASSERT_TRUE(write_file(folder.path() / "empty.parquet", format_parquet(table)));
  const nlohmann::json read = read_parquet(folder.path() / "empty.parquet");
  if (read.is_null()) GTEST_SKIP() << kNoParquetReader;
  EXPECT_EQ(read["rows"].size(), 0U);
  EXPECT_EQ(read["columns"], nlohmann::json({"a"}));
}

TEST(Parquet, RefusesColumnsThatDiffer) {
  const ParquetColumns first{{"a", std::vector<double>{1.0}}};
  const ParquetColumns other_name{{"b", std::vector<double>{1.0}}};
  const ParquetColumns other_type{{"a", std::vector<float>{1.0F}}};
  const ParquetColumns other_length{{"a", std::vector<double>{1.0}}, {"b", std::vector<double>{}}};
  EXPECT_THROW((void)format_parquet(std::array{first, other_name}), ContractError);
  EXPECT_THROW((void)format_parquet(std::array{first, other_type}), ContractError);
  EXPECT_THROW((void)format_parquet(std::array{other_length}), ContractError);
  EXPECT_THROW((void)format_parquet({}), ContractError);
}

}  // namespace
}  // namespace pcavr
