// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/pipeline/calibrate_pictures.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "camera.hpp"
#include "errors.hpp"
#include "images.hpp"
#include "interruptible.hpp"
#include "threads.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr std::array kCameraFormats{
    std::pair{"pcavr", CameraFormat::pcavr}, std::pair{"ros", CameraFormat::ros},
    std::pair{"opencv", CameraFormat::opencv}, std::pair{"kalibr", CameraFormat::kalibr}};

/// A calibrated camera, and what was given.
struct CalibratedCamera {
  CameraCalibration found;
  Board board;
  std::string pictures;      ///< the folder; "arrays" for pictures in memory
  std::vector<int> numbers;  ///< of the picture of each of found.views
};

/// Pictures, as images or as a folder.
struct PictureArgument {
  std::string folder;  ///< empty: `images` has them
  std::vector<GrayImage> images;
};

PictureArgument pictures_of(const py::object& argument) {
  const bool is_path = py::isinstance<py::str>(argument) || py::isinstance<py::bytes>(argument) ||
                       py::hasattr(argument, "__fspath__");
  if (is_path) return {path_of(argument, "pictures").string(), {}};
  if (!py::isinstance<py::sequence>(argument) && !py::isinstance<py::array>(argument)) {
    throw py::type_error("pictures: a folder, or images of uint8, are expected");
  }
  PictureArgument pictures;
  for (const py::handle image : argument) {
    const std::string name = "pictures[" + std::to_string(pictures.images.size()) + ']';
    pictures.images.push_back(gray_image_of(image, name));
  }
  if (pictures.images.empty()) {
    raise_error({.message = "there are no pictures", .place = "pictures"});
  }
  return pictures;
}

std::vector<int> numbers_of_views(const CameraCalibration& found, const BoardViews& given) {
  std::vector<int> numbers;
  for (const CalibratedView& view : found.views) {
    const auto same = std::ranges::find(given.views, view.name, &BoardView::name);
    numbers.push_back(same->number);
  }
  return numbers;
}

Expected<CalibratedCamera> calibrate(const PictureArgument& pictures, const Board& board,
                                     const CameraCalibrationOptions& options,
                                     Parallelism parallelism) {
  const Expected<BoardViews> views = pictures.folder.empty()
                                         ? find_board_views(pictures.images, board, parallelism)
                                         : read_board_views(pictures.folder, board, parallelism);
  if (!views) return views.error();
  Expected<CameraCalibration> found = calibrate_camera(*views, board, options);
  if (!found) return found.error();
  std::vector<int> numbers = numbers_of_views(*found, *views);
  found->notes.insert(found->notes.end(), views->notes.begin(), views->notes.end());
  return CalibratedCamera{*std::move(found), board,
                          pictures.folder.empty() ? "arrays" : pictures.folder, std::move(numbers)};
}

CalibratedCamera calibrate_camera_of(const py::object& pictures, const std::string& board_text,
                                     const std::string& lens, bool k3, int threads) {
  const Board board = value_of(read_board(board_text));
  const CameraCalibrationOptions options{.lens = lens_of(lens), .with_k3 = k3};
  if (k3 && options.lens != LensModel::plumb_bob) {
    raise_error({.message = "is a coefficient of plumb_bob alone", .place = "k3"});
  }
  const Parallelism parallelism = parallelism_of(threads);
  const PictureArgument given = pictures_of(pictures);
  return run_interruptible(py::none(), [&](const Observer&) -> Expected<CalibratedCamera> {
    Expected<CalibratedCamera> found = calibrate(given, board, options, parallelism);
    if (found) return found;
    Error error = found.error();
    if (error.place == "PICTURES") error.place.clear();  // as the command names them
    if (error.file.empty()) error.file = given.folder;
    if (error.file.empty() && error.place.empty()) error.place = "pictures";
    return error;
  });
}

std::string text_of_camera(const CalibratedCamera& self, const std::string& format) {
  for (const auto& [name, known] : kCameraFormats) {
    if (format == name)
      return value_of(format_camera(self.found, self.pictures, self.board, known));
  }
  raise_error({.message = "'" + format + "' is not a format of camera files",
               .place = "format",
               .hint = "give pcavr, ros, opencv or kalibr"});
}

// Arrays

Numbers vector_array(const std::vector<double>& values) {
  return Numbers(static_cast<py::ssize_t>(values.size()), values.data());
}

Numbers covariance_of(const CalibratedCamera& self) {
  const Eigen::MatrixXd& covariance = self.found.covariance;
  Numbers array({covariance.rows(), covariance.cols()});
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      array.mutable_data(), covariance.rows(), covariance.cols()) = covariance;
  return array;
}

