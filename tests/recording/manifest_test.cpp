// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/manifest.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"

#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

const std::string kFull =
    "format: pcavr-recording/1\n"                                                       // 1
    "camera: {width: 640, height: 480, fx: 525, fy: 524, cx: 319.5, cy: 239.5,\n"       // 2
    "  distortion: [0.1, -0.2, 0.001, 0.002, 0.05], depth_scale: 5000}\n"               // 3
    "objects:\n"                                                                        // 4
    "  - {name: box, mesh: objects/box.obj, mass: 3.0, movable: true}\n"                // 5
    "markers:\n"                                                                        // 6
    "  - {family: tag36h11, id: 0, size: 0.16, role: base,\n"                           // 7
    "     pose: {t: [0.55, 0.3, 0], q: [0, 0, 0, 1]}}\n"                                // 8
    "  - {family: tag36h11, id: 5, size: 0.08, role: object, object: box,\n"            // 9
    "     pose: {t: [0, 0, 0.0625], q: [0.5, 0.5, 0.5, 0.5]}}\n"                        // 10
    "tool: {radius: 0.01}\n"                                                            // 11
    "robot: {urdf: robot.urdf, pose: {t: [0.1, 0, 0], q: [0, 0, 0, 1]}, tip: hand}\n";  // 12

/// The full manifest with one text replaced by another.
std::string full_with(const std::string& from, const std::string& to) {
  std::string text = kFull;
  const std::size_t begin = text.find(from);
  EXPECT_NE(begin, text.npos) << from;
  return text.replace(begin, from.size(), to);
}

TEST(Manifest, ContainsEveryKeyOfTheFile) {
  const Expected<Manifest> manifest = parse_manifest(kFull, "m.yaml");
  ASSERT_TRUE(manifest.has_value()) << manifest.error().to_string();
  EXPECT_EQ(manifest->camera->width, 640);
  EXPECT_EQ(manifest->camera->fy, 524.0);
  EXPECT_EQ(manifest->camera->distortion.coefficients()[4], 0.05);
  EXPECT_EQ(manifest->depth_scale, 5000.0);
  ASSERT_EQ(manifest->markers.size(), 2u);
  EXPECT_EQ(manifest->markers[0].role, MarkerRole::base);
  EXPECT_EQ(manifest->markers[0].T_parent_marker.translation().x(), 0.55);
  EXPECT_EQ(manifest->markers[1].object, "box");
  EXPECT_EQ(manifest->markers[1].id.to_string(), "tag36h11:5");
  EXPECT_EQ(manifest->markers[1].T_parent_marker.rotation().w(), 0.5);
  ASSERT_EQ(manifest->objects.size(), 1u);
  EXPECT_EQ(manifest->objects[0].mesh, "objects/box.obj");
  EXPECT_EQ(manifest->objects[0].mass, 3.0);
  EXPECT_TRUE(manifest->objects[0].is_movable);
  EXPECT_EQ(manifest->tool_radius, 0.01);
  ASSERT_TRUE(manifest->robot.has_value());
  EXPECT_EQ(manifest->robot->urdf, "robot.urdf");
  EXPECT_EQ(manifest->robot->T_base_robot.translation().x(), 0.1);
  EXPECT_EQ(manifest->robot->tip, "hand");
}

TEST(Manifest, HasTheMaterialsOfObjectsAndTool) {
  const std::string tool =
      "tool: {radius: 0.01, material: {youngs_modulus: 7e10, poisson_ratio: 0.33}}\n";
  const auto with = [&](const std::string& material) {
    return parse_manifest("format: pcavr-recording/1\nobjects:\n  - {name: box, material: {" +
                              material + "}}\n" + tool,
                          "m.yaml");
  };
  const auto manifest = with("youngs_modulus: 2.8e9, poisson_ratio: 0.38, radius: 0.05");
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_EQ(manifest->objects[0].material->youngs_modulus, 2.8e9);
  EXPECT_EQ(manifest->objects[0].material->radius, 0.05);
  EXPECT_EQ(manifest->tool_material->poisson_ratio, 0.33);
  const auto again = parse_manifest(format_manifest(*manifest), "m.yaml");
  ASSERT_TRUE(again) << again.error().to_string();
  EXPECT_EQ(again->objects[0].material->poisson_ratio, 0.38);
  EXPECT_EQ(again->tool_material->youngs_modulus, 7e10);
  for (const char* bad :
       {"youngs_modulus: 2.8, poisson_ratio: 0.38", "youngs_modulus: 2.8e9, poisson_ratio: 0.6",
        "youngs_modulus: -1e9, poisson_ratio: 0.3"}) {
    const auto refused = with(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().line, 3) << refused.error().to_string();
  }
  EXPECT_FALSE(
      parse_manifest("format: pcavr-recording/1\nobjects:\n  - {name: box, material: "
                     "{youngs_modulus: 1e9, poisson_ratio: 0.3}}\n",
                     "m.yaml"));
}

