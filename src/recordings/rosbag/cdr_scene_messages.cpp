// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"

#include <limits>

#include "cdr_writer.hpp"

namespace pcavr::cdr {
namespace {

constexpr std::uint32_t kTriangleList = 11;  // visualization_msgs/Marker
constexpr std::uint8_t kFloat32 = 7;         // sensor_msgs/PointField

constexpr std::string_view kDuration =
    "MSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n";
constexpr std::string_view kColor =
    "MSG: std_msgs/ColorRGBA\nfloat32 r\nfloat32 g\nfloat32 b\nfloat32 a\n";
constexpr std::string_view kUv = "MSG: visualization_msgs/UVCoordinate\nfloat32 u\nfloat32 v\n";
constexpr std::string_view kMeshFile =
    "MSG: visualization_msgs/MeshFile\nstring filename\nuint8[] data\n";
constexpr std::string_view kCompressedImage =
    "std_msgs/Header header\nstring format\nuint8[] data\n";
constexpr std::string_view kNamedCompressedImage =
    "MSG: sensor_msgs/CompressedImage\nstd_msgs/Header header\nstring format\nuint8[] data\n";
constexpr std::string_view kMarker =
    "MSG: visualization_msgs/Marker\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\n"
    "int32 action\ngeometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\n"
    "std_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\n"
    "geometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n"
    "sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\n"
    "string text\nstring mesh_resource\nvisualization_msgs/MeshFile mesh_file\n"
    "bool mesh_use_embedded_materials\n";
constexpr std::string_view kPointField =
    "MSG: sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n";
constexpr std::string_view kDiagnosticStatus =
    "MSG: diagnostic_msgs/DiagnosticStatus\nbyte level\nstring name\nstring message\n"
    "string hardware_id\ndiagnostic_msgs/KeyValue[] values\n";
constexpr std::string_view kKeyValue = "MSG: diagnostic_msgs/KeyValue\nstring key\nstring value\n";
constexpr std::string_view kObjectPhase =
    "MSG: pcavr_msgs/ObjectPhase\nstring object\nstring phase\nbool outside_model\n"
    "bool blocked\nbool saturated\n";
constexpr std::string_view kParameter =
    "MSG: pcavr_msgs/Parameter\nstring object\nstring name\nfloat64 value\nfloat64 std\n";

void write_color(const std::array<float, 4>& color, Writer& writer) {
  for (const float channel : color) writer.f32(channel);
}

/// The corners of each triangle, and their colours if there are any.
void write_triangles(const TriangleMesh& mesh, Writer& writer) {
  const std::size_t corners = 3 * mesh.triangles.size();
  constexpr std::size_t kCornerBytes = 3 * sizeof(double) + 4 * sizeof(float);
  writer.reserve(corners * kCornerBytes);
  writer.count(corners);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) writer.vector(mesh.vertices[vertex].cast<double>());
  }
  writer.count(mesh.colors.empty() ? 0 : corners);
  if (mesh.colors.empty()) return;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      const Rgb8& color = mesh.colors[vertex];
      constexpr float kFull = 255.0F;
      write_color({static_cast<float>(color.r) / kFull, static_cast<float>(color.g) / kFull,
                   static_cast<float>(color.b) / kFull, 1.0F},
                  writer);
    }
  }
}

void write_marker(Stamp stamp, const MeshMarker& marker, Writer& writer) {
  writer.header(stamp, marker.frame);
  writer.text(marker.name);
  writer.u32(0);  // id
  writer.u32(kTriangleList);
  writer.u32(0);  // action: add
  writer.pose(Pose());
  writer.vector(Eigen::Vector3d::Ones());  // scale
  write_color(marker.color, writer);
  writer.u32(0);  // lifetime: for ever
  writer.u32(0);
  writer.u8(1);  // frame_locked: it moves with its frame
  write_triangles(*marker.mesh, writer);
  writer.text("");  // texture_resource
  writer.header({}, "");
  writer.text("");
  writer.u32(0);    // texture
  writer.u32(0);    // uv_coordinates
  writer.text("");  // text
  writer.text("");  // mesh_resource
  writer.text("");
  writer.u32(0);  // mesh_file
  writer.u8(0);   // mesh_use_embedded_materials
}

}  // namespace

std::string marker_array_definition() {
  return definition("visualization_msgs/Marker[] markers\n",
                    {kMarker, kHeader, kTime, kPose, kPoint, kQuaternion, kVector, kColor,
                     kDuration, kNamedCompressedImage, kUv, kMeshFile});
}

std::string point_cloud_definition() {
  return definition(
      "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
      "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
      {kHeader, kTime, kPointField});
}

