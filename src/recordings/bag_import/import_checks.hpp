// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/bag_import/bag_selection.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

#include "recordings/bag_import/bag_streams.hpp"

namespace pcavr {

/// "a, b".
[[nodiscard]] std::string joined(const std::vector<std::string>& names);

/// An Error for a topic whose stamps span more than a recording's may (ranges::kSpan).
[[nodiscard]] Expected<void> check_spans(const std::filesystem::path& bag,
                                         const BagStreams& streams);
/// The same of the poses of a frame by TF.
[[nodiscard]] Expected<void> check_span(const std::filesystem::path& bag, const std::string& frame,
                                        const Trajectory& poses);

/// Text of a warning that says how a static transform is replaced; `begin` is the bag's.
[[nodiscard]] std::string replacement_text(const std::vector<TransformTree::StaticValue>& values,
                                           Stamp begin);

/// Declares the tracked objects that the manifest lacks. An Error for a name that no manifest may
/// have.
[[nodiscard]] Expected<void> declare_objects(const BagSelection& selection, Manifest& manifest);
/// An Error for a place on an object that is not tracked.
[[nodiscard]] Expected<void> check_placed_objects(
    const std::filesystem::path& bag, const BagSelection& selection,
    const std::map<std::string, Pose>& T_tracked_object);

/// Warnings about colour images: there are none, the order of their channels is not stated, or
/// depth is not registered to them. Depth with its own camera info is registered if that equals the
/// colour's except for the size.
[[nodiscard]] std::vector<std::string> color_doubts(const BagSelection& selection,
                                                    const BagStreams& streams);

}  // namespace pcavr
