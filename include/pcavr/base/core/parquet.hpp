// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace pcavr {

/// A column of a table: a name, and a value for each row, all of one type. Texts are UTF-8. A list
/// may be empty; an optional number without a value is null in the file.
struct ParquetColumn {
  using Values =
      std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<float>,
                   std::vector<bool>, std::vector<std::string>, std::vector<std::optional<double>>,
                   std::vector<std::vector<float>>, std::vector<std::vector<double>>,
                   std::vector<std::vector<std::string>>>;

  std::string name;
  Values values;

  /// Number of rows.
  [[nodiscard]] std::size_t size() const;
};

using ParquetColumns = std::vector<ParquetColumn>;

/// The bytes of a Parquet file [Apache Parquet format 2.10]: plain encoding, not compressed, one
/// page for each column of a row group. `row_groups` have the same columns in name, type and order,
/// with at least one row group; a group's columns have equally many rows, and less than 2 GiB each.
/// `notes` are the file's key-value metadata, as pandas and others read them. Throws ContractError
/// where columns differ. Deterministic, thread-safe.
[[nodiscard]] std::string format_parquet(std::span<const ParquetColumns> row_groups,
                                         const std::map<std::string, std::string>& notes = {});

}  // namespace pcavr
