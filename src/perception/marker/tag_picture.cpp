// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include <opencv2/aruco/dictionary.hpp>

#include "pcavr/perception/marker/tag_sheet.hpp"

#include "perception/marker/tag_family.hpp"

namespace pcavr {
namespace {

Error unknown_id(const std::string& family, int id, int count) {
  return {.message = family + " has no tag " + std::to_string(id),
          .hint = "use ids from 0 to " + std::to_string(count - 1)};
}

/// Families with bits outside the square through the detection corners (reversed border) have a
/// white ring inside it and are drawn completely; the others have a black ring inside it.
TagPicture draw_apriltag(const apriltag_family_t& family, int id) {
  const int across = family.width_at_border;
  TagPicture picture;
  picture.border = family.reversed_border ? (family.total_width - across) / 2 : 0;
  picture.cells = across + 2 * picture.border;
  const auto paint_white = [&](int x, int y) {  // counted from the square's top left cell
    const int index = (y + picture.border) * picture.cells + x + picture.border;
    picture.is_white[static_cast<std::size_t>(index)] = true;
  };
  picture.is_white.assign(static_cast<std::size_t>(picture.cells * picture.cells), false);
  if (family.reversed_border) {
    for (int i = 0; i < across; ++i) {
      paint_white(i, 0);
      paint_white(i, across - 1);
      paint_white(0, i);
      paint_white(across - 1, i);
    }
  }
  for (uint32_t bit = 0; bit < family.nbits; ++bit) {
    const bool is_set = (family.codes[id] >> (family.nbits - 1 - bit)) & 1U;
    if (is_set)
      paint_white(static_cast<int>(family.bit_x[bit]), static_cast<int>(family.bit_y[bit]));
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
