// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/occupancy_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Disables OctoMap's debug output.
#define OCTOMAP_NODEBUGOUT
#include <octomap/OcTree.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/octomap_file.hpp"

namespace pcavr {
namespace {

constexpr std::string_view kFullHeader = "# Octomap OcTree file\n";
constexpr std::string_view kDataMark = "\ndata\n";
constexpr std::size_t kMaxDepth = 17;  // nodes on a path from the root to a cell
constexpr std::size_t kNodeBytes = 5;  // f32 log-odds, u8 with a bit for each child

/// The header's numbers, and the tree's bytes.
struct TreeText {
  double resolution = 0.0;  ///< [m]
  std::size_t nodes = 0;
  std::string_view data;
};

TreeText split(std::string_view bytes) {
  TreeText tree;
  const std::size_t end = bytes.find(kDataMark);
  if (end == std::string_view::npos) return tree;
  tree.data = bytes.substr(end + kDataMark.size());
  std::istringstream header{std::string(bytes.substr(0, end))};
  for (std::string line; std::getline(header, line);) {
    std::istringstream tokens(line);
    std::string key;
    tokens >> key;
    if (key == "res") tokens >> tree.resolution;
    if (key == "size") tokens >> tree.nodes;
  }
  return tree;
}

/// Walks the nodes of a full tree, depth first: what is wrong with them, or nothing.
const char* full_tree_fault(const TreeText& tree) {
  if (tree.nodes > tree.data.size() / kNodeBytes) return "is truncated";
  if (tree.data.size() != tree.nodes * kNodeBytes) return "has extra bytes after its tree";
  std::vector<int> open;  // children still to come, of the nodes on the path
  for (std::size_t i = 0; i < tree.nodes; ++i) {
    if (i > 0 && open.empty()) return "has extra nodes after its tree";
    if (!open.empty()) --open.back();
    float value = 0.0F;
    std::memcpy(&value, tree.data.data() + i * kNodeBytes, sizeof value);
    if (!std::isfinite(value)) return "has a cell that is not a finite number";
    const auto children = static_cast<unsigned char>(tree.data[i * kNodeBytes + 4]);
    open.push_back(std::popcount(children));
    if (open.size() > kMaxDepth) return "is deeper than 16 levels";
    while (!open.empty() && open.back() == 0) open.pop_back();
  }
  return open.empty() ? nullptr : "is truncated";
}

}  // namespace

struct OccupancyTree::State {
  explicit State(double resolution) : tree(resolution) {}
  octomap::OcTree tree;
};

OccupancyTree::OccupancyTree(std::unique_ptr<State> state) : state_(std::move(state)) {}
OccupancyTree::OccupancyTree(OccupancyTree&&) noexcept = default;
OccupancyTree& OccupancyTree::operator=(OccupancyTree&&) noexcept = default;
OccupancyTree::~OccupancyTree() = default;

Expected<OccupancyTree> OccupancyTree::read(const std::filesystem::path& file) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return parse(*bytes, file.string());
}

Expected<OccupancyTree> OccupancyTree::parse(std::string_view bytes, const std::string& file) {
  const TreeText text = split(bytes);
  const bool is_full = bytes.starts_with(kFullHeader);
  if (!is_full) {
    const Expected<OctomapContent> checked = parse_octomap(bytes, file);
    if (!checked) return checked.error();
  } else {
    const char* fault = full_tree_fault(text);
    if (!ranges::kOccupancyCell.contains(text.resolution)) {
      fault = "cell size (res) is out of range";
    }
    if (fault != nullptr) return Error{.message = fault, .file = file};
  }
  auto state = std::make_unique<State>(text.resolution);
  std::istringstream stream{std::string(text.data)};
  if (text.nodes > 0) {
    if (is_full) {
      state->tree.readData(stream);
    } else {
      state->tree.readBinaryData(stream);
    }
  }
  return OccupancyTree(std::move(state));
}

double OccupancyTree::resolution() const { return state_->tree.getResolution(); }

bool OccupancyTree::is_occupied(const Eigen::Vector3d& p_base) const {
  const auto* node = state_->tree.search(p_base.x(), p_base.y(), p_base.z());
  return node != nullptr && state_->tree.isNodeOccupied(node);
}

std::optional<double> OccupancyTree::clearance(const Eigen::Vector3d& p_base, double max) const {
  const octomap::OcTree& tree = state_->tree;
  const Eigen::Vector3d low = p_base.array() - max, high = p_base.array() + max;
  octomap::OcTreeKey low_key, high_key;
  const auto point = [](const Eigen::Vector3d& p) {
    return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()));
  };
  // Outside of OctoMap's key range nothing is occupied.
  if (!tree.coordToKeyChecked(point(low), low_key)) return std::nullopt;
  if (!tree.coordToKeyChecked(point(high), high_key)) return std::nullopt;
  double nearest = max;
  bool is_found = false;
  const auto end = tree.end_leafs_bbx();
  for (auto leaf = tree.begin_leafs_bbx(low_key, high_key); leaf != end; ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const Eigen::Vector3d centre(leaf.getX(), leaf.getY(), leaf.getZ());
    const Eigen::Array3d outside =
        ((p_base - centre).array().abs() - 0.5 * leaf.getSize()).max(0.0);
    const double distance = outside.matrix().norm();
    if (distance > nearest) continue;
    nearest = distance;
    is_found = true;
  }
  if (!is_found) return std::nullopt;
  return nearest;
}

void OccupancyTree::for_each_occupied(
    const std::function<void(const Eigen::Vector3d& centre, double edge)>& use) const {
  const octomap::OcTree& tree = state_->tree;
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    if (tree.isNodeOccupied(*leaf)) use({leaf.getX(), leaf.getY(), leaf.getZ()}, leaf.getSize());
  }
}

std::size_t OccupancyTree::clear_occupied(
    const std::function<bool(const Eigen::Vector3d& centre, double edge)>& is_cleared) {
  octomap::OcTree& tree = state_->tree;
  std::vector<octomap::OcTreeKey> cleared;
  const double cell = tree.getResolution();
  for_each_occupied([&](const Eigen::Vector3d& centre, double edge) {
    if (!is_cleared(centre, edge)) return;
    const auto cells = static_cast<int>(std::lround(edge / cell));
    const Eigen::Vector3d first = centre.array() - 0.5 * (edge - cell);
    for (int i = 0; i < cells * cells * cells; ++i) {
      const Eigen::Vector3d middle =
          first + cell * Eigen::Vector3d(i % cells, i / cells % cells, i / (cells * cells));
      if (cells > 1 && !is_cleared(middle, cell)) continue;
      cleared.push_back(tree.coordToKey(middle.x(), middle.y(), middle.z()));
    }
  });
  // Not deleteNode: it aborts where a node loses all its children (OctoMap 1.9).
  for (const octomap::OcTreeKey& key : cleared) {
    tree.setNodeValue(key, tree.getClampingThresMinLog(), true);
  }
  tree.updateInnerOccupancy();
  return cleared.size();
}

std::string OccupancyTree::binary_data() const {
  std::ostringstream stream;
  if (state_->tree.size() > 0) state_->tree.writeBinaryData(stream);
  return stream.str();
}

}  // namespace pcavr
