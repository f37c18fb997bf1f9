// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/cloud/parse_formats.hpp"
#include "recordings/cloud/scalar_column.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxElements = 64;
constexpr std::size_t kMaxProperties = 1000;

enum class PlyData { ascii, little_endian, big_endian };

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<ScalarColumn> properties;  ///< names and types
  bool has_list = false;

  [[nodiscard]] std::size_t row_size() const {
    std::size_t size = 0;
    for (const ScalarColumn& property : properties) size += size_of(property.type);
    return size;
  }
};

struct PlyHeader {
  PlyData data = PlyData::ascii;
  std::vector<PlyElement> elements;
  std::size_t columns = 0;  ///< of a range grid, by obj_info; 0 where it states none
  std::size_t rows = 0;
  int lines = 0;
  std::size_t bytes = 0;
};

std::optional<ScalarType> ply_type(const std::string& text) {
  for (const auto& [name, type] :
       {std::pair{"char", ScalarType::i8}, std::pair{"int8", ScalarType::i8},
        std::pair{"uchar", ScalarType::u8}, std::pair{"uint8", ScalarType::u8},
        std::pair{"short", ScalarType::i16}, std::pair{"int16", ScalarType::i16},
        std::pair{"ushort", ScalarType::u16}, std::pair{"uint16", ScalarType::u16},
        std::pair{"int", ScalarType::i32}, std::pair{"int32", ScalarType::i32},
        std::pair{"uint", ScalarType::u32}, std::pair{"uint32", ScalarType::u32},
        std::pair{"float", ScalarType::f32}, std::pair{"float32", ScalarType::f32},
        std::pair{"double", ScalarType::f64}, std::pair{"float64", ScalarType::f64}}) {
    if (text == name) return type;
  }
  return std::nullopt;
}

/// Reads the header of a PLY file from its lines.
class PlyHeaderReader {
 public:
  PlyHeaderReader(std::string_view bytes, const std::string& file)
      : bytes_(bytes), file_(file), reader_(bytes) {}

  Expected<PlyHeader> read() {
    bool has_format = false;
    while (const std::optional<std::string_view> line = reader_.next()) {
      header_.lines = reader_.line();
      const std::vector<std::string> fields = split_fields(*line);
      if (fields.empty() || fields.front() == "comment" || fields.front() == "ply") continue;
      if (fields.front() == "end_header") {
        if (!has_format) return fault("'format' is missing from the header", kFormatHint);
        header_.bytes = static_cast<std::size_t>(line->data() + line->size() - bytes_.data());
        if (bytes_.substr(header_.bytes).starts_with('\r')) ++header_.bytes;
        if (bytes_.substr(header_.bytes).starts_with('\n')) ++header_.bytes;
        return std::move(header_);
      }
      if (auto done = read_line(fields); !done) return done.error();
      has_format = has_format || fields.front() == "format";
    }
    return fault("is truncated: the header has no line end_header", "copy the file again");
  }

 private:
  static constexpr char kFormatHint[] =
      "formats are ascii, binary_little_endian and binary_big_endian, version 1.0";

  [[nodiscard]] Error fault(std::string message, std::string hint) const {
    return cloud_error(file_, header_.lines, std::move(message), std::move(hint));
  }

  Expected<void> read_line(const std::vector<std::string>& fields) {
    if (fields.front() == "format") return read_format(fields);
    if (fields.front() == "element") return read_element(fields);
    if (fields.front() == "property") return read_property(fields);
    if (fields.front() == "obj_info") {
      if (fields.size() == 3 && fields[1] == "num_cols") {
        header_.columns = parse_count(fields[2]).value_or(0);
      }
      if (fields.size() == 3 && fields[1] == "num_rows") {
        header_.rows = parse_count(fields[2]).value_or(0);
      }
      return {};
    }
    return fault("'" + fields.front() + "' is not a keyword of a PLY header",
                 "the header may be truncated: it ends with end_header");
  }

