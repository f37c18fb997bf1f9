// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/cloud/scalar_column.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

template <typename Value>
Value load_scalar(const ScalarColumn& column, std::size_t row) {
  std::array<char, sizeof(Value)> bytes;
  std::memcpy(bytes.data(), column.first + row * column.stride, sizeof(Value));
  if (column.is_big_endian) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Value>(bytes);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Three columns as vectors; the file's numbers.
class VectorColumns {
 public:
  VectorColumns(const ScalarColumn& x, const ScalarColumn& y, const ScalarColumn& z)
      : columns_{&x, &y, &z} {
    const auto follows = [](const ScalarColumn& a, const ScalarColumn& b) {
      return b.type == ScalarType::f32 && !b.is_big_endian && b.first == a.first + sizeof(float);
    };
    is_packed_ = x.type == ScalarType::f32 && !x.is_big_endian && follows(x, y) && follows(y, z);
  }

  [[nodiscard]] Eigen::Vector3f operator()(std::size_t row) const {
    if (is_packed_) {
      Eigen::Vector3f vector;
      std::memcpy(vector.data(), columns_[0]->first + row * columns_[0]->stride, 3 * sizeof(float));
      return vector;
    }
    return {component(0, row), component(1, row), component(2, row)};
  }

 private:
  /// Numbers that a float does not hold become NaN.
  [[nodiscard]] float component(std::size_t axis, std::size_t row) const {
    const double value = columns_[axis]->value(row);
    return std::abs(value) < 1e30 ? static_cast<float>(value) : kNan;
  }

  std::array<const ScalarColumn*, 3> columns_;
  bool is_packed_ = false;
};

std::vector<Eigen::Vector3f> points_of(const VectorColumns& columns, std::size_t count) {
  std::vector<Eigen::Vector3f> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f p = columns(i);
    // The sum is finite only where each of them is; coordinates are far below the overflow.
    const bool is_measured = std::abs(p.x()) + std::abs(p.y()) + std::abs(p.z()) < 1e30F &&
                             (p.x() != 0.0F || p.y() != 0.0F || p.z() != 0.0F);
    points[i] = is_measured ? p : Eigen::Vector3f(kNan, kNan, kNan);
  }
  return points;
}

std::uint8_t to_channel(double value) {
  // Written so that NaN becomes 0.
  return value > 0.0 ? static_cast<std::uint8_t>(std::min(value + 0.5, 255.0)) : std::uint8_t{0};
}

/// 255 over the channel's largest value: 1 for floating point, else by the number of bits.
double channel_scale(ScalarType type) {
  if (type == ScalarType::f32) return 255.0;
  return type == ScalarType::u16 || type == ScalarType::i16 ? 1.0 / 257.0 : 1.0;
}

std::vector<Rgb8> packed_colors(const ScalarColumn& column, std::size_t count) {
  std::vector<Rgb8> colors(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t bits = column.packed_bits(i);
    colors[i] = {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
                 static_cast<std::uint8_t>(bits)};
  }
  return colors;
}

std::vector<Rgb8> channel_colors(const std::array<const ScalarColumn*, 3>& channels,
                                 std::size_t count) {
  std::vector<Rgb8> colors(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::uint8_t, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
      rgb[c] = to_channel(channels[c]->value(i) * channel_scale(channels[c]->type));
    }
    colors[i] = {rgb[0], rgb[1], rgb[2]};
  }
  return colors;
}

std::vector<Rgb8> grey_of(const ScalarColumn& intensity, std::size_t count) {
  double max = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = intensity.value(i);
    if (value > max && std::isfinite(value)) max = value;
  }
  const double scale = max <= 1.0 ? 255.0 : max <= 255.0 ? 1.0 : 255.0 / std::max(max, 65535.0);
  std::vector<Rgb8> colors(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t grey = to_channel(intensity.value(i) * scale);
    colors[i] = {grey, grey, grey};
  }
  return colors;
}

