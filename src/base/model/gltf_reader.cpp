// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/geometry/pixel.hpp"

#include "base/model/gltf_document.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"

namespace pcavr::model {
namespace {

using nlohmann::json;

// glTF 2.0, section 5.24: points and lines have the modes below.
constexpr std::size_t kTriangles = 4;
constexpr std::size_t kTriangleStrip = 5;
constexpr std::size_t kTriangleFan = 6;

/// Nodes may show the same mesh many times: some 100 bytes each, up to this sum, take 1 GB.
constexpr std::size_t kMaxGltfVertices = 20'000'000;
constexpr std::size_t kMaxGltfTriangles = 40'000'000;

/// IEC 61966-2-1.
double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::uint8_t srgb_byte(float linear) {
  const double encoded = srgb_from_linear(std::clamp(static_cast<double>(linear), 0.0, 1.0));
  return static_cast<std::uint8_t>(clamp_to_int(255.0 * encoded + 0.5, 0, 255));
}

/// The numbers of the entry `name`; the default where there is none.
template <std::size_t kSize>
std::array<double, kSize> numbers_at(const json& node, const char* name,
                                     const std::array<double, kSize>& otherwise) {
  return node.contains(name) ? node.at(name).get<std::array<double, kSize>>() : otherwise;
}

Eigen::Affine3d transform_of(const json& node) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.contains("matrix")) {
    const auto columns = node.at("matrix").get<std::array<double, 16>>();
    transform.matrix().topRows<3>() =
        Eigen::Map<const Eigen::Matrix4d>(columns.data()).topRows<3>();
  } else {
    const auto t = numbers_at<3>(node, "translation", {0.0, 0.0, 0.0});
    const auto q = numbers_at<4>(node, "rotation", {0.0, 0.0, 0.0, 1.0});
    const auto s = numbers_at<3>(node, "scale", {1.0, 1.0, 1.0});
    transform = Eigen::Translation3d(t[0], t[1], t[2]) *
                Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized() *
                Eigen::Scaling(s[0], s[1], s[2]);
  }
  if (!transform.matrix().allFinite())
    throw MeshFault("it has a node whose transform is not finite");
  return transform;
}

/// Appends the meshes of a scene's nodes, depth first.
class GltfMeshReader {
 public:
  explicit GltfMeshReader(const std::filesystem::path& file) : document_(file) {}

  TriangleMesh read() {
    is_visited_.resize(document_.root().value("nodes", json::array()).size());
    // A loop, because recursion would overflow the stack on deeply nested nodes.
    std::vector<std::pair<std::size_t, Eigen::Affine3d>> open;
    const auto add_nodes = [&](const json& indices, const Eigen::Affine3d& T_file_parent) {
      for (auto index = indices.rbegin(); index != indices.rend(); ++index) {
        open.emplace_back(whole_number(*index), T_file_parent);
      }
    };
    add_nodes(root_nodes(), Eigen::Affine3d::Identity());
    while (!open.empty()) {
      const auto [index, T_file_parent] = open.back();
      open.pop_back();
      const json& node = document_.at("nodes", index);
      if (is_visited_[index]) {
        throw MeshFault("its node " + std::to_string(index) + " has two parents");
      }
      is_visited_[index] = true;
      const Eigen::Affine3d T_file_node = T_file_parent * transform_of(node);
      if (node.contains("mesh")) append_mesh(document_.at("meshes", node.at("mesh")), T_file_node);
      add_nodes(node.value("children", json::array()), T_file_node);
    }
    if (mesh_.normals.size() != mesh_.vertices.size()) mesh_.normals.clear();
    if (mesh_.colors.size() != mesh_.vertices.size()) mesh_.colors.clear();
    return std::move(mesh_);
  }

 private:
  /// The root nodes of the scene that the file shows first; a file without scenes shows nothing.
  json root_nodes() const {
    const json index = document_.root().value("scene", json(0));
    return document_.at("scenes", index).value("nodes", json::array());
  }

  void append_mesh(const json& mesh, const Eigen::Affine3d& T_file_mesh) {
    for (const json& primitive : mesh.at("primitives")) {
      const std::size_t mode = whole_number(primitive.value("mode", json(kTriangles)));
      const bool is_surface = mode == kTriangles || mode == kTriangleStrip || mode == kTriangleFan;
      if (is_surface && primitive.at("attributes").contains("POSITION")) {
        append_primitive(primitive, mode, T_file_mesh);
      }
    }
  }

