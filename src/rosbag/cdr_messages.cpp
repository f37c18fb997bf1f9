// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/rosbag/cdr_messages.hpp"

#include <bit>
#include <cstddef>
#include <initializer_list>
#include <utility>

namespace pcavr::cdr {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr std::size_t kEncapsulationBytes = 4;  // alignment counts from after it

constexpr std::string_view kSeparator =
    "================================================================================\n";
constexpr std::string_view kHeader =
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr std::string_view kTime = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
constexpr std::string_view kPoint = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr std::string_view kVector =
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr std::string_view kQuaternion =
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
constexpr std::string_view kPose =
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
constexpr std::string_view kWrench =
    "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n";
constexpr std::string_view kTransform =
    "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation\n";
constexpr std::string_view kTransformStamped =
    "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform\n";

std::string definition(std::string_view own, std::initializer_list<std::string_view> others) {
  std::string text(own);
  for (const std::string_view other : others) {
    text += kSeparator;
    text += other;
  }
  return text;
}

class Writer {
 public:
  Writer() : bytes_{0, 1, 0, 0} {}  // CDR_LE

  void u32(std::uint32_t value) { number(value, 4); }
  void f64(double value) { number(std::bit_cast<std::uint64_t>(value), 8); }
  void text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size() + 1));
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
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void number(std::uint64_t value, std::size_t size) {
    while ((bytes_.size() - kEncapsulationBytes) % size != 0) bytes_.push_back(0);
    for (std::size_t i = 0; i < size; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::string pose_stamped_definition() {
  return definition("std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                    {kHeader, kTime, kPose, kPoint, kQuaternion});
}

std::string wrench_stamped_definition() {
  return definition("std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
                    {kHeader, kTime, kWrench, kVector});
}

std::string tf_message_definition() {
  return definition("geometry_msgs/TransformStamped[] transforms\n",
                    {kTransformStamped, kHeader, kTime, kTransform, kVector, kQuaternion});
}

std::vector<std::uint8_t> pose_stamped(Stamp stamp, const Pose& T_base_child,
                                       std::string_view frame) {
  Writer writer;
  writer.header(stamp, frame);
  writer.pose(T_base_child);
  return writer.take();
}

std::vector<std::uint8_t> wrench_stamped(Stamp stamp, const Eigen::Vector3d& force,
                                         const Eigen::Vector3d& torque, std::string_view frame) {
  Writer writer;
  writer.header(stamp, frame);
  writer.vector(force);
  writer.vector(torque);
  return writer.take();
}

std::vector<std::uint8_t> tf_message(Stamp stamp, const std::vector<Transform>& transforms,
                                     std::string_view frame) {
  Writer writer;
  writer.u32(static_cast<std::uint32_t>(transforms.size()));
  for (const Transform& transform : transforms) {
    writer.header(stamp, frame);
    writer.text(transform.child_frame);
    writer.pose(transform.T_base_child);
  }
  return writer.take();
}

std::vector<std::uint8_t> joint_trajectory(Stamp stamp, const std::vector<std::string>& joints,
                                           const std::vector<double>& positions,
                                           double time_from_start) {
  Writer writer;
  writer.header(stamp, "");
  writer.u32(static_cast<std::uint32_t>(joints.size()));
  for (const std::string& joint : joints) writer.text(joint);
  writer.u32(1);  // points
  writer.u32(static_cast<std::uint32_t>(positions.size()));
  for (const double position : positions) writer.f64(position);
  for (int i = 0; i < 3; ++i) writer.u32(0);  // velocities, accelerations, effort
  writer.time(Stamp::from_seconds(time_from_start));
  return writer.take();
}

}  // namespace pcavr::cdr
