// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2_camera.hpp"

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/recording/manifest_template.hpp"

namespace pcavr {
namespace {

struct TaggedObject {
  std::size_t object = 0;  ///< in the world
  std::vector<TagPlacement> placements;
  std::optional<Pose> T_camera_object = {};  ///< in the last image
};

struct ReceivedPicture {
  std::size_t topic = 0;
  std::vector<std::uint8_t> bytes;
  double arrival = 0.0;  ///< [s]
};

/// Mean standard deviation of three axes.
double axis_std(const Matrix6d& covariance, int first) {
  return std::sqrt(covariance.diagonal().segment<3>(first).mean());
}

class TagTracker final : public Ros2CameraTracker {
 public:
  TagTracker(const Ros2Camera& camera, std::vector<TagPlacement> base,
             std::vector<TaggedObject> objects, TagDetector detector, Ros2Intake& intake,
             RecordQueue& samples)
      : frame_(camera.frame),
        // image_proc names its topics so, and the import of bags does the same.
        is_rectified_(camera.image.name.find("rect") != std::string::npos),
        base_(std::move(base)),
        objects_(std::move(objects)),
        detector_(std::move(detector)),
        intake_(intake),
        samples_(samples),
        thread_([this] { run(); }) {}
  TagTracker(const TagTracker&) = delete;
  TagTracker& operator=(const TagTracker&) = delete;
  ~TagTracker() override {
    {
      const std::lock_guard lock(mutex_);
      is_stopped_ = true;
    }
    arrived_.notify_all();
    thread_.join();
  }

  void on_message(std::size_t topic, bool is_image, std::span<const std::uint8_t> message,
                  double now) override {
    {
      const std::lock_guard lock(mutex_);
      std::optional<ReceivedPicture>& slot = is_image ? image_ : info_;
      slot = ReceivedPicture{topic, {message.begin(), message.end()}, now};
    }
    arrived_.notify_all();
  }

  [[nodiscard]] std::optional<CameraPicture> take_picture() override {
    const std::lock_guard lock(picture_mutex_);
    return std::exchange(picture_, std::nullopt);
  }

 private:
  void run() {
    for (;;) {
      std::optional<ReceivedPicture> image;
      std::optional<ReceivedPicture> info;
      {
        std::unique_lock lock(mutex_);
        arrived_.wait(lock, [this] { return is_stopped_ || image_ || info_; });
        if (is_stopped_) return;
        image = std::exchange(image_, std::nullopt);
        info = std::exchange(info_, std::nullopt);
      }
      // Messages of peers may be beyond what the methods accept: that must not end the site.
      try {
        if (info) take_info(*info);
        if (image) take_image(*image);
      } catch (const std::exception& error) {
        const ReceivedPicture& picture = image ? *image : *info;
        intake_.note(picture.topic, std::string(error.what()) + ": ignored", picture.arrival);
      }
    }
  }

  /// An Error has been noted.
  [[nodiscard]] std::optional<RosMessage> decode(const ReceivedPicture& picture) {
    const Ros2Topic& topic = intake_.topic(picture.topic);
    Expected<RosMessage> message = decode_ros_message({.name = topic.name,
                                                       .type = topic.type,
                                                       .encoding = "cdr",
                                                       .schema_encoding = {},
                                                       .schema = {}},
                                                      picture.bytes);
    if (message) return std::move(*message);
    intake_.note(picture.topic, message.error().message + ": ignored", picture.arrival);
    return std::nullopt;
  }

  void take_info(const ReceivedPicture& picture) {
    const std::optional<RosMessage> message = decode(picture);
    if (!message) return;
    const Expected<CameraModel> camera =
        camera_of(std::get<RosCameraInfo>(*message), is_rectified_);
    if (camera) {
      camera_ = *camera;
    } else {
      intake_.note(picture.topic, camera.error().message + ": ignored", picture.arrival);
    }
  }

