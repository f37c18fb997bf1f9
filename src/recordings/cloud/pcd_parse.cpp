// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/cloud/parse_formats.hpp"
#include "recordings/cloud/scalar_column.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxFields = 1000;
constexpr std::size_t kMaxFieldCount = 100'000;

struct PcdField {
  ScalarColumn column;    ///< name and type
  std::size_t count = 1;  ///< numbers in each point

  [[nodiscard]] std::size_t size() const { return count * size_of(column.type); }
};

enum class PcdData { ascii, binary, binary_compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t points = 0;
  Pose T_cloud_sensor;
  PcdData data = PcdData::ascii;
  int lines = 0;
  std::size_t bytes = 0;

  [[nodiscard]] std::size_t point_size() const {
    std::size_t size = 0;
    for (const PcdField& field : fields) size += field.size();
    return size;
  }
};

/// One line of the header.
struct HeaderLine {
  std::vector<std::string> values;
  int line = 0;
};

using HeaderLines = std::map<std::string, HeaderLine>;

std::optional<ScalarType> type_of(const std::string& type, const std::string& size) {
  const std::string text = type + size;
  for (const auto& [name, value] :
       {std::pair{"F4", ScalarType::f32}, std::pair{"F8", ScalarType::f64},
        std::pair{"I1", ScalarType::i8}, std::pair{"U1", ScalarType::u8},
        std::pair{"I2", ScalarType::i16}, std::pair{"U2", ScalarType::u16},
        std::pair{"I4", ScalarType::i32}, std::pair{"U4", ScalarType::u32},
        std::pair{"I8", ScalarType::i64}, std::pair{"U8", ScalarType::u64}}) {
    if (text == name) return value;
  }
  return std::nullopt;
}

/// Reads the header of a PCD file from its lines.
class PcdHeaderReader {
 public:
  PcdHeaderReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Expected<PcdHeader> read() {
    if (auto collected = collect(); !collected) return collected.error();
    if (auto done = read_fields(); !done) return done.error();
    if (auto done = read_counts(); !done) return done.error();
    if (auto done = read_viewpoint(); !done) return done.error();
    if (auto done = read_data(); !done) return done.error();
    return std::move(header_);
  }

 private:
  [[nodiscard]] Error error(const std::string& key, std::string message, std::string hint) const {
    const auto line = lines_.find(key);
    return cloud_error(file_, line == lines_.end() ? header_.lines : line->second.line,
                       key + ": " + std::move(message), std::move(hint));
  }

  /// The header's lines by their key, up to DATA.
  Expected<void> collect() {
    LineReader reader(bytes_);
    while (const std::optional<std::string_view> line = reader.next()) {
      std::vector<std::string> fields = split_fields(*line);
      if (fields.empty() || fields.front().starts_with('#')) continue;
      std::string key = fields.front() == "COLUMNS" ? "FIELDS" : fields.front();
      fields.erase(fields.begin());
      if (fields.size() > kMaxFields) {
        return cloud_error(file_, reader.line(), "has more than 1000 fields", "write fewer fields");
      }
      lines_[key] = {std::move(fields), reader.line()};
      header_.lines = reader.line();
      if (key != "DATA") continue;
      header_.bytes = static_cast<std::size_t>(line->data() + line->size() - bytes_.data());
      // Past the line's end, which is LF or CR LF.
      if (bytes_.substr(header_.bytes).starts_with('\r')) ++header_.bytes;
      if (bytes_.substr(header_.bytes).starts_with('\n')) ++header_.bytes;
      return {};
    }
    return cloud_error(file_, header_.lines, "is truncated: the header has no line DATA",
                       "copy or record the file again");
  }

  [[nodiscard]] const std::vector<std::string>* values(const std::string& key) const {
    const auto found = lines_.find(key);
    return found == lines_.end() ? nullptr : &found->second.values;
  }

