// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/csv_columns.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

namespace pcavr {
namespace {

/// Names that programs give to a quantity; '?' is the axis.
struct Quantity {
  std::vector<std::string_view> names;
  std::vector<std::string_view> axes;
  std::vector<std::pair<std::string_view, double>> units;  ///< with the factor to SI
};
using Axes = std::vector<std::string_view>;
using Units = std::vector<std::pair<std::string_view, double>>;

constexpr double kDegree = std::numbers::pi / 180.0;
const Axes& xyz() {
  static const Axes kXyz{"x", "y", "z"};
  return kXyz;
}
const Units& lengths() {
  static const Units kLengths{{"", 1.0}, {"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}};
  return kLengths;
}
const Quantity& position() {
  static const Quantity kPosition{
      {"?", "p?", "p_?", "pos_?", "position_?", "pose_position_?", "translation_?", "t?"},
      xyz(),
      lengths()};
  return kPosition;
}
const Quantity& point() {
  static const Quantity kPoint{
      {"?", "p?", "p_?", "pos_?", "position_?", "point_?"}, xyz(), lengths()};
  return kPoint;
}
const Quantity& rotation() {
  static const Quantity kRotation{{"q?", "q_?", "quat_?", "quaternion_?", "orientation_?", "rot_?",
                                   "rotation_?", "pose_orientation_?"},
                                  {"x", "y", "z", "w"},
                                  {{"", 1.0}}};
  return kRotation;
}
const Quantity& rotation_vector() {
  static const Quantity kVector{{"r?", "r_?", "rvec_?", "rotvec_?", "rot_?", "rotation_?"},
                                xyz(),
                                {{"", 1.0}, {"rad", 1.0}, {"deg", kDegree}}};
  return kVector;
}
const Quantity& force() {
  static const Quantity kForce{
      {"f?", "f_?", "force_?", "wrench_force_?"}, xyz(), {{"", 1.0}, {"n", 1.0}, {"kn", 1e3}}};
  return kForce;
}
const Quantity& torque() {
  static const Quantity kTorque{
      {"t?", "t_?", "torque_?", "m?", "m_?", "moment_?", "wrench_torque_?"},
      xyz(),
      {{"", 1.0}, {"nm", 1.0}, {"ncm", 1e-2}, {"nmm", 1e-3}}};
  return kTorque;
}
/// [UR, RTDE guide]: x, y, z [m] and a rotation vector [rad].
const Quantity& ur_pose() {
  static const Quantity kPose{
      {"actual_tcp_pose_?", "tcp_pose_?"}, {"0", "1", "2", "3", "4", "5"}, {{"", 1.0}}};
  return kPose;
}
const Quantity& ur_wrench() {
  static const Quantity kWrench{{"actual_tcp_force_?", "ft_raw_wrench_?", "tcp_force_?"},
                                {"0", "1", "2", "3", "4", "5"},
                                {{"", 1.0}}};
  return kWrench;
}
/// [libfranka, RobotState]: the end effector in base, column after column; the wrench on it in
/// base axes.
const Quantity& franka_pose() {
  static const Quantity kPose{
      {"o_t_ee_?"},
      {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15"},
      {{"", 1.0}}};
  return kPose;
}
const Quantity& franka_wrench() {
  static const Quantity kWrench{{"o_f_ext_hat_k_?"}, {"0", "1", "2", "3", "4", "5"}, {{"", 1.0}}};
  return kWrench;
}
/// [KUKA System Software]: mm, and turns about z, y and x in degrees.
const Quantity& kuka_position() {
  static const Quantity kPosition{
      {"?", "pos_act_?", "rist_?"}, xyz(), {{"", 1e-3}, {"m", 1.0}, {"mm", 1e-3}}};
  return kPosition;
}
const Quantity& kuka_angles() {
  static const Quantity kAngles{{"?", "pos_act_?", "rist_?"},
                                {"a", "b", "c"},
                                {{"", kDegree}, {"deg", kDegree}, {"rad", 1.0}}};
  return kAngles;
}

/// The content of a ROS message, in the order in which ROS serialises it, or in that of a form.
struct MessageKind {
  const char* type;
  const char* name;  ///< of the series where the file has several
  std::vector<const Quantity*> quantities;
  RowForm form = RowForm::message;
  const char* remark = nullptr;      ///< of units that no header states
  const char* assumption = nullptr;  ///< what is assumed in any case
  bool is_prefixed = false;          ///< a name before the quantity's may say whose it is
};
const std::vector<MessageKind>& message_kinds() {
  static const std::vector<MessageKind> kKinds{
      {.type = "geometry_msgs/PoseStamped",
       .name = "pose",
       .quantities = {&position(), &rotation()},
       .is_prefixed = true},
      {.type = "geometry_msgs/PoseStamped",
       .name = "pose",
       .quantities = {&ur_pose()},
       .form = RowForm::rotation_vector},
      {.type = "geometry_msgs/PoseStamped",
       .name = "pose",
       .quantities = {&franka_pose()},
       .form = RowForm::matrix},
      {.type = "geometry_msgs/PoseStamped",
       .name = "pose",
       .quantities = {&kuka_position(), &kuka_angles()},
       .form = RowForm::angles_zyx,
       .remark = "x, y, z, a, b, c without units are read in mm and degrees, as KUKA has them"},
      {.type = "geometry_msgs/WrenchStamped",
       .name = "force",
       .quantities = {&force(), &torque()},
       .is_prefixed = true},
      {.type = "geometry_msgs/WrenchStamped", .name = "force", .quantities = {&ur_wrench()}},
      {.type = "geometry_msgs/WrenchStamped", .name = "force", .quantities = {&franka_wrench()}},
      {.type = "geometry_msgs/WrenchStamped",
       .name = "force",
       .quantities = {&force()},
       .form = RowForm::force,
       .assumption = "forces without torques, as of a sensor of three axes: the torques are 0",
       .is_prefixed = true},
      {.type = "geometry_msgs/PointStamped", .name = "point", .quantities = {&point()}}};
  return kKinds;
}

using Columns = std::vector<std::size_t>;

/// Finds columns that no other series has.
class ColumnFinder {
 public:
  ColumnFinder(const std::vector<CsvColumn>& columns, const std::vector<std::string>& names)
      : columns_(columns), names_(names), is_used_(columns.size(), false) {}

  /// The columns of all quantities under the names with this prefix; empty where one is absent.
  [[nodiscard]] std::vector<Columns> find(const MessageKind& kind, std::string_view prefix) const {
    std::vector<Columns> found;
    for (const Quantity* quantity : kind.quantities) {
      found.push_back(columns_of(*quantity, prefix));
      if (found.back().empty()) return {};
    }
    return found;
  }

  /// The prefixes with which the first column of a kind may be named.
  [[nodiscard]] std::vector<std::string> prefixes_of(const MessageKind& kind) const {
    std::vector<std::string> prefixes;
    for (const std::string_view pattern : kind.quantities.front()->names) {
      const std::string ending = name_of(pattern, kind.quantities.front()->axes.front());
      for (const CsvColumn& column : columns_) {
        if (!column.name.ends_with("_" + ending)) continue;
        std::string prefix = column.name.substr(0, column.name.size() - ending.size());
        if (std::find(prefixes.begin(), prefixes.end(), prefix) == prefixes.end()) {
          prefixes.push_back(std::move(prefix));
        }
      }
    }
    // The shortest is the body's name: the longer ones have parts of the quantity's.
    std::stable_sort(prefixes.begin(), prefixes.end(),
                     [](const auto& one, const auto& other) { return one.size() < other.size(); });
    return prefixes;
  }

  [[nodiscard]] Expected<std::vector<CsvLayout::Number>> take(const MessageKind& kind,
                                                              const std::vector<Columns>& found) {
    std::vector<CsvLayout::Number> numbers;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Units& units = kind.quantities[i]->units;
      for (const std::size_t column : found[i]) {
        const std::string& unit = columns_[column].unit;
        const auto known = std::find_if(units.begin(), units.end(),
                                        [&](const auto& entry) { return entry.first == unit; });
        if (known == units.end()) {
          return unknown_unit(names_[column], unit, "lengths in m, forces in N, torques in Nm");
        }
        numbers.push_back({column, known->second});
        is_used_[column] = true;
      }
    }
    return numbers;
  }

  [[nodiscard]] bool has_unit(const std::vector<Columns>& found) const {
    return std::any_of(found.begin(), found.end(), [&](const Columns& columns) {
      return std::any_of(columns.begin(), columns.end(),
                         [&](std::size_t column) { return !columns_[column].unit.empty(); });
    });
  }

 private:
  static std::string name_of(std::string_view pattern, std::string_view axis) {
    std::string name(pattern);
    return name.replace(name.find('?'), 1, axis);
  }

  [[nodiscard]] Columns columns_of(const Quantity& quantity, std::string_view prefix) const {
    for (const std::string_view pattern : quantity.names) {
      Columns found;
      for (const std::string_view axis : quantity.axes) {
        const std::string name = std::string(prefix) + name_of(pattern, axis);
        const auto at = std::find_if(columns_.begin(), columns_.end(),
                                     [&](const CsvColumn& c) { return c.name == name; });
        const auto index = static_cast<std::size_t>(at - columns_.begin());
        if (at != columns_.end() && !is_used_[index]) found.push_back(index);
      }
      if (found.size() == quantity.axes.size()) return found;
    }
    return {};
  }

  const std::vector<CsvColumn>& columns_;
  const std::vector<std::string>& names_;
  std::vector<bool> is_used_;
};

std::string plain_prefix(std::string prefix) {
  while (prefix.ends_with('_')) prefix.pop_back();
  return prefix;
}

/// Adds the series of a kind whose columns are named after their body.
Expected<void> add_prefixed(const MessageKind& kind, ColumnFinder& finder,
                            std::vector<CsvLayout::Series>& series,
                            std::vector<std::string>& remarks) {
  if (!kind.is_prefixed) return {};
  for (const std::string& prefix : finder.prefixes_of(kind)) {
    const std::vector<Columns> found = finder.find(kind, prefix);
    if (found.empty()) continue;
    if (kind.assumption != nullptr) remarks.emplace_back(prefix + ": " + kind.assumption);
    auto numbers = finder.take(kind, found);
    if (!numbers) return numbers.error();
    series.push_back({.type = kind.type,
                      .name = plain_prefix(prefix),
                      .numbers = *std::move(numbers),
                      .form = kind.form});
  }
  return {};
}

}  // namespace

Error unknown_unit(const std::string& name, const std::string& unit, const char* known) {
  return {.message = "the unit '" + unit + "' of column '" + name + "' is not known",
          .line = 1,
          .hint = std::string("give ") + known};
}

Expected<std::vector<CsvLayout::Series>> series_of(const std::vector<CsvColumn>& columns,
                                                   const std::vector<std::string>& names,
                                                   std::vector<std::string>& remarks) {
  ColumnFinder finder(columns, names);
  std::vector<CsvLayout::Series> series;
  for (const MessageKind& kind : message_kinds()) {
    const bool is_known = std::any_of(series.begin(), series.end(),
                                      [&](const auto& other) { return other.type == kind.type; });
    const std::vector<Columns> found = is_known ? std::vector<Columns>() : finder.find(kind, "");
    if (found.empty()) continue;
    if (kind.remark != nullptr && !finder.has_unit(found)) remarks.emplace_back(kind.remark);
    if (kind.assumption != nullptr) remarks.emplace_back(kind.assumption);
    auto numbers = finder.take(kind, found);
    if (!numbers) return numbers.error();
    series.push_back({.type = kind.type,
                      .name = series.empty() ? "" : kind.name,
                      .numbers = *std::move(numbers),
                      .form = kind.form});
  }
  if (!series.empty()) return series;
  for (const MessageKind& kind : message_kinds()) {
    const Expected<void> added = add_prefixed(kind, finder, series, remarks);
    if (!added) return added.error();
  }
  return series;
}

Expected<CsvLayout::Series> rotation_vector_series(const std::vector<CsvColumn>& columns,
                                                   const std::vector<std::string>& names) {
  const MessageKind kind{.type = "geometry_msgs/PoseStamped",
                         .name = "pose",
                         .quantities = {&position(), &rotation_vector()},
                         .form = RowForm::rotation_vector};
  ColumnFinder finder(columns, names);
  CsvLayout::Series series{.type = kind.type, .form = kind.form};
  const std::vector<Columns> found = finder.find(kind, "");
  if (found.empty()) return series;
  auto numbers = finder.take(kind, found);
  if (!numbers) return numbers.error();
  series.numbers = *std::move(numbers);
  return series;
}

}  // namespace pcavr
