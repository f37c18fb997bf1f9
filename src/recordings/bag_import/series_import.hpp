// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "recordings/bag_import/bag_streams.hpp"

namespace pcavr {

/// A time series of the recording, and what the report states of it.
template <typename Content>
struct ImportedSeries {
  Content content;
  ImportedStream stream;
};

/// Transforms the messages of a bag to the base frame, in the order of their stamps.
class SeriesImporter {
 public:
  SeriesImporter(const std::filesystem::path& bag, const BagSelection& selection,
                 const BagImportOptions& options, const BagStreams& streams,
                 const StampRule& stamps, const Observer& observer)
      : bag_(bag),
        selection_(selection),
        options_(options),
        streams_(streams),
        stamps_(stamps),
        observer_(observer) {}

  /// T_base_body of a topic's poses. An Error where --base-frame was given and is not connected
  /// with the messages' frame.
  [[nodiscard]] Expected<ImportedSeries<Trajectory>> poses(const SurveyedTopic& topic,
                                                           const std::string& file) const;
  /// T_base_frame by TF, at the stamps of the links that move, or at these stamps. An Error where
  /// the frames are not connected.
  [[nodiscard]] Expected<ImportedSeries<Trajectory>> frame(const std::string& frame,
                                                           const std::string& file,
                                                           std::vector<Stamp> stamps) const;
  /// Force and torque in base axes; the torque about the tip where TF has the sensor's place.
  [[nodiscard]] Expected<ImportedSeries<std::vector<WrenchSample>>> wrench(
      const Trajectory& T_base_tool) const;
  /// The joints of the message type with the most of them.
  [[nodiscard]] Expected<ImportedSeries<JointLog>> joints() const;

 private:
  /// The way in which messages of one frame are transformed to the base frame.
  struct FrameRoute {
    bool is_as_it_is = true;
    std::vector<TransformTree::Link> links = {};
    std::string text = {};
  };
  [[nodiscard]] Expected<FrameRoute> route_from(const std::string& frame,
                                                const SurveyedTopic& topic) const;
  [[nodiscard]] ImportedStream stream_of(const SurveyedTopic& topic, const std::string& file) const;

  const std::filesystem::path& bag_;
  const BagSelection& selection_;
  const BagImportOptions& options_;
  const BagStreams& streams_;
  const StampRule& stamps_;
  const Observer& observer_;
};

}  // namespace pcavr
