// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/qr_code.hpp"

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace pcavr {
namespace {

/// The terminal's picture, a module per pixel, black on white.
cv::Mat drawn(const std::string& picture) {
  cv::Mat rows;
  std::istringstream lines(picture);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find('m') + 1;
    const std::string cells = line.substr(begin, line.rfind('\x1b') - begin);
    cv::Mat upper(1, 0, CV_8U);
    cv::Mat lower(1, 0, CV_8U);
    for (std::size_t i = 0; i < cells.size();) {
      const bool is_space = cells[i] == ' ';
      const std::string cell = cells.substr(i, is_space ? 1 : 3);
      const cv::Mat black(1, 1, CV_8U, cv::Scalar(0));
      const cv::Mat white(1, 1, CV_8U, cv::Scalar(255));
      cv::hconcat(upper, cell == "\u2580" || cell == "\u2588" ? black : white, upper);
      cv::hconcat(lower, cell == "\u2584" || cell == "\u2588" ? black : white, lower);
      i += cell.size();
    }
    rows.push_back(upper);
    rows.push_back(lower);
  }
  return rows;
}

/// Whether a module belongs to the pattern of a code with one alignment pattern (versions 2 to 6).
bool is_pattern(int row, int column, int size) {
  const bool is_finder =
      (row < 9 && column < 9) || (row < 9 && column >= size - 8) || (row >= size - 8 && column < 9);
  const bool is_alignment = std::abs(row - (size - 7)) <= 2 && std::abs(column - (size - 7)) <= 2;
  return is_finder || is_alignment || row == 6 || column == 6;
}

bool is_masked(int mask, int row, int column) {
  switch (mask) {
    case 0:
      return (row + column) % 2 == 0;
    case 1:
      return row % 2 == 0;
    case 2:
      return column % 3 == 0;
    case 3:
      return (row + column) % 3 == 0;
    case 4:
      return (row / 2 + column / 3) % 2 == 0;
    case 5:
      return row * column % 2 + row * column % 3 == 0;
    case 6:
      return (row * column % 2 + row * column % 3) % 2 == 0;
    default:
      return ((row + column) % 2 + row * column % 3) % 2 == 0;
  }
}

/// The bytes of a code of versions 2 to 5 with correction level L (one block), without correction.
std::string read(const cv::Mat& framed) {
  const cv::Mat code = framed(cv::boundingRect(framed == 0));
  const int size = code.rows;
  const auto bit = [&](int row, int column) { return code.at<unsigned char>(row, column) == 0; };
  // The format's third to fifth bit, which 101 covers.
  const int mask = (4 * bit(8, 2) + 2 * bit(8, 3) + bit(8, 4)) ^ 0b101;
  std::vector<bool> bits;
  bool is_upwards = true;
  for (int right = size - 1; right > 0; right -= 2) {
    if (right == 6) --right;  // the timing pattern
    for (int i = 0; i < size; ++i) {
      const int row = is_upwards ? size - 1 - i : i;
      for (const int column : {right, right - 1}) {
        if (is_pattern(row, column, size)) continue;
        bits.push_back(bit(row, column) != is_masked(mask, row, column));
      }
    }
    is_upwards = !is_upwards;
  }
  const auto number = [&](std::size_t begin, std::size_t count) {
    int value = 0;
    for (std::size_t i = begin; i < begin + count; ++i) value = 2 * value + bits.at(i);
    return value;
  };
  EXPECT_EQ(number(0, 4), 4) << "bytes";
  std::string text;
  for (int i = 0; i < number(4, 8); ++i)
    text += static_cast<char>(number(12 + 8 * static_cast<std::size_t>(i), 8));
  return text;
}

TEST(QrCode, IsReadFromTheTerminal) {
  for (const std::string text : {"https://192.168.1.20:8080/#code=K7QXM2",
                                 "https://[2001:db8::8a2e:370:7334]:65535/#code=ABCDEF"}) {
    const cv::Mat modules = drawn(qr_code_for_terminal(text));
    ASSERT_FALSE(modules.empty());
    EXPECT_EQ(read(modules), text);
  }
}

TEST(QrCode, HasAWhiteBorder) {
  const cv::Mat modules = drawn(qr_code_for_terminal("https://10.0.0.1:8080/"));
  EXPECT_EQ(cv::countNonZero(modules.rowRange(0, 4)), 4 * modules.cols);
  EXPECT_EQ(cv::countNonZero(modules.colRange(0, 4)), 4 * modules.rows);
}

TEST(QrCode, ThePictureHasTheSameModules) {
  const std::string text = "https://192.168.1.20:8080/#code=K7QXM2";
  const cv::Mat modules = drawn(qr_code_for_terminal(text));
  const std::string svg = qr_code_svg(text);
  std::size_t black = 0;
  for (int row = 0; row < modules.rows; ++row) {
    for (int column = 0; column < modules.cols; ++column) {
      const std::string module =
          'M' + std::to_string(column) + ' ' + std::to_string(row) + "h1v1h-1z";
      const bool is_black = modules.at<unsigned char>(row, column) == 0;
      EXPECT_EQ(svg.find(module) != std::string::npos, is_black && row < modules.cols);
      black += is_black ? 1 : 0;
    }
  }
  EXPECT_GT(black, 100U);
  EXPECT_EQ(qr_code_svg(""), "");
}

TEST(QrCode, IsEmptyWithoutText) {
  EXPECT_EQ(qr_code_for_terminal(""), "");
  EXPECT_EQ(qr_code_for_terminal(std::string(1000, 'a')), "");
}

}  // namespace
}  // namespace pcavr
