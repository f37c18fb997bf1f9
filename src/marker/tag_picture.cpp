// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/aruco/dictionary.hpp>

#include "pcavr/marker/tag_sheet.hpp"

#include "marker/tag_family.hpp"

namespace pcavr {
namespace {

struct ImageDeleter {
  void operator()(image_u8_t* image) const { image_u8_destroy(image); }
};

Error unknown_id(const std::string& family, int id, int count) {
  return {.message = family + " has no tag " + std::to_string(id),
          .mend = "take ids from 0 to " + std::to_string(count - 1)};
}

/// Families with bits outside the border square are drawn whole; the ring that libapriltag draws
/// around the others is quiet zone.
TagPicture draw_apriltag(const apriltag_family_t& family, int id) {
  const std::unique_ptr<image_u8_t, ImageDeleter> image(
      apriltag_to_image(const_cast<apriltag_family_t*>(&family), static_cast<uint32_t>(id)));
  const int ring = (family.total_width - family.width_at_border) / 2;
  const int quiet = family.reversed_border ? 0 : ring;
  TagPicture picture;
  picture.cells = family.total_width - 2 * quiet;
  picture.border = ring - quiet;
  for (int y = 0; y < picture.cells; ++y) {
    for (int x = 0; x < picture.cells; ++x) {
      const int index = (y + quiet) * image->stride + x + quiet;
      picture.is_white.push_back(image->buf[index] > 127);
    }
  }
  return picture;
}

TagPicture draw_aruco(const cv::aruco::Dictionary& dictionary, int id) {
  TagPicture picture;
  picture.cells = dictionary.markerSize + 2;
  cv::Mat image;
  dictionary.drawMarker(id, picture.cells, image, 1);
  for (int y = 0; y < picture.cells; ++y) {
    for (int x = 0; x < picture.cells; ++x) {
      picture.is_white.push_back(image.at<unsigned char>(y, x) > 127);
    }
  }
  return picture;
}

}  // namespace

Expected<TagPicture> tag_picture(const std::string& family, int id) {
  if (const auto apriltag = make_apriltag_family(family)) {
    const int count = static_cast<int>((*apriltag)->ncodes);
    if (id < 0 || id >= count) return unknown_id(family, id, count);
    return draw_apriltag(**apriltag, id);
  }
  if (const auto number = aruco_dictionary_number(family)) {
    const cv::Ptr<cv::aruco::Dictionary> dictionary = cv::aruco::Dictionary::get(*number);
    if (id < 0 || id >= dictionary->bytesList.rows) {
      return unknown_id(family, id, dictionary->bytesList.rows);
    }
    return draw_aruco(*dictionary, id);
  }
  return unknown_family(family);
}

}  // namespace pcavr
