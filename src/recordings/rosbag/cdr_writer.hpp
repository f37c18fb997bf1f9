// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::cdr {

/// The definitions that several message types contain, each with its separator and name before it.
inline constexpr std::string_view kSeparator =
    "================================================================================\n";
inline constexpr std::string_view kHeader =
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
inline constexpr std::string_view kTime =
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
inline constexpr std::string_view kPoint =
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
inline constexpr std::string_view kVector =
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
inline constexpr std::string_view kQuaternion =
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
inline constexpr std::string_view kPose =
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
inline constexpr std::string_view kTransform =
    "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation\n";

[[nodiscard]] inline std::string definition(std::string_view own,
                                            std::initializer_list<std::string_view> others) {
  std::string text(own);
  for (const std::string_view other : others) {
    text += kSeparator;
    text += other;
  }
  return text;
}

/// Writes the fields of a message in the order of its definition, aligned.
class Writer {
 public:
  Writer() : bytes_{0, 1, 0, 0} {}  // CDR_LE

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u32(std::uint32_t value) { number(value, 4); }
  void f32(float value) { number(std::bit_cast<std::uint32_t>(value), 4); }
  void f64(double value) { number(std::bit_cast<std::uint64_t>(value), 8); }
  void count(std::size_t size) { u32(static_cast<std::uint32_t>(size)); }
  void text(std::string_view text) {
    count(text.size() + 1);
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  void time(Stamp stamp) {
    std::int64_t seconds = stamp.nanoseconds / kNanoseconds;
    if (seconds * kNanoseconds > stamp.nanoseconds) --seconds;
    u32(static_cast<std::uint32_t>(seconds));
    u32(static_cast<std::uint32_t>(stamp.nanoseconds - seconds * kNanoseconds));
  }
  void header(Stamp stamp, std::string_view frame) {
    time(stamp);
    text(frame);
  }
  void vector(const Eigen::Vector3d& v) {
    for (const double value : {v.x(), v.y(), v.z()}) f64(value);
  }
  void pose(const Pose& pose) {
    vector(pose.translation());
    const Eigen::Quaterniond& q = pose.rotation();
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) f64(value);
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes_.size() + bytes); }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  static constexpr std::int64_t kNanoseconds = 1'000'000'000;
  static constexpr std::size_t kEncapsulationBytes = 4;  // alignment counts from after it

  void number(std::uint64_t value, std::size_t size) {
    while ((bytes_.size() - kEncapsulationBytes) % size != 0) bytes_.push_back(0);
    for (std::size_t i = 0; i < size; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace pcavr::cdr