TEST(Manifest, StatesTheUnitOfAMesh) {
  const auto with = [](const std::string& unit) {
    return parse_manifest(
        "format: pcavr-recording/1\nobjects:\n  - {name: box, mesh: box.obj" + unit + "}\n",
        "m.yaml");
  };
  EXPECT_EQ(with("")->objects[0].mesh_unit, 1.0);
  for (const auto& [unit, metres] :
       std::map<std::string, double>{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}}) {
    const auto manifest = with(", unit: " + unit);
    ASSERT_TRUE(manifest) << manifest.error().to_string();
    EXPECT_EQ(manifest->objects[0].mesh_unit, metres);
    EXPECT_EQ(parse_manifest(format_manifest(*manifest), "m.yaml")->objects[0].mesh_unit, metres);
  }
  const auto refused = with(", unit: feet");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().hint, "write m, cm, mm, in, or a number of metres");
  EXPECT_EQ(with(", unit: 0.00102")->objects[0].mesh_unit, 0.00102);
  EXPECT_FALSE(with(", unit: 0"));
}

TEST(Manifest, StatesTheDepthsOffsetAndWhereAMeshIsInTheTrackersFrame) {
  const auto manifest = parse_manifest(
      full_with("depth_scale: 5000", "depth_scale: 5000, depth_offset: -0.0125"), "m.yaml");
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_EQ(manifest->depth_offset, -0.0125);
  EXPECT_EQ(parse_manifest(format_manifest(*manifest), "m.yaml")->depth_offset, -0.0125);
  const auto tracked = parse_manifest(
      full_with("movable: true",
                "movable: true, tracked_to_object: {t: [0.01, 0, 0.02], q: [0, 0, 1, 0]}"),
      "m.yaml");
  ASSERT_TRUE(tracked) << tracked.error().to_string();
  const auto again = parse_manifest(format_manifest(*tracked), "m.yaml");
  ASSERT_TRUE(again) << again.error().to_string();
  EXPECT_EQ(again->objects[0].T_tracked_object.translation().z(), 0.02);
  EXPECT_EQ(again->objects[0].T_tracked_object.rotation().z(), 1.0);
  EXPECT_FALSE(parse_manifest(full_with("depth_scale: 5000", "depth_scale: 5000, depth_offset: 3"),
                              "m.yaml"));
}