  Expected<void> read_fields() {
    const std::vector<std::string>* names = values("FIELDS");
    const std::vector<std::string>* sizes = values("SIZE");
    const std::vector<std::string>* types = values("TYPE");
    const std::vector<std::string>* counts = values("COUNT");
    if (names == nullptr || sizes == nullptr || types == nullptr || names->empty()) {
      return cloud_error(file_, header_.lines, "FIELDS, SIZE or TYPE is missing from the header",
                         "write a PCD file of version 0.7");
    }
    if (sizes->size() != names->size() || types->size() != names->size() ||
        (counts != nullptr && counts->size() != names->size())) {
      return error("FIELDS",
                   "has " + std::to_string(names->size()) +
                       " names, but SIZE, TYPE or COUNT another number of values",
                   "write one value for each field");
    }
    for (std::size_t i = 0; i < names->size(); ++i) {
      const std::optional<ScalarType> type = type_of((*types)[i], (*sizes)[i]);
      if (!type) {
        return error("TYPE", "'" + (*types)[i] + "' of size " + (*sizes)[i] + " is not a type",
                     "types are I and U of 1, 2, 4 or 8 bytes, F of 4 or 8");
      }
      const std::optional<std::size_t> count =
          counts == nullptr ? std::optional<std::size_t>(1) : parse_count((*counts)[i]);
      if (!count || *count == 0 || *count > kMaxFieldCount) {
        return error("COUNT", "'" + (*counts)[i] + "' is not a number of values",
                     "write a whole number from 1");
      }
      header_.fields.push_back({.column = {.name = (*names)[i], .type = *type}, .count = *count});
    }
    return {};
  }

  [[nodiscard]] Expected<std::size_t> count_of(const std::string& key) const {
    const std::vector<std::string>* found = values(key);
    if (found == nullptr) {
      return cloud_error(file_, header_.lines, key + " is missing from the header",
                         "write a PCD file of version 0.7");
    }
    const std::optional<std::size_t> count =
        found->size() == 1 ? parse_count(found->front()) : std::nullopt;
    if (!count || *count > kMaxCloudPoints) {
      return error(key,
                   (found->empty() ? "no number" : "'" + found->front() + "'") +
                       " is not a number from 0 to " + std::to_string(kMaxCloudPoints),
                   "write one cloud for each frame");
    }
    return *count;
  }

  Expected<void> read_counts() {
    const Expected<std::size_t> width = count_of("WIDTH");
    if (!width) return width.error();
    const Expected<std::size_t> height = count_of("HEIGHT");
    if (!height) return height.error();
    header_.points = *width * *height;
    if (values("POINTS") != nullptr) {
      const Expected<std::size_t> points = count_of("POINTS");
      if (!points) return points.error();
      if (*points != header_.points) {
        return error("POINTS",
                     std::to_string(*points) + " disagrees with the organised size " +
                         std::to_string(*width) + " x " + std::to_string(*height),
                     "POINTS must be WIDTH times HEIGHT");
      }
    }
    if (header_.points > kMaxCloudPoints) {
      return error("HEIGHT",
                   std::to_string(*width) + " x " + std::to_string(*height) +
                       " points are more than " + std::to_string(kMaxCloudPoints),
                   "write one cloud for each frame");
    }
    header_.width = *width;
    header_.height = *height;
    return {};
  }

  Expected<void> read_viewpoint() {
    const std::vector<std::string>* found = values("VIEWPOINT");
    if (found == nullptr) return {};
    std::vector<double> numbers;
    for (const std::string& text : *found) {
      const std::optional<double> number = parse_number(text);
      if (number) numbers.push_back(*number);
    }
    const std::optional<Pose> pose =
        numbers.size() == 7 && found->size() == 7
            ? header_pose({numbers[0], numbers[1], numbers[2]},
                          {numbers[3], numbers[4], numbers[5], numbers[6]})
            : std::nullopt;
    if (!pose) {
      return error("VIEWPOINT", "is not a position and a unit quaternion",
                   "write tx ty tz qw qx qy qz");
    }
    header_.T_cloud_sensor = *pose;
    return {};
  }

  Expected<void> read_data() {
    const std::vector<std::string>& found = *values("DATA");
    const std::string kind = found.size() == 1 ? found.front() : "";
    if (kind == "ascii") {
      header_.data = PcdData::ascii;
    } else if (kind == "binary") {
      header_.data = PcdData::binary;
    } else if (kind == "binary_compressed") {
      header_.data = PcdData::binary_compressed;
    } else {
      return error("DATA", "'" + kind + "' is not a kind of data",
                   "kinds are ascii, binary and binary_compressed");
    }
    return {};
  }

  std::string_view bytes_;
  const std::string& file_;
  HeaderLines lines_;
  PcdHeader header_;
};