  Expected<void> read_format(const std::vector<std::string>& fields) {
    const std::string kind = fields.size() == 3 && fields[2] == "1.0" ? fields[1] : "";
    if (kind == "ascii") {
      header_.data = PlyData::ascii;
    } else if (kind == "binary_little_endian") {
      header_.data = PlyData::little_endian;
    } else if (kind == "binary_big_endian") {
      header_.data = PlyData::big_endian;
    } else {
      return fault("the format is not known", kFormatHint);
    }
    return {};
  }

  Expected<void> read_element(const std::vector<std::string>& fields) {
    const std::optional<std::size_t> count =
        fields.size() == 3 ? parse_count(fields[2]) : std::nullopt;
    if (!count || header_.elements.size() == kMaxElements) {
      return fault("the element has no name and number", "write 'element vertex N'");
    }
    if (fields[1] == "vertex" && *count > kMaxCloudPoints) {
      return fault(fields[2] + " points are more than " + std::to_string(kMaxCloudPoints),
                   "write one cloud for each frame");
    }
    header_.elements.push_back({.name = fields[1], .count = *count, .properties = {}});
    return {};
  }

  Expected<void> read_property(const std::vector<std::string>& fields) {
    if (header_.elements.empty() || header_.elements.back().properties.size() == kMaxProperties) {
      return fault("the property belongs to no element", "write 'element' before 'property'");
    }
    PlyElement& element = header_.elements.back();
    if (fields.size() == 5 && fields[1] == "list") {
      element.has_list = true;
      return {};
    }
    const std::optional<ScalarType> type = fields.size() == 3 ? ply_type(fields[1]) : std::nullopt;
    if (!type) {
      return fault("the property has no known type and name", "write 'property float x'");
    }
    element.properties.push_back({.name = fields[2], .type = *type});
    return {};
  }

  std::string_view bytes_;
  const std::string& file_;
  LineReader reader_;
  PlyHeader header_;
};

/// Takes the rows of one element after the other from the data.
class PlyDataReader {
 public:
  PlyDataReader(const PlyHeader& header, std::string_view data, const std::string& file)
      : header_(header), rest_(data), file_(file), line_(header.lines) {}

  /// The columns stay valid until the next call.
  Expected<std::span<const ScalarColumn>> take(const PlyElement& element) {
    if (element.has_list) {
      return cloud_error(file_, header_.lines,
                         "the element '" + element.name + "' before or with the points has a list",
                         "write the element vertex first, with numbers only");
    }
    return header_.data == PlyData::ascii ? take_text(element) : take_binary(element);
  }

 private:
  Expected<std::span<const ScalarColumn>> take_binary(const PlyElement& element) {
    const std::size_t row = element.row_size();
    if (row > 0 && element.count > rest_.size() / row) {
      // Divided first: the product may be out of range.
      return element.count > kMaxCloudPoints
                 ? cloud_error(file_, header_.lines, "the file is too short for its elements",
                               "copy or record the file again")
                 : truncated_error(file_, element.count, element.count * row, rest_.size());
    }
    columns_ = element.properties;
    std::size_t offset = 0;
    for (ScalarColumn& column : columns_) {
      column.first = rest_.data() + offset;
      column.stride = row;
      column.is_big_endian = header_.data == PlyData::big_endian;
      offset += size_of(column.type);
    }
    rest_.remove_prefix(element.count * row);
    return std::span<const ScalarColumn>(columns_);
  }

  Expected<std::span<const ScalarColumn>> take_text(const PlyElement& element) {
    // A row has at least a digit and a separator for each number, but for the file's last one.
    if (element.count >
        (rest_.size() + 1) / (2 * std::max<std::size_t>(1, element.properties.size()))) {
      return cloud_error(file_, header_.lines,
                         "is truncated: '" + element.name + "' has " +
                             std::to_string(element.count) + " rows, and " +
                             std::to_string(rest_.size()) + " bytes follow the header",
                         "copy or record the file again");
    }
    table_.emplace(element.properties);
    LineReader lines(rest_);
    while (table_->rows() < element.count && !element.properties.empty()) {
      const std::optional<std::string_view> line = lines.next();
      if (!line || !table_->add_row(*line)) {
        return cloud_error(file_, line_ + lines.line(),
                           line ? "the row has not one number for each property"
                                : "is truncated: it has " + std::to_string(table_->rows()) +
                                      " of " + std::to_string(element.count) + " points",
                           "copy or record the file again");
      }
      const auto end = static_cast<std::size_t>(line->data() + line->size() - rest_.data());
      used_ = std::min(rest_.size(), rest_.find('\n', end) == std::string_view::npos
                                         ? rest_.size()
                                         : rest_.find('\n', end) + 1);
    }
    line_ += lines.line();
    rest_.remove_prefix(std::exchange(used_, 0));
    return table_->columns();
  }