std::string joint_state_definition() {
  return definition(
      "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
      "float64[] effort\n",
      {kHeader, kTime});
}

std::string compressed_image_definition() { return definition(kCompressedImage, {kHeader, kTime}); }

std::string string_definition() { return "string data\n"; }

std::string diagnostic_array_definition() {
  return definition("std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
                    {kHeader, kTime, kDiagnosticStatus, kKeyValue});
}

std::string phases_definition() {
  return definition("std_msgs/Header header\npcavr_msgs/ObjectPhase[] phases\n",
                    {kHeader, kTime, kObjectPhase});
}

std::string parameters_definition() {
  return definition("std_msgs/Header header\npcavr_msgs/Parameter[] parameters\n",
                    {kHeader, kTime, kParameter});
}

std::vector<std::uint8_t> marker_array(Stamp stamp, const std::vector<MeshMarker>& markers) {
  Writer writer;
  writer.count(markers.size());
  for (const MeshMarker& marker : markers) write_marker(stamp, marker, writer);
  return writer.take();
}

std::vector<std::uint8_t> point_cloud(Stamp stamp, std::span<const Eigen::Vector3f> points,
                                      std::string_view frame) {
  constexpr std::uint32_t kPointBytes = 3 * sizeof(float);
  Writer writer;
  writer.header(stamp, frame);
  writer.u32(1);  // height
  writer.count(points.size());
  writer.u32(3);  // fields
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    writer.text(std::string_view("xyz").substr(axis, 1));
    writer.u32(axis * 4);
    writer.u8(kFloat32);
    writer.u32(1);
  }
  writer.u8(0);  // is_bigendian
  writer.u32(kPointBytes);
  writer.count(points.size() * kPointBytes);
  writer.count(points.size() *
               kPointBytes);  // its length follows at an aligned place, so do floats
  writer.reserve(points.size() * kPointBytes);
  for (const Eigen::Vector3f& point : points) {
    for (const float value : point) writer.f32(value);
  }
  writer.u8(1);  // is_dense
  return writer.take();
}

std::vector<std::uint8_t> joint_state(Stamp stamp, const std::vector<std::string>& names,
                                      std::span<const double> positions) {
  Writer writer;
  writer.header(stamp, "");
  writer.count(names.size());
  for (const std::string& name : names) writer.text(name);
  writer.count(positions.size());
  for (const double position : positions) writer.f64(position);
  writer.u32(0);  // velocity
  writer.u32(0);  // effort
  return writer.take();
}

std::vector<std::uint8_t> compressed_image(Stamp stamp, std::string_view frame,
                                           std::string_view format,
                                           std::span<const std::uint8_t> bytes) {
  Writer writer;
  writer.header(stamp, frame);
  writer.text(format);
  writer.count(bytes.size());
  writer.reserve(bytes.size());
  for (const std::uint8_t byte : bytes) writer.u8(byte);
  return writer.take();
}

std::vector<std::uint8_t> text_message(std::string_view text) {
  Writer writer;
  writer.text(text);
  return writer.take();
}

std::vector<std::uint8_t> diagnostic_array(Stamp stamp,
                                           const std::vector<Diagnostic>& diagnostics) {
  Writer writer;
  writer.header(stamp, "");
  writer.count(diagnostics.size());
  for (const Diagnostic& diagnostic : diagnostics) {
    writer.u8(static_cast<std::uint8_t>(diagnostic.level));
    writer.text(diagnostic.name);
    writer.text(diagnostic.message);
    writer.text("pcavr");  // hardware_id
    writer.count(diagnostic.values.size());
    for (const auto& [key, value] : diagnostic.values) {
      writer.text(key);
      writer.text(value);
    }
  }
  return writer.take();
}

std::vector<std::uint8_t> phases(Stamp stamp, const std::vector<ObjectPhase>& objects) {
  Writer writer;
  writer.header(stamp, "");
  writer.count(objects.size());
  for (const ObjectPhase& phase : objects) {
    writer.text(phase.object);
    writer.text(phase.phase);
    for (const bool flag : {phase.is_outside_model, phase.is_blocked, phase.is_saturated}) {
      writer.u8(flag ? 1 : 0);
    }
  }
  return writer.take();
}

std::vector<std::uint8_t> parameters(Stamp stamp, const std::vector<Parameter>& values) {
  Writer writer;
  writer.header(stamp, "");
  writer.count(values.size());
  for (const Parameter& parameter : values) {
    writer.text(parameter.object);
    writer.text(parameter.name);
    writer.f64(parameter.value);
    writer.f64(parameter.std.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return writer.take();
}

}  // namespace pcavr::cdr
