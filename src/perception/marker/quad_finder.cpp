// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/quad_finder.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include <opencv2/aruco.hpp>

#include "pcavr/perception/marker/tag_sheet.hpp"

#include "perception/marker/bit_reader.hpp"
#include "perception/marker/tag_family.hpp"

namespace pcavr {
namespace {

struct DetectorDeleter {
  void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
};
struct DetectionsDeleter {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

/// Corners of libapriltag's ideal tag in its own frame (x right, y down) that are our
/// (-,-) (+,-) (+,+) (-,+): the half turn about x between the two frames, seen in the plane.
constexpr double kHalfTurnAboutX[4][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};

/// Pixel coordinates start at the first pixel's outer edge in libapriltag, at its centre in pcavr.
constexpr double kAprilTagPixelOffset = 0.5;

Eigen::Vector2d project(const matd_t& homography, const double (&point)[2]) {
  const auto row = [&](int i) {
    const double* h = homography.data + 3 * i;
    return h[0] * point[0] + h[1] * point[1] + h[2];
  };
  return {row(0) / row(2), row(1) / row(2)};
}

/// Throws std::bad_alloc if libapriltag would run out of memory: it does not check the result of
/// malloc and would dereference a null pointer.
void require_memory_for(const Region& region) {
  // [byte] Union-find of pixels, their clusters and the lines fitted to them; and a constant per
  // image. Estimates, not measurements.
  constexpr std::size_t kPerPixel = 200;
  constexpr std::size_t kPerImage = std::size_t{16} << 20U;
  const std::size_t pixels =
      static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height());
  // The memory is not touched, so no physical memory is used.
  ::operator delete(::operator new(kPerImage + kPerPixel * pixels));
}

class AprilTagFinder final : public QuadFinder {
 public:
  AprilTagFinder(std::vector<AprilTagFamily> families, const TagDetectorOptions& options)
      : options_(options), families_(std::move(families)), detector_(apriltag_detector_create()) {
    // Its results depend on the number of threads, which divide the image into tiles.
    detector_->nthreads = 1;
    detector_->quad_decimate = static_cast<float>(options.decimation);
    detector_->refine_edges = true;
    for (const AprilTagFamily& family : families_) {
      apriltag_detector_add_family_bits(detector_.get(), family.get(), options.max_hamming);
    }
  }

  std::vector<TagDetection> find(const GrayImage& image, const Region& region) override {
    require_memory_for(region);
    // The library takes a non-const pointer but does not write to the image.
    auto* pixels = const_cast<std::uint8_t*>(&image(region.left, region.top));
    image_u8_t view{region.width(), region.height(), image.width(), pixels};
    const std::unique_ptr<zarray_t, DetectionsDeleter> found(
        apriltag_detector_detect(detector_.get(), &view));
    std::vector<TagDetection> detections;
    for (int i = 0; i < zarray_size(found.get()); ++i) {
      apriltag_detection_t* one = nullptr;
      zarray_get(found.get(), i, &one);
      TagDetection detection;
      detection.id = {one->family->name, one->id};
      detection.hamming = one->hamming;
      detection.decision_margin = static_cast<double>(one->decision_margin);
      const Eigen::Vector2d origin(region.left - kAprilTagPixelOffset,
                                   region.top - kAprilTagPixelOffset);
      for (std::size_t k = 0; k < 4; ++k) {
        detection.corners[k] = project(*one->H, kHalfTurnAboutX[k]) + origin;
      }
      detections.push_back(std::move(detection));
    }
    return detections;
  }

 private:
  TagDetectorOptions options_;
  std::vector<AprilTagFamily> families_;  // before the detector, which refers to them
  std::unique_ptr<apriltag_detector_t, DetectorDeleter> detector_;
};

class ArucoFinder final : public QuadFinder {
 public:
  ArucoFinder(std::string family, int number)
      : family_(std::move(family)),
        dictionary_(cv::aruco::Dictionary::get(number)),
        parameters_(cv::aruco::DetectorParameters::create()) {
    // The default lets the contour of paper cut one cell from the tag replace the tag's own: they
    // are 1.4 cells apart, of a perimeter of some 32.
    parameters_->minMarkerDistanceRate = 0.02;
  }

  std::vector<TagDetection> find(const GrayImage& image, const Region& region) override {
    auto* pixels = const_cast<std::uint8_t*>(&image(region.left, region.top));
    const cv::Mat view(region.height(), region.width(), CV_8UC1, pixels,
                       static_cast<std::size_t>(image.width()));
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    try {
      cv::aruco::detectMarkers(view, dictionary_, corners, ids, parameters_);
    } catch (const cv::Exception&) {
      return {};  // OpenCV rejects some regions, such as very small ones
    }
    std::vector<TagDetection> detections;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      TagDetection detection;
      detection.id = {family_, ids[i]};
      for (std::size_t k = 0; k < 4; ++k) {
        // OpenCV's order is clockwise from top left; ours is counter-clockwise from bottom left.
        const cv::Point2f& corner = corners[i][3 - k];
        detection.corners[k] = {static_cast<double>(corner.x) + region.left,
                                static_cast<double>(corner.y) + region.top};
      }
      detections.push_back(std::move(detection));
    }
    return detections;
  }

  void score(const GrayImage& image, TagDetection& detection) const override {
    const Expected<TagPicture> picture = tag_picture(family_, detection.id.id);
    const BitReading reading = read_bits(image, *picture, detection.corners);
    detection.hamming = reading.wrong_bits;
    detection.decision_margin = reading.margin;
  }

 private:
  std::string family_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

}  // namespace

Expected<std::vector<std::unique_ptr<QuadFinder>>> make_quad_finders(
    const std::vector<std::string>& families, const TagDetectorOptions& options) {
  std::vector<std::unique_ptr<QuadFinder>> finders;
  std::vector<AprilTagFamily> apriltags;
  std::vector<std::string> names = families;
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (const std::string& name : names) {
    if (auto family = make_apriltag_family(name)) {
      apriltags.push_back(std::move(*family));
    } else if (const auto number = aruco_dictionary_number(name)) {
      finders.push_back(std::make_unique<ArucoFinder>(name, *number));
    } else {
      return unknown_family(name);
    }
  }
  if (!apriltags.empty()) {
    finders.push_back(std::make_unique<AprilTagFinder>(std::move(apriltags), options));
  }
  return finders;
}

}  // namespace pcavr