/// Columns for the fields of one number, where a point's field follows the previous field
/// (`is_by_field` false), or a field's values for all points do.
std::vector<ScalarColumn> columns_in(const PcdHeader& header, const char* data, bool is_by_field) {
  std::vector<ScalarColumn> columns;
  std::size_t offset = 0;
  for (const PcdField& field : header.fields) {
    ScalarColumn column = field.column;
    column.first = data + offset;
    column.stride = is_by_field ? field.size() : header.point_size();
    if (field.count == 1) columns.push_back(std::move(column));
    offset += is_by_field ? field.size() * header.points : field.size();
  }
  return columns;
}

Expected<RecordedCloud> read_text(const PcdHeader& header, std::string_view data,
                                  const std::string& file) {
  std::vector<ScalarColumn> columns;
  for (const PcdField& field : header.fields) {
    for (std::size_t i = 0; i < field.count; ++i) {
      columns.push_back(field.column);
      // Values of histograms and the like are read, but not found by their name.
      if (field.count > 1) columns.back().name.clear();
    }
    if (columns.size() > data.size() + 1) break;
  }
  if (header.points > 0 && columns.size() > (data.size() + 1) / header.points) {
    return truncated_error(file, header.points, header.points * columns.size(), data.size());
  }
  TextTable table(std::move(columns));
  LineReader lines(data);
  while (table.rows() < header.points) {
    const std::optional<std::string_view> line = lines.next();
    if (!line) {
      return cloud_error(file, header.lines + lines.line(),
                         "is truncated: it has " + std::to_string(table.rows()) + " of " +
                             std::to_string(header.points) + " points",
                         "copy or record the file again");
    }
    if (trimmed(*line).empty() || line->starts_with('#')) continue;
    if (!table.add_row(*line)) {
      return cloud_error(file, header.lines + lines.line(),
                         "the row has not one number for each field",
                         "write one point in each line; the file may be truncated");
    }
  }
  return cloud_of_columns(table.columns(), header.points);
}

Expected<RecordedCloud> read_compressed(const PcdHeader& header, std::string_view data,
                                        const std::string& file) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  const std::size_t needed = header.points * header.point_size();
  if (data.size() < kSizes) return truncated_error(file, header.points, kSizes, data.size());
  const std::size_t compressed = load_value<std::uint32_t>(data.data(), 0);
  const std::size_t size = load_value<std::uint32_t>(data.data(), sizeof(std::uint32_t));
  data.remove_prefix(kSizes);
  if (size != needed) {
    return cloud_error(file, 0,
                       "its compressed data has " + std::to_string(size) + " bytes; " +
                           std::to_string(header.points) + " points need " + std::to_string(needed),
                       "write the file again");
  }
  if (compressed > data.size()) {
    return truncated_error(file, header.points, compressed, data.size());
  }
  const std::optional<std::string> plain = decompress_lzf(data.substr(0, compressed), size);
  if (!plain) {
    return cloud_error(file, 0, "its compressed data is corrupt", "copy or record the file again");
  }
  return cloud_of_columns(columns_in(header, plain->data(), true), header.points);
}

Expected<RecordedCloud> read_content(const PcdHeader& header, std::string_view data,
                                     const std::string& file) {
  if (header.data == PcdData::ascii) return read_text(header, data, file);
  if (header.data == PcdData::binary_compressed) return read_compressed(header, data, file);
  const std::size_t needed = header.points * header.point_size();
  if (needed > data.size()) return truncated_error(file, header.points, needed, data.size());
  return cloud_of_columns(columns_in(header, data.data(), false), header.points);
}

}  // namespace

Expected<RecordedCloud> parse_pcd(std::string_view bytes, const std::string& file) {
  const Expected<PcdHeader> header = PcdHeaderReader(bytes, file).read();
  if (!header) return header.error();
  Expected<RecordedCloud> cloud = read_content(*header, bytes.substr(header->bytes), file);
  if (!cloud) {
    Error error = cloud.error();
    error.file = file;
    return error;
  }
  if (header->height > 1) {
    cloud->width = static_cast<int>(header->width);
    cloud->height = static_cast<int>(header->height);
  }
  cloud->T_cloud_sensor = header->T_cloud_sensor;
  return cloud;
}

}  // namespace pcavr
