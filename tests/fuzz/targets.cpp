// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/targets.hpp"

#include <algorithm>
#include <string>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/png_codec.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "recordings/recording/camera_keys.hpp"
#include "recordings/recording/recording_text.hpp"

namespace pcavr::fuzz {
namespace {

constexpr char kFile[] = "the-file";
constexpr int kWidth = 16;
constexpr int kHeight = 12;

void expect_complete(const Error& error) {
  PCAVR_REQUIRE(error.file == kFile, error.to_string());
  PCAVR_REQUIRE(!error.message.empty() && !error.hint.empty(), error.to_string());
}

void expect_line(const Error& error) {
  expect_complete(error);
  PCAVR_REQUIRE(error.line > 0 || error.message == "is empty", error.to_string());
}

/// Strict errors have a line; in lenient mode only a wrong header is an error.
template <typename Content>
void parse_strict_and_lenient(Expected<Series<Content>> (*parse)(const SeriesText&),
                              std::string_view text) {
  const auto strict = parse({kFile, text, false});
  const auto lenient = parse({kFile, text, true});
  if (!strict) expect_line(strict.error());
  if (strict) {
    PCAVR_REQUIRE(lenient && lenient->report.skipped() == 0);
    PCAVR_REQUIRE(lenient->content.size() == strict->content.size());
  }
}

void trajectory_round_trip(std::string_view text) {
  parse_strict_and_lenient(parse_trajectory, text);
  const auto series = parse_trajectory({kFile, text, true});
  PCAVR_REQUIRE(series.has_value());
  const std::string written = format_trajectory(series->content);
  const auto reparsed = parse_trajectory({kFile, written});
  PCAVR_REQUIRE(reparsed && reparsed->content.size() == series->content.size());
}

PngImage png_with_rows(std::string_view bytes) {
  PngImage png{.width = kWidth, .height = kHeight};
  const auto kind = bytes.empty() ? 0u : static_cast<unsigned char>(bytes[0]);
  png.bit_depth = kind % 2 == 0 ? 8 : 16;
  png.channels = static_cast<int>(kind / 2 % 4) + 1;
  png.rows.assign(bytes.begin(), bytes.end());
  png.rows.resize((png.row_size() + 1) * kHeight);
  return png;
}

/// An accepted camera model projects each unprojected pixel back to itself.
void expect_invertible(const CameraModel& camera) {
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(right, -0.5), Eigen::Vector2d(-0.5, bottom),
        Eigen::Vector2d(right, bottom), Eigen::Vector2d(0.5 * right, 0.5 * bottom)}) {
    const Eigen::Vector2d reprojected = camera.project(camera.unproject(pixel, 2.0));
    // Rounding, at focal lengths up to 6.5 million pixels.
    PCAVR_REQUIRE((reprojected - pixel).norm() < 1e-5, reprojected.x(), reprojected.y(), pixel.x(),
                  pixel.y());
  }
}

}  // namespace

void manifest(std::string_view bytes) {
  const Expected<Manifest> manifest = parse_manifest(std::string(bytes), kFile);
  if (!manifest) return expect_line(manifest.error());
  const std::string written = format_manifest(*manifest);
  const Expected<Manifest> reparsed = parse_manifest(written, kFile);
  PCAVR_REQUIRE(reparsed.has_value(), reparsed.error().to_string(), written);
  PCAVR_REQUIRE(reparsed->markers.size() == manifest->markers.size());
  PCAVR_REQUIRE(reparsed->objects.size() == manifest->objects.size());
  PCAVR_REQUIRE(reparsed->camera == manifest->camera);
  if (manifest->camera) expect_invertible(*manifest->camera);
}

void camera_file(std::string_view bytes) {
  const Expected<CameraFile> camera = parse_camera_file(std::string(bytes), kFile);
  if (!camera) return expect_line(camera.error());
  PCAVR_REQUIRE(camera->camera.width > 0 && camera->camera.fx > 0.0);
  expect_invertible(camera->camera);
}

void image_list(std::string_view bytes) {
  parse_strict_and_lenient(parse_image_list, bytes);
  const auto list = parse_image_list({kFile, bytes, true});
  PCAVR_REQUIRE(list.has_value());
  for (const ListedImage& image : list->content) {
    PCAVR_REQUIRE(image.path.is_relative() && *image.path.begin() != "..", image.path);
  }
}

void series(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view text = bytes.substr(1);
  switch (bytes[0]) {
    case 'g':
      return trajectory_round_trip(text);
    case 't':
      return parse_strict_and_lenient(parse_tool, text);
    case 'w':
      return parse_strict_and_lenient(parse_wrench, text);
    case 'j':
      return parse_strict_and_lenient(parse_joints, text);
    default:
      return;
  }
}

void image(std::string_view bytes) {
  const ExpectedImage expected{kFile, kWidth, kHeight};
  ImageDecoder decoder;
  if (const auto color = decoder.color(bytes, expected); !color) expect_complete(color.error());
  if (const auto depth = decoder.raw_depth(bytes, expected); depth) {
    const auto reparsed = decoder.raw_depth(encode_depth(*depth), expected);
    PCAVR_REQUIRE(reparsed.has_value());
    PCAVR_REQUIRE(std::ranges::equal(reparsed->pixels(), depth->pixels()));
  } else {
    expect_complete(depth.error());
  }
  PngImage plain;
  if (!decode_png(encode_png(png_with_rows(bytes)), plain)) return;
  PngImage decoded;
  PCAVR_REQUIRE(decode_png(encode_png(plain), decoded).has_value());
  PCAVR_REQUIRE(decoded.rows == plain.rows);
}

void parameters(std::string_view bytes) {
  const Expected<ParameterTable> table = parse_parameters(std::string(bytes), kFile);
  if (!table) return expect_line(table.error());
  const std::string written = format_parameters(*table);
  const Expected<ParameterTable> reparsed = parse_parameters(written, kFile);
  PCAVR_REQUIRE(reparsed.has_value(), reparsed.error().to_string(), written);
  PCAVR_REQUIRE(format_parameters(*reparsed) == written);
}

}  // namespace pcavr::fuzz