  void take_image(const ReceivedPicture& picture) {
    const std::optional<RosMessage> message = decode(picture);
    if (!message) return;
    const auto fail = [&](const std::string& why) {
      intake_.note(picture.topic, why + ": ignored", picture.arrival);
    };
    if (!camera_) return fail("no camera info yet");
    Expected<ColorImage> color = decode_color(*message, camera_->width, camera_->height);
    if (!color) return fail(color.error().message);
    const RosHeader& header = std::holds_alternative<RosImage>(*message)
                                  ? std::get<RosImage>(*message).header
                                  : std::get<RosCompressedImage>(*message).header;
    const std::vector<TagDetection> detections = detector_.detect(to_gray(*color));
    const double t = intake_.local_time(picture.topic, header.stamp, picture.arrival);
    {
      const std::lock_guard lock(picture_mutex_);
      picture_ = CameraPicture{t, std::move(*color), camera_};
    }
    const std::optional<Pose> T_base_camera = locate(header, detections);
    if (!T_base_camera) return fail("neither base markers nor transforms show where it is");
    for (TaggedObject& object : objects_) track(object, detections, *T_base_camera, t);
  }

  [[nodiscard]] std::optional<Pose> locate(const RosHeader& header,
                                           const std::vector<TagDetection>& detections) {
    if (!base_.empty()) {
      const BodyPose base =
          solve_body_pose(base_, detections, *camera_, {.T_camera_body = T_camera_base_});
      T_camera_base_.reset();
      if (base.status == BodyPoseStatus::solved) {
        T_camera_base_ = base.pose.T_camera_body;
        return T_camera_base_->inverse();
      }
    }
    const std::string& frame = frame_.empty() ? header.frame : frame_;
    if (frame.empty()) return std::nullopt;
    return intake_.lookup(frame, header.stamp);
  }

  void track(TaggedObject& object, const std::vector<TagDetection>& detections,
             const Pose& T_base_camera, double t) {
    const BodyPose found = solve_body_pose(object.placements, detections, *camera_,
                                           {.T_camera_body = object.T_camera_object});
    object.T_camera_object.reset();
    if (found.status != BodyPoseStatus::solved) return;
    object.T_camera_object = found.pose.T_camera_body;
    const Pose T_base_object = T_base_camera * found.pose.T_camera_body;
    const Eigen::Vector3d& p = T_base_object.translation();
    const Eigen::Quaterniond& q = T_base_object.rotation();
    const Ros2Sample sample{.kind = Ros2Sample::Kind::tracked,
                            .object = object.object,
                            .t = t,
                            .values = {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()},
                            .std = {axis_std(found.covariance, 0), axis_std(found.covariance, 3)}};
    samples_.push({reinterpret_cast<const std::uint8_t*>(&sample), sizeof(sample)}, {});
  }

  const std::string frame_;
  const bool is_rectified_;
  const std::vector<TagPlacement> base_;
  std::vector<TaggedObject> objects_;
  TagDetector detector_;
  Ros2Intake& intake_;
  RecordQueue& samples_;
  std::optional<CameraModel> camera_;
  std::optional<Pose> T_camera_base_;  ///< in the last image

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::optional<ReceivedPicture> image_;
  std::optional<ReceivedPicture> info_;
  bool is_stopped_ = false;
  std::mutex picture_mutex_;
  std::optional<CameraPicture> picture_;  ///< the newest that was not taken
  std::thread thread_;                    ///< last: it uses the others
};

}  // namespace

Expected<std::unique_ptr<Ros2CameraTracker>> make_ros2_camera(const Ros2Camera& camera,
                                                              const TeleopInput& world,
                                                              Ros2Intake& intake,
                                                              RecordQueue& samples) {
  const Expected<Manifest> manifest = read_manifest_template(camera.tags);
  if (!manifest) return manifest.error();
  std::vector<TaggedObject> objects;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    TaggedObject object{i, object_placements(*manifest, world.objects[i].name)};
    if (!object.placements.empty()) objects.push_back(std::move(object));
  }
  if (objects.empty()) {
    return Error{.message = "has no marker on an object of the scene",
                 .file = camera.tags.string(),
                 .hint = "name a recording.yaml with the objects' markers"};
  }
  std::set<std::string> families;
  for (const MarkerEntry& marker : manifest->markers) families.insert(marker.id.family);
  Expected<TagDetector> detector = TagDetector::create({families.begin(), families.end()});
  if (!detector) return detector.error();
  return std::unique_ptr<Ros2CameraTracker>(
      std::make_unique<TagTracker>(camera, base_placements(*manifest), std::move(objects),
                                   std::move(*detector), intake, samples));
}

}  // namespace pcavr