py::array_t<int> coverage_of(const CalibratedCamera& self) {
  py::array_t<int> array({kCoverageRows, kCoverageColumns});
  std::ranges::copy(self.found.coverage, array.mutable_data());
  return array;
}

Numbers board_poses(const CalibratedCamera& self) {
  std::vector<Pose> poses;
  for (const CalibratedView& view : self.found.views) poses.push_back(view.T_camera_board);
  return array_of(poses);
}

Numbers view_rms(const CalibratedCamera& self) {
  std::vector<double> values;
  for (const CalibratedView& view : self.found.views) values.push_back(view.rms);
  return vector_array(values);
}

std::vector<int> left_out_pictures(const CalibratedCamera& self) {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < self.numbers.size(); ++i) {
    if (self.found.views[i].is_outlier) numbers.push_back(self.numbers[i]);
  }
  return numbers;
}

/// A property of the calibration itself.
template <typename T>
auto of_found(T CameraCalibration::*member) {
  return [member](const CalibratedCamera& self) { return self.found.*member; };
}

void bind_calibrated_camera(py::module_& module) {
  py::class_<CalibratedCamera>(module, "CalibratedCamera", "Intrinsics of a camera.")
      .def_property_readonly("camera", of_found(&CameraCalibration::camera), "Camera.")
      .def_property_readonly(
          "stds", [](const CalibratedCamera& self) { return vector_array(self.found.stds); },
          "(4 + K,) of fx, fy, cx, cy [px] and the lens's coefficients; 0: not estimated.")
      .def_property_readonly("covariance", &covariance_of, "(4 + K, 4 + K) of the same.")
      .def_property_readonly("pixel_rms", of_found(&CameraCalibration::pixel_rms),
                             "[px] of the fitted points' distances from where they are expected.")
      .def_property_readonly("held_out_rms", of_found(&CameraCalibration::held_out_rms),
                             "[px] in views that were not fitted; None: too few views.")
      .def_property_readonly("noise", of_found(&CameraCalibration::noise),
                             "[px] std of a coordinate of a point.")
      .def_property_readonly("pixel_std", of_found(&CameraCalibration::pixel_std),
                             "[px] std of a point by the camera's parameters, where it is largest.")
      .def_property_readonly("coverage", &coverage_of,
                             "(6, 8) numbers of points in parts of the image, the top row first.")
      .def_property_readonly("covered", of_found(&CameraCalibration::covered),
                             "Share of these parts that have points.")
      .def_readonly("pictures", &CalibratedCamera::numbers,
                    "Numbers of the N pictures with the board: their indices, or those in the\n"
                    "files' names.")
      .def_property_readonly("poses", &board_poses,
                             "(N, 7) of the board in the camera in these pictures.")
      .def_property_readonly("view_rms", &view_rms, "(N,) [px] of the points in these pictures.")
      .def_property_readonly("outliers", &left_out_pictures, "Numbers of those that were left out.")
      .def_property_readonly(
          "missing_view",
          [](const CalibratedCamera& self) {
            return self.found.missing ? std::optional(self.found.missing->text) : std::nullopt;
          },
          "The further view that would reduce pixel_std most; None: none would.")
      .def_property_readonly("notes", of_found(&CameraCalibration::notes), "Lines for the user.")
      .def("text", &text_of_camera, py::arg("format") = "pcavr",
           R"(The text of a camera's file.

format  'pcavr', with standard deviations; 'ros' (camera_info), 'opencv' or 'kalibr', without

Raises Error for another format, and for a lens that Kalibr does not have.)");
}

}  // namespace

void bind_camera_calibration(py::module_& module) {
  bind_calibrated_camera(module);
  module.def("calibrate_camera", &calibrate_camera_of, py::arg("pictures"), py::arg("board"),
             py::kw_only(), py::arg("lens") = "plumb_bob", py::arg("k3") = false,
             py::arg("threads") = 0,
             R"(Finds a camera's intrinsics from pictures of a flat board, as `calibrate camera`.

pictures  (N, H, W) or (N, H, W, 3) uint8, or a sequence of such images, of one size; or a folder
board     such as 'chessboard:9x6:25mm', or a file of Kalibr's, as `--board`
lens      'plumb_bob', 'rational' (wide) or 'fisheye'
k3        True: k3 of plumb_bob is estimated, too
threads   0: all cores

Returns CalibratedCamera; its `poses` and `pictures` are what calibrate_hand_eye takes. Releases the
GIL. Raises Error where no picture shows the board, and where the views do not show the focal length;
TypeError for images of another dtype.)");
}

}  // namespace pcavr::python
