// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/qr_code.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>

namespace pcavr {
namespace {

constexpr int kQuiet = 4;  ///< [modules] of white around the code, by the standard
constexpr std::size_t kMaxLength = 200;
constexpr const char* kBlackOnWhite = "\x1b[38;5;16;48;5;231m";
constexpr const char* kReset = "\x1b[0m";
/// Characters by whether the upper (1) and the lower module (2) are black.
constexpr std::array<const char*, 4> kBlocks{" ", "\u2580", "\u2584", "\u2588"};

/// The code's modules with its border, 0: black; empty where the text is too long.
cv::Mat framed_code(const std::string& text) {
  if (text.empty() || text.size() > kMaxLength) return {};
  cv::Mat modules;
  cv::QRCodeEncoder::Params parameters;
  parameters.correction_level = cv::QRCodeEncoder::CORRECT_LEVEL_L;
  cv::QRCodeEncoder::create(parameters)->encode(text, modules);
  if (modules.empty()) return {};
  cv::Mat framed;
  cv::copyMakeBorder(modules, framed, kQuiet, kQuiet, kQuiet, kQuiet, cv::BORDER_CONSTANT, 255);
  return framed;
}

}  // namespace

std::string qr_code_for_terminal(const std::string& text) {
  const cv::Mat framed = framed_code(text);
  const auto is_black = [&](int row, int column) {
    return row < framed.rows && framed.at<std::uint8_t>(row, column) == 0;
  };
  std::string picture;
  for (int row = 0; row < framed.rows; row += 2) {
    picture += kBlackOnWhite;
    for (int column = 0; column < framed.cols; ++column) {
      const std::size_t upper = is_black(row, column) ? 1 : 0;
      const std::size_t lower = is_black(row + 1, column) ? 2 : 0;
      picture += kBlocks.at(upper + lower);
    }
    picture += std::string(kReset) + '\n';
  }
  return picture;
}

std::string qr_code_svg(const std::string& text) {
  const cv::Mat framed = framed_code(text);
  if (framed.empty()) return {};
  std::string path;
  for (int row = 0; row < framed.rows; ++row) {
    for (int column = 0; column < framed.cols; ++column) {
      if (framed.at<std::uint8_t>(row, column) == 0)
        path += 'M' + std::to_string(column) + ' ' + std::to_string(row) + "h1v1h-1z";
    }
  }
  const std::string side = std::to_string(framed.rows);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + side + ' ' + side +
         "\" shape-rendering=\"crispEdges\"><path fill=\"#fff\" d=\"M0 0h" + side + 'v' + side +
         "H0z\"/><path d=\"" + path + "\"/></svg>";
}

}  // namespace pcavr
