// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/recordings/bag_import/bag_selection.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/bag_import/world_placement.hpp"

namespace pcavr {

struct BagImportOptions {
  BagTopicOptions topics = {};
  std::optional<CameraModel> camera = {};  ///< instead of the bag's camera info
  /// Scale [units/m] of the depth images written for depth in metres; default: 5000.
  std::optional<double> depth_scale = {};
  /// Scale [units/m] of the bag's 16-bit depth images, which are not changed; default: 1000,
  /// millimetres [REP 118].
  std::optional<double> raw_depth_scale = {};
  /// A recording.yaml of which markers, objects, tool and robot are taken over, with their files.
  std::filesystem::path manifest = {};
  CsvOptions csv = {};              ///< how CSV files are read
  bool use_receive_stamps = false;  ///< instead of the stamps in the headers
  bool invert_wrench = false;       ///< for sensors that report the force on the tool
  /// [rad] by which forces in the tool's axes are turned about its z: the sensor's place on it.
  double wrench_turn = 0.0;
  double tare = 0.0;  ///< [s] the wrench's mean over this time from its start is taken off
  Eigen::Vector3d p_tool_tip = Eigen::Vector3d::Zero();  ///< [m] the tip in the tool's frame
  double tool_delay = 0.0;                               ///< [s] the tool's stamps are late by it
  /// The pose of the objects' world frame, where TF does not have it; it can also be found by the
  /// first object's sides.
  std::optional<Pose> T_base_world = {};
  /// The pose of an object's CAD frame in the body that is tracked, where they differ, by name.
  std::map<std::string, Pose> T_tracked_object = {};
  std::optional<PushedSides> pushed_sides = {};
  std::vector<std::filesystem::path> world_bags = {};  ///< by which it is found, beside this one
  std::size_t stride = 1;                              ///< take every n-th frame
  std::size_t first = 0;                               ///< skip the frames before this one
};

/// One file of the recording, or its images.
struct ImportedStream {
  std::string file;   ///< "tool.csv"
  std::string topic;  ///< of the bag, or the frame
  std::size_t rows = 0;
  std::size_t duplicates = 0;  ///< left out: their stamp is another row's
  std::size_t left_out = 0;    ///< not decodable, not finite, out of range or without transform
  std::string left_out_reason = {};  ///< of the first
  std::size_t reordered = 0;         ///< stamps before that of the message before
  std::optional<double> delay = {};  ///< [s] median from header stamp to log time
  bool has_receive_stamps = false;   ///< log times are used as stamps
  std::string frame = {};            ///< of the messages, and how it was taken to the base frame
};

struct BagImportReport {
  std::vector<ImportedStream> streams;
  std::string base_frame;
  std::optional<WorldPlacement> world = {};  ///< where it was to be found
  std::vector<std::string> notes;            ///< what was not taken, and by which option it can be
  double duration = 0.0;                     ///< [s] of the bag
  std::size_t messages = 0;
};

/// Converts a bag to a recording at `target`, an existing, empty folder. Reads the bag two or three
/// times: to choose topics, for the time series, and for the images, which are written as they
/// come; memory grows with the time series only. Poses and forces are transformed to the base frame
/// by TF. Warnings go to the observer. Errors name bag and topic; the caller removes what was
/// written.
[[nodiscard]] Expected<BagImportReport> import_bag(const std::filesystem::path& bag,
                                                   const std::filesystem::path& target,
                                                   const BagImportOptions& options,
                                                   const Observer& observer = {});

}  // namespace pcavr