std::vector<Rgb8> colors_of(std::span<const ScalarColumn> columns, std::size_t count) {
  for (const char* name : {"rgb", "rgba"}) {
    const ScalarColumn* packed = find_column(columns, name);
    if (packed != nullptr && size_of(packed->type) == 4) return packed_colors(*packed, count);
  }
  for (const std::array<const char*, 3>& names :
       {std::array{"red", "green", "blue"}, std::array{"r", "g", "b"},
        std::array{"diffuse_red", "diffuse_green", "diffuse_blue"}}) {
    const std::array channels{find_column(columns, names[0]), find_column(columns, names[1]),
                              find_column(columns, names[2])};
    if (channels[0] != nullptr && channels[1] != nullptr && channels[2] != nullptr) {
      return channel_colors(channels, count);
    }
  }
  for (const char* name : {"intensity", "Intensity", "scalar_Intensity", "i"}) {
    if (const ScalarColumn* column = find_column(columns, name)) return grey_of(*column, count);
  }
  return {};
}

std::vector<Eigen::Vector3f> normals_of(std::span<const ScalarColumn> columns, std::size_t count) {
  for (const std::array<const char*, 3>& names :
       {std::array{"normal_x", "normal_y", "normal_z"}, std::array{"nx", "ny", "nz"}}) {
    const ScalarColumn* x = find_column(columns, names[0]);
    const ScalarColumn* y = find_column(columns, names[1]);
    const ScalarColumn* z = find_column(columns, names[2]);
    if (x == nullptr || y == nullptr || z == nullptr) continue;
    const VectorColumns vectors(*x, *y, *z);
    std::vector<Eigen::Vector3f> normals(count);
    for (std::size_t i = 0; i < count; ++i) normals[i] = vectors(i);
    return normals;
  }
  return {};
}

}  // namespace

std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::i8:
    case ScalarType::u8:
      return 1;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    case ScalarType::i32:
    case ScalarType::u32:
    case ScalarType::f32:
      return 4;
    default:
      return 8;
  }
}

double ScalarColumn::value(std::size_t row) const {
  switch (type) {
    case ScalarType::i8:
      return load_scalar<std::int8_t>(*this, row);
    case ScalarType::u8:
      return load_scalar<std::uint8_t>(*this, row);
    case ScalarType::i16:
      return load_scalar<std::int16_t>(*this, row);
    case ScalarType::u16:
      return load_scalar<std::uint16_t>(*this, row);
    case ScalarType::i32:
      return load_scalar<std::int32_t>(*this, row);
    case ScalarType::u32:
      return load_scalar<std::uint32_t>(*this, row);
    case ScalarType::i64:
      return static_cast<double>(load_scalar<std::int64_t>(*this, row));
    case ScalarType::u64:
      return static_cast<double>(load_scalar<std::uint64_t>(*this, row));
    case ScalarType::f32:
      return static_cast<double>(load_scalar<float>(*this, row));
    case ScalarType::f64:
      return load_scalar<double>(*this, row);
  }
  return 0.0;
}

std::uint32_t ScalarColumn::packed_bits(std::size_t row) const {
  return load_scalar<std::uint32_t>(*this, row);
}

const ScalarColumn* find_column(std::span<const ScalarColumn> columns, std::string_view name) {
  for (const ScalarColumn& column : columns) {
    if (column.name == name) return &column;
  }
  return nullptr;
}

Expected<RecordedCloud> cloud_of_columns(std::span<const ScalarColumn> columns, std::size_t count) {
  // Without points there are no columns of text.
  if (count == 0) return RecordedCloud{};
  const ScalarColumn* x = find_column(columns, "x");
  const ScalarColumn* y = find_column(columns, "y");
  const ScalarColumn* z = find_column(columns, "z");
  if (x == nullptr || y == nullptr || z == nullptr) {
    return Error{.message = "has no coordinates: a field x, y or z is missing",
                 .hint = "write the points with the fields x y z"};
  }
  PCAVR_REQUIRE(count <= static_cast<std::size_t>(std::numeric_limits<int>::max()), count);
  return RecordedCloud{.width = static_cast<int>(count),
                       .height = 1,
                       .points = points_of(VectorColumns(*x, *y, *z), count),
                       .normals = normals_of(columns, count),
                       .colors = colors_of(columns, count),
                       .T_cloud_sensor = {}};
}

}  // namespace pcavr
