// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The friction atlas as CSV and as Parquet, which another implementation reads.
#include "pipeline/jobs/friction_atlas.hpp"

#include <sstream>

#include <gtest/gtest.h>

#include "support/parquet_reader.hpp"

namespace pcavr {
namespace {

TEST(FrictionAtlas, IsTheSameAsCsvAndAsParquet) {
  ObjectParameters parameters;
  parameters.sliding_friction_coefficient = {0.25, 0.0125};
  parameters.viscous_friction = {3.0, std::nullopt};
  parameters.sources.given = {"viscous_friction"};
  parameters.limit_surface = ellipsoid_surface(4.0, 0.2);
  const TemporaryFolder folder;
  const std::vector<AtlasRow> rows = atlas_rows_of("a, box", "board", 3, parameters, {});
  ASSERT_TRUE(write_atlas(rows, folder.path()));
  std::istringstream csv(read_file(folder.path() / "friction_atlas.csv").value());
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "object,support,recordings,key,value,std,unit,origin");
  const nlohmann::json table = read_parquet(folder.path() / "friction_atlas.parquet");
  if (table.is_null()) GTEST_SKIP() << kNoParquetReader;
  std::size_t count = 0;
  for (const nlohmann::json& row : table["rows"]) {
    ASSERT_TRUE(std::getline(csv, line));
    const auto number = [&](const char* column) {
      std::ostringstream text;  // of these few digits
      if (!row[column].is_null()) text << row[column].get<double>();
      return text.str();
    };
    EXPECT_EQ(line, "\"" + row["object"].get<std::string>() + "\"," +
                        row["support"].get<std::string>() + ',' +
                        row["recordings"].get<std::string>() + ',' + row["key"].get<std::string>() +
                        ',' + number("value") + ',' + number("std") + ',' +
                        row["unit"].get<std::string>() + ',' + row["origin"].get<std::string>());
    ++count;
  }
  EXPECT_EQ(count, 4U + 2U + 15U);
  EXPECT_FALSE(std::getline(csv, line));
  const nlohmann::json& mu = table["rows"][0];
  EXPECT_EQ(mu["key"], "sliding_friction_coefficient");
  EXPECT_EQ(mu["std"], 0.0125);
  EXPECT_EQ(mu["origin"], "identified");
  EXPECT_EQ(table["rows"][1]["origin"], "not identified");
  EXPECT_TRUE(table["rows"][1]["value"].is_null());
  EXPECT_EQ(table["rows"][2]["origin"], "given");
}

}  // namespace
}  // namespace pcavr