  void append_primitive(const json& primitive, std::size_t mode,
                        const Eigen::Affine3d& T_file_mesh) {
    const json& attributes = primitive.at("attributes");
    const json& position = attributes.at("POSITION");
    const std::size_t count = document_.count(position);
    const std::size_t corners =
        primitive.contains("indices") ? document_.count(primitive.at("indices")) : count;
    if (count > kMaxGltfVertices - mesh_.vertices.size() ||
        corners > kMaxGltfTriangles - mesh_.triangles.size()) {
      throw MeshFault("it has more than " + std::to_string(kMaxGltfVertices) + " vertices");
    }
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    append_positions(document_.floats(position, 3), T_file_mesh);
    if (attributes.contains("NORMAL")) {
      append_normals(same_count(attributes.at("NORMAL"), count), T_file_mesh);
    }
    if (attributes.contains("COLOR_0")) {
      const std::vector<float> color = same_count(attributes.at("COLOR_0"), count);
      for (std::size_t i = 0; i < color.size(); i += 3) {
        mesh_.colors.push_back(
            {srgb_byte(color[i]), srgb_byte(color[i + 1]), srgb_byte(color[i + 2])});
      }
    }
    append_triangles(corners_of(primitive, count), mode, first,
                     T_file_mesh.linear().determinant() < 0.0);
  }

  /// Three numbers for each vertex.
  std::vector<float> same_count(const json& accessor, std::size_t count) {
    if (document_.count(accessor) != count) {
      throw MeshFault("its attributes of a vertex differ in number");
    }
    return document_.floats(accessor, 3);
  }

  void append_positions(const std::vector<float>& numbers, const Eigen::Affine3d& T_file_mesh) {
    // Coordinates without a transform stay as they are stored, to the bit.
    const bool is_identity = T_file_mesh.matrix() == Eigen::Matrix4d::Identity();
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
      const Eigen::Vector3f p(numbers[i], numbers[i + 1], numbers[i + 2]);
      mesh_.vertices.push_back(is_identity ? p : (T_file_mesh * p.cast<double>()).cast<float>());
    }
  }

  void append_normals(const std::vector<float>& numbers, const Eigen::Affine3d& T_file_mesh) {
    const Eigen::Matrix3d normal_matrix = T_file_mesh.linear().inverse().transpose();
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
      const Eigen::Vector3d n(numbers[i], numbers[i + 1], numbers[i + 2]);
      mesh_.normals.push_back((normal_matrix * n).normalized().cast<float>());
    }
  }

  std::vector<std::uint32_t> corners_of(const json& primitive, std::size_t count) {
    std::vector<std::uint32_t> corners;
    if (primitive.contains("indices")) {
      corners = document_.indices(primitive.at("indices"));
    } else {
      for (std::uint32_t i = 0; i < count; ++i) corners.push_back(i);
    }
    for (const std::uint32_t corner : corners) {
      if (corner >= count) {
        throw MeshFault("it refers to vertex " + std::to_string(corner) + " of " +
                        std::to_string(count));
      }
    }
    return corners;
  }

  void append_triangles(const std::vector<std::uint32_t>& corners, std::size_t mode,
                        std::uint32_t first, bool is_mirrored) {
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      std::array<std::uint32_t, 3> triangle{corners[i], corners[i + 1], corners[i + 2]};
      if (mode == kTriangleFan) triangle = {corners[i + 1], corners[i + 2], corners[0]};
      // Every other triangle of a strip is wound the other way round.
      const bool is_turned = mode == kTriangleStrip && i % 2 == 1;
      if (is_turned != is_mirrored) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
    }
  }

  GltfDocument document_;
  std::vector<bool> is_visited_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_gltf_mesh(const std::filesystem::path& file) {
  try {
    return GltfMeshReader(file).read();
  } catch (const json::parse_error& failure) {
    throw MeshFault("its JSON is damaged at byte " + std::to_string(failure.byte));
  } catch (const json::exception& failure) {
    // "[json.exception.out_of_range.403] key 'nodes' not found"
    const std::string text = failure.what();
    throw MeshFault("its JSON is not that of a glTF: " + text.substr(text.find(' ') + 1));
  }
}

}  // namespace pcavr::model