class CalibratedManifest : public testing::Test {
 protected:
  static constexpr char kTags[] =
      "format: pcavr-calibration/1\nkind: tags\nmarkers:\n"
      "  - {family: tag36h11, id: 0, size: 0.15, role: base,\n"
      "     pose: {t: [0.5, 0.3, 0], q: [0, 0, 0, 1]}}\n"
      "accuracy:\n  - tag: tag36h11:0\n    covariance:\n";

  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_.path() / name; }
  Expected<Manifest> with(const std::string& calibration) const {
    for (const char* name : {"robot.urdf", "box.obj"}) EXPECT_TRUE(write_file(file(name), "x"));
    return parse_manifest(full_with("objects/box.obj", "box.obj") + "calibration: " + calibration,
                          "m.yaml", folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(CalibratedManifest, TakesWhatEachCalibrationFound) {
  std::string tags = kTags;
  for (int row = 0; row < 6; ++row) {
    tags += "      - [";
    for (int column = 0; column < 6; ++column) {
      tags += std::string(column > 0 ? ", " : "") + (row == column ? "4e-6" : "0");
    }
    tags += "]\n";
  }
  ASSERT_TRUE(write_file(file("tags.yaml"), tags));
  ASSERT_TRUE(write_file(file("depth.yaml"),
                         "format: pcavr-calibration/1\nkind: depth\ndepth_scale: 4900\n"
                         "depth_offset: 0.004\n"));
  ASSERT_TRUE(write_file(file("objects.yaml"),
                         "format: pcavr-calibration/1\nkind: objects\nobjects:\n  - name: box\n"
                         "    tracked_to_object: {t: [0, 0.1, 0], q: [0, 0, 0, 1]}\n"
                         "    unit: 0.00101\n"));
  const auto manifest = with("[tags.yaml, depth.yaml, objects.yaml]\n");
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_EQ(manifest->depth_scale, 4900.0);
  EXPECT_EQ(manifest->depth_offset, 0.004);
  EXPECT_EQ(manifest->objects[0].mesh_unit, 0.00101);
  EXPECT_EQ(manifest->objects[0].T_tracked_object.translation().y(), 0.1);
  ASSERT_EQ(manifest->markers.size(), 2U);
  const MarkerEntry& tag = manifest->markers.back();
  EXPECT_EQ(tag.size, 0.15);
  EXPECT_TRUE(tag.covariance.isApprox(4e-6 * Matrix6d::Identity()));
  EXPECT_TRUE(manifest->markers.front().covariance.isZero());
}

TEST_F(CalibratedManifest, RoundTripKeepsWhatCalibrationsFound) {
  Matrix6d by = Matrix6d::Identity();  // of a covariance without zeros
  for (Eigen::Index i = 0; i < 36; ++i) by(i / 6, i % 6) += 0.1 * std::sin(static_cast<double>(i));
  const Matrix6d covariance = 1e-6 * by * by.transpose();
  std::string tags = kTags;
  for (Eigen::Index row = 0; row < 6; ++row) {
    tags += "      - [";
    for (Eigen::Index column = 0; column < 6; ++column) {
      tags += (column > 0 ? ", " : "") + shortest_decimal(covariance(row, column));
    }
    tags += "]\n";
  }
  ASSERT_TRUE(write_file(file("tags.yaml"), tags));
  ASSERT_TRUE(write_file(file("force.yaml"),
                         "format: pcavr-calibration/1\nkind: force\n"
                         "rotation_std: [0.002, 0.0071, 0.004]\n"));
  ASSERT_TRUE(write_file(file("depth.yaml"),
                         "format: pcavr-calibration/1\nkind: depth\ndepth_scale: 4900\n"
                         "depth_offset: 0.004\n"));
  const auto manifest = with("[tags.yaml, force.yaml, depth.yaml]\n");
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  const std::string text = format_manifest(*manifest);
  const auto again = parse_manifest(text, "m.yaml");
  ASSERT_TRUE(again) << again.error().to_string() << text;
  EXPECT_EQ(again->force_direction_std, 0.0071);
  EXPECT_EQ(again->depth_scale, 4900.0);
  EXPECT_EQ(again->depth_offset, 0.004);
  ASSERT_EQ(again->markers.size(), 2U);
  EXPECT_FALSE(again->markers.back().covariance.isZero());
  EXPECT_EQ(again->markers.back().covariance, manifest->markers.back().covariance);
  EXPECT_TRUE(again->markers.front().covariance.isZero());
  EXPECT_EQ(format_manifest(*again), text);
}

TEST(Manifest, RefusesCovariancesThatAreNone) {
  const auto with = [](const std::string& rows) {
    return parse_manifest(full_with("role: base", "role: base, covariance: " + rows), "m.yaml");
  };
  EXPECT_NE(with("[[1, 0, 0, 0, 0, 0]]").error().to_string().find("six rows"), std::string::npos);
  EXPECT_FALSE(
      parse_manifest("format: pcavr-recording/1\nwrench: {direction_std: -1}\n", "m.yaml"));
  EXPECT_FALSE(parse_manifest("format: pcavr-recording/1\nwrench: {}\n", "m.yaml"));
}

TEST_F(CalibratedManifest, NamesWhatIsWrongWithACalibration) {
  const auto refused = [&](const std::string& text) {
    EXPECT_TRUE(write_file(file("c.yaml"), text));
    const auto manifest = with("c.yaml\n");
    return manifest ? std::string() : manifest.error().to_string();
  };
  EXPECT_NE(refused(std::string(kTags) + "      - [-1, 0, 0, 0, 0, 0]\n").find("six rows"),
            std::string::npos);
  EXPECT_NE(refused("format: pcavr-calibration/1\nkind: touch\n").find("is 'touch'"),
            std::string::npos);
  EXPECT_NE(refused("format: pcavr-calibration/1\nkind: objects\nobjects:\n  - name: ball\n")
                .find("'ball' is not declared"),
            std::string::npos);
  EXPECT_NE(
      refused("format: pcavr-calibration/1\nkind: depth\ndepth_scale: 0\n").find("depth scale"),
      std::string::npos);
}

TEST(Manifest, NeedsNoMoreThanItsFormat) {
  const Expected<Manifest> manifest = parse_manifest("format: pcavr-recording/1\n", "m.yaml");
  ASSERT_TRUE(manifest.has_value());
  EXPECT_FALSE(manifest->camera.has_value());
}

TEST(Manifest, RoundTripIsLossless) {
  const Expected<Manifest> manifest = parse_manifest(kFull, "m.yaml");
  ASSERT_TRUE(manifest.has_value());
  const std::string text = format_manifest(*manifest);
  const Expected<Manifest> again = parse_manifest(text, "m.yaml");
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  EXPECT_EQ(format_manifest(*again), text);
  EXPECT_EQ(*again->camera, *manifest->camera);
  EXPECT_EQ(again->markers[1].T_parent_marker.matrix(),
            manifest->markers[1].T_parent_marker.matrix());
}

TEST(Manifest, OfEachLensModelRoundTripIsLossless) {
  for (const char* lens : {"model: plumb_bob, distortion: [0.1, -0.2, 0.001, 0.002, 0.05]",
                           "model: rational, distortion: [0.5285, -2.68, 0.0005, -0.0002, 1.51, "
                           "0.4095, -2.5, 1.44]",
                           "model: fisheye, distortion: [-0.0117, 0.0301, -0.0274, 0.0079]",
                           "model: fisheye, distortion: [0, 0, 0, 0]"}) {
    const Expected<Manifest> manifest =
        parse_manifest(full_with("distortion: [0.1, -0.2, 0.001, 0.002, 0.05]", lens), "m.yaml");
    ASSERT_TRUE(manifest.has_value()) << manifest.error().to_string();
    EXPECT_TRUE(manifest->camera->has_distortion());
    const Expected<Manifest> again = parse_manifest(format_manifest(*manifest), "m.yaml");
    ASSERT_TRUE(again.has_value()) << again.error().to_string();
    EXPECT_EQ(*again->camera, *manifest->camera);
  }
}

TEST(Manifest, ReportsWhereALensFoldsAndWhatToWrite) {
  const Expected<Manifest> manifest = parse_manifest(
      full_with("[0.1, -0.2, 0.001, 0.002, 0.05]", "[0.5285, -2.68, 0.0005, -0.0002, 1.51]"),
      "m.yaml");
  ASSERT_FALSE(manifest.has_value());
  EXPECT_EQ(manifest.error().place, "camera.distortion");
  EXPECT_NE(manifest.error().message.find("pixel ("), std::string::npos);
  EXPECT_NE(manifest.error().hint.find("model: rational"), std::string::npos);
}

TEST(Manifest, WritesTheShortestDecimals) {
  const Expected<Manifest> manifest = parse_manifest(kFull, "m.yaml");
  ASSERT_TRUE(manifest.has_value());
  EXPECT_NE(format_manifest(*manifest).find("size: 0.16\n"), std::string::npos);
}

struct Fault {
  const char* name;
  const char* from;  ///< in the full manifest
  const char* to;
  int line;
  const char* message;  ///< a part of it
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class ManifestFault : public testing::TestWithParam<Fault> {};

TEST_P(ManifestFault, IsReportedWithItsLineAndAHint) {
  const Fault& fault = GetParam();
  const Expected<Manifest> manifest = parse_manifest(full_with(fault.from, fault.to), "m.yaml");
  ASSERT_FALSE(manifest.has_value());
  EXPECT_EQ(manifest.error().file, "m.yaml");
  EXPECT_EQ(manifest.error().line, fault.line) << manifest.error().to_string();
  EXPECT_NE(manifest.error().message.find(fault.message), std::string::npos)
      << manifest.error().to_string();
  EXPECT_FALSE(manifest.error().hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Each, ManifestFault,
    testing::Values(
        Fault{"OtherFormat", "recording/1", "recording/2", 1, "pcavr-recording/2"},
        Fault{"NoFormat", "format: pcavr-recording/1\n", "", 1, "'format' is missing"},
        Fault{"UnknownKey", "tool: {radius", "tool: {radios", 11, "unknown key 'radios'"},
        Fault{"UnknownRootKey", "robot:", "robots:", 12, "unknown key 'robots'"},
        Fault{"KeyTwice", "id: 5,", "id: 5, id: 6,", 9, "twice"},
        Fault{"SizeZero", "size: 0.16", "size: 0", 7, "0 is out of range for a tag's size"},
        Fault{"SizeNotFinite", "size: 0.16", "size: .inf", 7, "not a finite number"},
        Fault{"IdNegative", "id: 5", "id: -5", 9, "is not an integer"},
        Fault{"SameTagTwice", "id: 5", "id: 0", 9, "tag36h11:0 is listed twice"},
        Fault{"UndeclaredObject", "object: box", "object: cup", 9, "'cup' is not declared"},
        Fault{"ObjectMarkerWithoutObject", ", object: box", "", 9, "'object' is missing"},
        Fault{"BaseMarkerWithObject", "role: base", "role: base, object: box", 7, "base marker"},
        Fault{"UnknownRole", "role: base", "role: wall", 7, "wall"},
        Fault{"QuaternionOfNormZero", "q: [0, 0, 0, 1]", "q: [0, 0, 0, 0]", 8, "norm"},
        Fault{"QuaternionTooShort", "q: [0, 0, 0, 1]", "q: [0, 0, 1]", 8, "3 numbers, not 4"},
        Fault{"TextForANumber", "fx: 525", "fx: wide", 2, "'wide' is not a finite number"},
        Fault{"FocalLengthOfAlmostNothing", "fx: 525", "fx: 1e-300", 2, "focal length of 1e-300"},
        Fault{"FocalLengthInMillimetres", "fx: 525", "fx: 4.2", 2, "focal length of 4.2"},
        Fault{"FocalLengthOfATelescope", "fy: 524", "fy: 1e9", 2, "focal length of 1e+09"},
        Fault{"PixelsNotSquare", "fy: 524", "fy: 200", 2, "nearly square"},
        Fault{"PrincipalPointFarAway", "cx: 319.5", "cx: 1e12", 2, "too far from a 640 x 480"},
        Fault{"PrincipalPointFarBelow", "cy: 239.5", "cy: -481", 2, "too far from a 640 x 480"},
        Fault{"LensFolds", "[0.1, -0.2, 0.001, 0.002, 0.05]", "[-1, 0, 0, 0, 0]", 3, "folds"},
        Fault{"LensIsHalfARationalOne", "[0.1, -0.2, 0.001, 0.002, 0.05]",
              "[0.5285, -2.68, 0.0005, -0.0002, 1.51]", 3, "folds"},
        Fault{"LensOfHugeNumbers", "[0.1, -0.2, 0.001, 0.002, 0.05]", "[1e300, 0, 0, 0, -1e300]", 3,
              "folds"},
        Fault{"UnknownLens", "distortion:", "model: wide, distortion:", 3, "is 'wide'"},
        Fault{"TooFewForARationalLens", "distortion:", "model: rational, distortion:", 3,
              "5 numbers; a rational lens has 8"},
        Fault{"FisheyeWithoutNumbers", "distortion: [0.1, -0.2, 0.001, 0.002, 0.05]",
              "model: fisheye", 3, "distortion is missing"},
        Fault{"FisheyeFolds", "distortion: [0.1, -0.2, 0.001, 0.002, 0.05]",
              "model: fisheye, distortion: [0, 0, 0, -0.5]", 3, "folds"},
        Fault{"WidthZero", "width: 640", "width: 0", 2, "is not an integer"},
        Fault{"NoDepthScale", ", depth_scale: 5000", "", 2, "'depth_scale' is missing"},
        Fault{"DistortionTooLong", "0.05]", "0.05, 0]", 3, "6 numbers; a plumb_bob lens has 5"},
        Fault{"MeshOutside", "objects/box.obj", "../box.obj", 5, "does not lie"},
        Fault{"MeshOutsideByDetour", "objects/box.obj", "a/../../b.obj", 5, "does not lie"},
        Fault{"UrdfAbsolute", "robot.urdf", "/etc/passwd", 12, "does not lie"},
        Fault{"NameIsAPath", "name: box", "name: a/b", 5, "name of a file"},
        Fault{"NotABoolean", "movable: true", "movable: yes", 5, "yes"},
        Fault{"MassZero", "mass: 3.0", "mass: 0", 5, "0 is out of range for a mass"},
        Fault{"BrokenYaml", "tool: {radius: 0.01}", "tool: {radius: 0.01", 12, "not YAML"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Manifest, ErrorsNameTheKeyPath) {
  const Expected<Manifest> manifest = parse_manifest(full_with("0.16", "0"), "m.yaml");
  ASSERT_FALSE(manifest.has_value());
  EXPECT_EQ(manifest.error().place, "markers[0].size");
}

TEST(Manifest, ReadsEveryTagLayoutThatIsShipped) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "calib/tags")) {
    const std::string text =
        "format: pcavr-recording/1\nobjects: [{name: box, mesh: objects/box.obj}]\n" +
        read_file(entry.path()).value();
    const Expected<Manifest> manifest = parse_manifest(text, entry.path().string());
    ASSERT_TRUE(manifest) << manifest.error().to_string();
    EXPECT_FALSE(manifest->markers.empty());
    ++files;
  }
  EXPECT_GE(files, 3);
}

}  // namespace
}  // namespace pcavr
