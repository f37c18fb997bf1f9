// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/octomap_file.hpp"

#include <sstream>
#include <string>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace {

constexpr int kLevels = 16;        // of OctoMap's trees
constexpr int kOriginKey = 32768;  // of the cell whose lower corner is base's origin

/// Octree parser: two bits for each of eight children: unknown (0), free (1), occupied (2) or inner
/// node (3)
/// [Hornung et al. 2013, sec. 3.5].
class OctreeParser {
 public:
  OctreeParser(std::string_view bytes, OctomapContent& content,
               const std::function<void(const OctomapLeaf&)>& on_leaf)
      : bytes_(bytes), content_(content), on_leaf_(on_leaf) {}

  /// False where the bytes end early, or the tree is deeper than kLevels, or an inner node has no
  /// children: OctoMap would take it for an occupied leaf.
  bool parse(int level, const Eigen::Vector3i& corner) {
    if (level == kLevels || bytes_.size() < 2) return false;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes_[i]); };
    const unsigned children = byte(0) | static_cast<unsigned>(byte(1)) << 8;
    bytes_.remove_prefix(2);
    if (children == 0) return false;
    const int edge = 1 << (kLevels - level - 1);
    for (int child = 0; child < 8; ++child) {
      const unsigned state = children >> (2 * child) & 3;
      if (state == 0) continue;
      const Eigen::Vector3i at =
          corner + edge * Eigen::Vector3i(child & 1, child >> 1 & 1, child >> 2 & 1);
      if (state == 3) {
        if (!parse(level + 1, at)) return false;
      } else {
        add_leaf({at, edge, state == 2});
      }
    }
    return true;
  }

  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  void add_leaf(const OctomapLeaf& leaf) {
    // A tree has at most 2^48 cells.
    const auto edge = static_cast<std::uint64_t>(leaf.edge);
    (leaf.is_occupied ? content_.occupied : content_.free) += edge * edge * edge;
    const Eigen::Vector3d corner = leaf.corner.cast<double>();
    content_.known_base.extend(corner * content_.resolution);
    content_.known_base.extend((corner + Eigen::Vector3d::Constant(leaf.edge)) *
                               content_.resolution);
    if (on_leaf_) on_leaf_(leaf);
  }

  std::string_view bytes_;
  OctomapContent& content_;
  const std::function<void(const OctomapLeaf&)>& on_leaf_;
};

}  // namespace

Expected<OctomapContent> read_octomap(const std::filesystem::path& file,
                                      const std::function<void(const OctomapLeaf& leaf)>& on_leaf) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return parse_octomap(*bytes, file.string(), on_leaf);
}

Expected<OctomapContent> parse_octomap(
    std::string_view bytes, const std::string& file,
    const std::function<void(const OctomapLeaf& leaf)>& on_leaf) {
  const auto invalid = [&](const std::string& message) {
    return Error{.message = message, .file = file};
  };
  constexpr std::string_view kHeaderEnd = "\ndata\n";
  const std::size_t end = bytes.find(kHeaderEnd);
  if (!bytes.starts_with("# Octomap OcTree binary file\n") || end == std::string_view::npos) {
    return invalid("is not an OctoMap binary tree");
  }
  OctomapContent content;
  std::istringstream header{std::string(bytes.substr(0, end))};
  std::size_t nodes = 0;
  for (std::string line; std::getline(header, line);) {
    std::istringstream tokens(line);
    std::string key;
    tokens >> key;
    if (key == "res") tokens >> content.resolution;
    if (key == "size") tokens >> nodes;
  }
  if (!ranges::kOccupancyCell.contains(content.resolution)) {
    return invalid("cell size (res) is out of range");
  }
  OctreeParser parser(bytes.substr(end + kHeaderEnd.size()), content, on_leaf);
  const bool is_complete = nodes == 0 || parser.parse(0, Eigen::Vector3i::Constant(-kOriginKey));
  if (!is_complete) return invalid("is truncated, or not a tree");
  if (!parser.is_at_end()) return invalid("has extra bytes after its tree");
  return content;
}

}  // namespace pcavr
