// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The names and numbers of the file's parts are those of parquet.thrift.
#include "pcavr/base/core/parquet.hpp"

#include <cstddef>
#include <limits>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "parquet_page.hpp"
#include "thrift_writer.hpp"

namespace pcavr {
namespace {

using namespace parquet;

constexpr char kMagic[] = "PAR1";
enum Repetition { kRequired = 0, kOptional = 1, kRepeated = 2 };
enum ConvertedType { kUtf8 = 0, kList = 3 };
enum LogicalType { kLogicalString = 1, kLogicalList = 3 };
enum Encoding { kPlain = 0, kRunLength = 3 };

std::string format_page_header(std::uint64_t leaves, std::size_t size) {
  std::string header;
  ThriftWriter writer(header);
  writer.begin_struct();
  writer.i32(1, 0);  // DATA_PAGE
  writer.i32(2, static_cast<std::int32_t>(size));
  writer.i32(3, static_cast<std::int32_t>(size));
  writer.begin_struct(5);
  writer.i32(1, static_cast<std::int32_t>(leaves));
  writer.i32(2, kPlain);
  writer.i32(3, kRunLength);  // of the definition levels
  writer.i32(4, kRunLength);  // of the repetition levels
  writer.end_struct();
  writer.end_struct();
  return header;
}

/// Where a column of a row group is in the file.
struct Chunk {
  std::string name;
  Shape shape;
  std::uint64_t leaves = 0;
  std::size_t begin = 0;  ///< [bytes] in the file
  std::size_t size = 0;   ///< [bytes] with its page's header
};
struct Group {
  std::vector<Chunk> chunks = {};
  std::size_t rows = 0;
};

Chunk append_chunk(const ParquetColumn& column, std::string& file) {
  Page page;
  std::visit([&](const auto& rows) { page.add_rows(rows); }, column.values);
  const Shape shape = shape_of(column);
  const std::string content = page.bytes(shape);
  PCAVR_REQUIRE(content.size() <= std::numeric_limits<std::int32_t>::max(), column.name);
  const std::size_t begin = file.size();
  file += format_page_header(page.leaves, content.size());
  file += content;
  return {column.name, shape, page.leaves, begin, file.size() - begin};
}

/// A leaf, or the group of a list with the two levels below it.
void write_schema_of(const Chunk& column, ThriftWriter& writer) {
  const Shape& shape = column.shape;
  const auto logical = [&](ConvertedType old, LogicalType type) {
    writer.i32(6, old);
    writer.begin_struct(10);
    writer.begin_struct(type);
    writer.end_struct();
    writer.end_struct();
  };
  const auto leaf = [&](const std::string& name) {
    writer.begin_struct();
    writer.i32(1, shape.type);
    writer.i32(3, shape.is_nullable ? kOptional : kRequired);
    writer.text(4, name);
    if (shape.is_text) logical(kUtf8, kLogicalString);
    writer.end_struct();
  };
  if (!shape.is_list) return leaf(column.name);
  writer.begin_struct();
  writer.i32(3, kRequired);
  writer.text(4, column.name);
  writer.i32(5, 1);
  logical(kList, kLogicalList);
  writer.end_struct();
  writer.begin_struct();
  writer.i32(3, kRepeated);
  writer.text(4, "list");
  writer.i32(5, 1);
  writer.end_struct();
  leaf("element");
}

void write_schema(const std::vector<Chunk>& columns, ThriftWriter& writer) {
  std::size_t elements = 1;
  for (const Chunk& column : columns) elements += column.shape.is_list ? 3 : 1;
  writer.begin_list(2, ThriftWriter::Type::structure, elements);
  writer.begin_struct();
  writer.text(4, "schema");
  writer.i32(5, static_cast<std::int32_t>(columns.size()));
  writer.end_struct();
  for (const Chunk& column : columns) write_schema_of(column, writer);
}

void write_chunk(const Chunk& chunk, ThriftWriter& writer) {
  writer.begin_struct();
  writer.i64(2, static_cast<std::int64_t>(chunk.begin));
  writer.begin_struct(3);
  writer.i32(1, chunk.shape.type);
  writer.begin_list(2, ThriftWriter::Type::i32, 2);
  writer.element(kPlain);
  writer.element(kRunLength);
  writer.begin_list(3, ThriftWriter::Type::text, chunk.shape.is_list ? 3 : 1);
  writer.element(std::string_view(chunk.name));
  if (chunk.shape.is_list) {
    writer.element(std::string_view("list"));
    writer.element(std::string_view("element"));
  }
  writer.i32(4, 0);  // UNCOMPRESSED
  writer.i64(5, static_cast<std::int64_t>(chunk.leaves));
  writer.i64(6, static_cast<std::int64_t>(chunk.size));
  writer.i64(7, static_cast<std::int64_t>(chunk.size));
  writer.i64(9, static_cast<std::int64_t>(chunk.begin));
  writer.end_struct();
  writer.end_struct();
}

void write_groups(const std::vector<Group>& groups, ThriftWriter& writer) {
  writer.begin_list(4, ThriftWriter::Type::structure, groups.size());
  for (const Group& group : groups) {
    std::size_t size = 0;
    for (const Chunk& chunk : group.chunks) size += chunk.size;
    writer.begin_struct();
    writer.begin_list(1, ThriftWriter::Type::structure, group.chunks.size());
    for (const Chunk& chunk : group.chunks) write_chunk(chunk, writer);
    writer.i64(2, static_cast<std::int64_t>(size));
    writer.i64(3, static_cast<std::int64_t>(group.rows));
    writer.end_struct();
  }
}

std::string format_footer(const std::vector<Group>& groups,
                          const std::map<std::string, std::string>& notes) {
  std::size_t rows = 0;
  for (const Group& group : groups) rows += group.rows;
  std::string footer;
  ThriftWriter writer(footer);
  writer.begin_struct();
  writer.i32(1, 1);  // the format's version
  write_schema(groups.front().chunks, writer);
  writer.i64(3, static_cast<std::int64_t>(rows));
  write_groups(groups, writer);
  if (!notes.empty()) writer.begin_list(5, ThriftWriter::Type::structure, notes.size());
  for (const auto& [key, value] : notes) {
    writer.begin_struct();
    writer.text(1, key);
    writer.text(2, value);
    writer.end_struct();
  }
  writer.text(6, "pcavr");
  writer.end_struct();
  return footer;
}

void require_same_columns(const ParquetColumns& columns, const ParquetColumns& first) {
  PCAVR_REQUIRE(columns.size() == first.size() && !columns.empty(), columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    PCAVR_REQUIRE(columns[i].name == first[i].name, columns[i].name, first[i].name);
    PCAVR_REQUIRE(columns[i].values.index() == first[i].values.index(), columns[i].name);
    PCAVR_REQUIRE(columns[i].size() == columns.front().size(), columns[i].name);
  }
}

}  // namespace

std::size_t ParquetColumn::size() const {
  return std::visit([](const auto& rows) { return rows.size(); }, values);
}

std::string format_parquet(std::span<const ParquetColumns> row_groups,
                           const std::map<std::string, std::string>& notes) {
  PCAVR_REQUIRE(!row_groups.empty());
  std::string file = kMagic;
  std::vector<Group> groups;
  for (const ParquetColumns& columns : row_groups) {
    require_same_columns(columns, row_groups.front());
    Group group{.rows = columns.front().size()};
    for (const ParquetColumn& column : columns) group.chunks.push_back(append_chunk(column, file));
    groups.push_back(std::move(group));
  }
  const std::string footer = format_footer(groups, notes);
  file += footer;
  append_bytes(file, static_cast<std::uint32_t>(footer.size()));
  return file + kMagic;
}

}  // namespace pcavr