  const PlyHeader& header_;
  std::string_view rest_;
  const std::string& file_;
  int line_;
  std::size_t used_ = 0;
  std::vector<ScalarColumn> columns_;
  std::optional<TextTable> table_;
};

/// Image size and pose of the sensor from the element that PCL writes behind the points.
void read_camera(std::span<const ScalarColumn> columns, RecordedCloud& cloud) {
  const auto number = [&](const char* name) {
    const ScalarColumn* column = find_column(columns, name);
    return column == nullptr ? 0.0 : column->value(0);
  };
  const double width = number("viewportx");
  const double height = number("viewporty");
  if (height > 1.0 && width >= 1.0 && width * height == static_cast<double>(cloud.points.size())) {
    cloud.width = static_cast<int>(width);
    cloud.height = static_cast<int>(height);
  }
  Eigen::Matrix3d R;
  R << number("x_axisx"), number("y_axisx"), number("z_axisx"), number("x_axisy"),
      number("y_axisy"), number("z_axisy"), number("x_axisz"), number("y_axisz"), number("z_axisz");
  const bool is_rotation = R.allFinite() && std::abs(R.determinant() - 1.0) < 0.01 &&
                           (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.01;
  if (!is_rotation) return;
  const std::optional<Pose> pose =
      header_pose({number("view_px"), number("view_py"), number("view_pz")}, Eigen::Quaterniond(R));
  if (pose) cloud.T_cloud_sensor = *pose;
}

/// The size that obj_info states; an Error where it disagrees with the number of points.
Expected<void> read_grid_size(const PlyHeader& header, const std::string& file,
                              RecordedCloud& cloud) {
  if (header.columns == 0 || header.rows <= 1) return {};
  // A file with the element range_grid has the measured points only, in no grid.
  for (const PlyElement& element : header.elements) {
    if (element.name == "range_grid") return {};
  }
  if (header.columns > cloud.points.size() || header.rows != cloud.points.size() / header.columns ||
      cloud.points.size() % header.columns != 0) {
    return cloud_error(file, header.lines,
                       "the organised size " + std::to_string(header.columns) + " x " +
                           std::to_string(header.rows) + " disagrees with its " +
                           std::to_string(cloud.points.size()) + " points",
                       "num_cols times num_rows must be the number of points");
  }
  cloud.width = static_cast<int>(header.columns);
  cloud.height = static_cast<int>(header.rows);
  return {};
}

}  // namespace

Expected<RecordedCloud> parse_ply(std::string_view bytes, const std::string& file) {
  const Expected<PlyHeader> header = PlyHeaderReader(bytes, file).read();
  if (!header) return header.error();
  PlyDataReader data(*header, bytes.substr(header->bytes), file);
  std::optional<RecordedCloud> cloud;
  for (const PlyElement& element : header->elements) {
    // Faces and the like, of which lists have no fixed size, follow the points.
    if (cloud && element.has_list) break;
    const Expected<std::span<const ScalarColumn>> columns = data.take(element);
    if (!columns) return columns.error();
    if (element.name == "vertex" && !cloud) {
      Expected<RecordedCloud> points = cloud_of_columns(*columns, element.count);
      if (!points) {
        Error error = points.error();
        error.file = file;
        return error;
      }
      cloud = *std::move(points);
    } else if (element.name == "camera" && cloud && element.count == 1) {
      read_camera(*columns, *cloud);
    }
  }
  if (!cloud) {
    return cloud_error(file, header->lines, "has no element vertex", "write the points as vertex");
  }
  if (auto done = read_grid_size(*header, file, *cloud); !done) return done.error();
  return *std::move(cloud);
}

}  // namespace pcavr
