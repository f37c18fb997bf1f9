// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"

/// Serialises ROS messages field by field: as ROS 1 does, or as CDR in either byte order.
class RosEncoder {
 public:
  enum class Format { ros1, cdr, cdr_big_endian };

  explicit RosEncoder(Format format) : format_(format) {
    if (format == Format::cdr) bytes_ = std::string("\0\1\0\0", 4);
    if (format == Format::cdr_big_endian) bytes_ = std::string("\0\0\0\0", 4);
  }

  template <typename Number>
  RosEncoder& number(Number value) {
    if (is_cdr()) {
      while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_ += '\0';
    }
    auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if (format_ == Format::cdr_big_endian) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.begin(), raw.end());
    return *this;
  }
  RosEncoder& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size() + (is_cdr() ? 1 : 0)));
    bytes_ += text;
    if (is_cdr()) bytes_ += '\0';
    return *this;
  }
  RosEncoder& byte_sequence(std::string_view bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  RosEncoder& doubles(const std::vector<double>& values) {
    number(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) number(value);
    return *this;
  }
  RosEncoder& header(pcavr::Stamp stamp, std::string_view frame) {
    if (!is_cdr()) number(std::uint32_t{7});
    number(static_cast<std::uint32_t>(stamp.nanoseconds / 1'000'000'000));
    number(static_cast<std::uint32_t>(stamp.nanoseconds % 1'000'000'000));
    return text(frame);
  }
  RosEncoder& vector(const Eigen::Vector3d& v) { return number(v.x()).number(v.y()).number(v.z()); }
  RosEncoder& pose(const pcavr::Pose& pose) {
    const Eigen::Quaterniond& q = pose.rotation();
    return vector(pose.translation()).vector(q.vec()).number(q.w());
  }
  RosEncoder& image(pcavr::Stamp stamp, std::string_view frame, std::uint32_t width,
                    std::uint32_t height, std::string_view encoding, std::string_view pixels) {
    header(stamp, frame).number(height).number(width).text(encoding).number(std::uint8_t{0});
    return number(static_cast<std::uint32_t>(pixels.size() / height)).byte_sequence(pixels);
  }
  /// Binning in x and y; region of interest: x, y, height, width.
  using SensorRegion = std::array<std::uint32_t, 6>;
  /// Encodes a camera info without distortion.
  RosEncoder& camera_info(pcavr::Stamp stamp, std::string_view frame, std::uint32_t width,
                          std::uint32_t height, double f, double cx, double cy,
                          const SensorRegion& region = {}) {
    header(stamp, frame).number(height).number(width).text("plumb_bob").doubles({0, 0, 0, 0, 0});
    for (const double k : {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0}) number(k);
    for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) number(r);
    for (const double p : {f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) number(p);
    for (const std::uint32_t value : region) number(value);
    return number(std::uint8_t{0});
  }
  RosEncoder& transform(pcavr::Stamp stamp, std::string_view parent, std::string_view child,
                        const pcavr::Pose& T_parent_child) {
    return header(stamp, parent).text(child).pose(T_parent_child);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  [[nodiscard]] bool is_cdr() const { return format_ != Format::ros1; }

  Format format_;
  std::string bytes_;
};
