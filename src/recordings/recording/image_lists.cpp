// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording/image_lists.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/pairing.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

using Images = std::vector<ListedImage>;

/// The images of one list; all of their files exist.
Expected<Series<Images>> read_list(const fs::path& folder, const char* name, bool skip_bad) {
  const fs::path file = folder / name;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<Images>> listed = parse_image_list({file.string(), *text, skip_bad});
  if (!listed) return listed;
  Series<Images> present{.content = {}, .report = std::move(listed->report)};
  for (ListedImage& image : listed->content) {
    std::error_code code;
    if (fs::is_regular_file(folder / image.path, code)) {
      present.content.push_back(std::move(image));
    } else if (skip_bad) {
      present.report.count_skipped("image " + fault_of_listed(folder / image.path));
    } else {
      return Error{.message = "the image " + image.path.string() + ' ' +
                              fault_of_listed(folder / image.path),
                   .file = file.string(),
                   .line = image.line,
                   .hint = "add the file, or remove the line"};
    }
  }
  return present;
}

std::vector<Stamp> stamps_of(const Images& images) {
  std::vector<Stamp> stamps;
  stamps.reserve(images.size());
  for (const ListedImage& image : images) stamps.push_back(image.stamp);
  return stamps;
}

PairedImages pair_images(const Series<Images>& color, const Series<Images>& depth,
                         Duration max_gap) {
  PairedImages images;
  const std::vector<Stamp> color_stamps = stamps_of(color.content);
  const std::vector<Stamp> depth_stamps = stamps_of(depth.content);
  for (const auto& [c, d] : pair_by_time(color_stamps, depth_stamps, max_gap)) {
    images.frames.push_back(
        {color_stamps[c], color.content[c].path, depth_stamps[d], depth.content[d].path});
  }
  images.unpaired_color = color_stamps.size() - images.frames.size();
  images.unpaired_depth = depth_stamps.size() - images.frames.size();
  images.color_report = color.report;
  images.depth_report = depth.report;
  return images;
}

}  // namespace

Expected<PairedImages> read_image_lists(const fs::path& folder, const ReadOptions& options) {
  const Expected<Series<Images>> color = read_list(folder, "rgb.txt", options.skip_bad);
  if (!color) return color.error();
  const Expected<Series<Images>> depth = read_list(folder, "depth.txt", options.skip_bad);
  if (!depth) return depth.error();
  PairedImages images =
      pair_images(*color, *depth, Duration(std::llround(options.max_pair_gap * 1e9)));
  if (!images.frames.empty()) return images;
  const double gap = options.max_pair_gap * 1000.0;
  return Error{.message = "contains no frames: of " + std::to_string(images.unpaired_color) +
                          " colour and " + std::to_string(images.unpaired_depth) +
                          " depth images no two match in time",
               .file = folder.string(),
               .hint = "rgb.txt and depth.txt must name images at most " +
                       std::to_string(std::lround(gap)) + " ms apart"};
}

Expected<PairedImages> read_color_list(const fs::path& folder, const ReadOptions& options) {
  const Expected<Series<Images>> color = read_list(folder, "rgb.txt", options.skip_bad);
  if (!color) return color.error();
  PairedImages images;
  images.color_report = color->report;
  for (const ListedImage& image : color->content) {
    images.frames.push_back({image.stamp, image.path, image.stamp, {}});
  }
  if (!images.frames.empty()) return images;
  return Error{.message = "contains no frames: rgb.txt names no image",
               .file = folder.string(),
               .hint = "list the colour images, or remove rgb.txt"};
}

}  // namespace pcavr
