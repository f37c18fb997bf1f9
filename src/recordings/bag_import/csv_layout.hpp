// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"

namespace pcavr {

/// The numbers of a row, as they make a message of ROS.
enum class RowForm {
  message,          ///< in the order in which ROS has them
  force,            ///< of a wrench, whose torques were not logged
  rotation_vector,  ///< position and rotation vector [rad], as UR's controllers log poses
  matrix,           ///< of four rows and columns, column after column, as Franka's log them
  angles_zyx,       ///< position, then the turns about z, y and x [rad], as KUKA's log them
};

/// The message of a body that motion capture tracks: it is an object, and not the tool.
inline constexpr const char* kTrackedBodyType = "geometry_msgs/TransformStamped";

/// The columns of a file and their units.
struct CsvLayout {
  struct Number {
    std::size_t column = 0;
    double factor = 1.0;  ///< from the column's unit to SI
  };
  struct StampColumn {
    std::size_t column = 0;
    std::optional<TimeUnit> unit = {};  ///< of the header or the first row; none: not known
    bool is_unit_stated = false;        ///< in the header
    bool is_date = false;               ///< dates with the time of day
  };
  /// The samples of one topic: of a row, or where the fields of a row are empty none.
  struct Series {
    std::string type;       ///< of a message of ROS
    std::string name = {};  ///< of the body or quantity; empty: the file's
    std::vector<Number> numbers = {};
    RowForm form = RowForm::message;
  };
  char separator = ',';
  std::size_t header_lines = 1;
  std::vector<Series> series = {};      ///< empty where no known columns were found
  StampColumn stamp = {};               ///< of the sensor
  StampColumn log_time = {};            ///< of the recorder; the sensor's where there is none
  std::vector<std::string> names = {};  ///< of all columns, as the header has them
  std::optional<Stamp> start = {};      ///< to which the stamps are added
  /// [ns] taken off stamps in local time; none: the file has no such stamps.
  std::optional<Duration> zone = {};
  bool is_y_up = false;                   ///< world and bodies have y upwards
  bool is_take = false;                   ///< of motion capture: its series are bodies
  bool has_gaps = false;                  ///< an empty field is no fault: the body was not seen
  std::vector<std::string> remarks = {};  ///< for the user: what was assumed
};

/// The column of the sensor's stamps, or where there is none of the recorder's.
[[nodiscard]] std::optional<std::size_t> stamp_column_of(const std::vector<CsvColumn>& columns);

/// Finds the layout from the first lines of a file; its lines after the header may be absent. A
/// header without known columns has no series. Fails where a known column has an unknown unit; the
/// error has no file.
[[nodiscard]] Expected<CsvLayout> layout_of(std::string_view text, const CsvOptions& options);

}  // namespace pcavr
