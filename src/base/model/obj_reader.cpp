// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/geometry/pixel.hpp"

#include "base/model/byte_reader.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"

namespace pcavr::model {
namespace {

// Indices are 32 bits; the largest value is reserved for "none".
constexpr std::size_t kMaxObjVertices = 0xFFFFFFFEU;

Rgb8 obj_color(const Eigen::Vector3d& color) {
  const auto channel = [](double c) {
    return static_cast<std::uint8_t>(clamp_to_int(255.0 * c + 0.5, 0, 255));
  };
  return {channel(color.x()), channel(color.y()), channel(color.z())};
}

/// Reads line by line. Faces refer to vertices above them.
class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, MeshContent content)
      : bytes_(file), has_attributes_(content == MeshContent::kAll) {}

  TriangleMesh read() {
    std::string joined;
    while (const auto line = bytes_.line()) {
      // A backslash at its end continues a line.
      if (line->ends_with('\\')) {
        joined += line->substr(0, line->size() - 1);
        joined += ' ';
        if (joined.size() > kMaxJoined) fail("a continued line has more than 1 MB");
      } else if (!joined.empty()) {
        joined += *line;
        read_line(joined);
        joined.clear();
      } else {
        read_line(*line);
      }
    }
    return has_attributes_ ? with_attributes() : std::move(mesh_);
  }

 private:
  static constexpr std::size_t kMaxJoined = 1U << 20U;

  [[noreturn]] void fail(const std::string& reason) const {
    throw MeshFault(reason, bytes_.line_number());
  }

  void read_line(std::string_view line) {
    split_words(line, words_);
    if (words_.empty()) return;
    if (words_[0] == "v") {
      read_vertex();
    } else if (words_[0] == "vn" && has_attributes_) {
      if (words_.size() < 4) fail("a normal has not three numbers");
      normals_.push_back(Eigen::Vector3d(number(1), number(2), number(3)).cast<float>());
    } else if (words_[0] == "f") {
      read_face();
    }
  }

  [[nodiscard]] double number(std::size_t word) const {
    const std::optional<double> value = number_of(words_[word]);
    if (!value) fail("'" + std::string(words_[word].substr(0, 30)) + "' is not a number");
    return *value;
  }

  /// Three coordinates; a fourth number alone is a weight, three more are a colour.
  void read_vertex() {
    if (words_.size() < 4) fail("a vertex has not three coordinates");
    if (mesh_.vertices.size() >= kMaxObjVertices) fail("it has too many vertices");
    Eigen::Vector3d p(number(1), number(2), number(3));
    if (words_.size() == 5) {
      const double weight = number(4);
      if (!(weight != 0.0)) fail("a vertex has the weight 0");
      p /= weight;
    }
    mesh_.vertices.push_back(p.cast<float>());
    if (has_attributes_ && words_.size() >= 7) {
      mesh_.colors.resize(mesh_.vertices.size() - 1);
      mesh_.colors.push_back(obj_color({number(4), number(5), number(6)}));
      ++colored_;
    }
  }

  /// One-based, or negative: relative to the last one.
  [[nodiscard]] std::uint32_t index_in(std::string_view text, std::size_t count,
                                       const char* kind) const {
    std::int64_t index = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (code != std::errc{} || end != text.data() + text.size()) {
      fail("'" + std::string(text.substr(0, 30)) + "' is not an index");
    }
    const std::int64_t position = index < 0 ? index + static_cast<std::int64_t>(count) : index - 1;
    if (position < 0 || position >= static_cast<std::int64_t>(count)) {
      fail("a face refers to " + std::string(kind) + " " + std::string(text) + " of the " +
           std::to_string(count) + " above it");
    }
    return static_cast<std::uint32_t>(position);
  }

  /// Corners are V, V/T, V//N or V/T/N.
  void read_face() {
    corners_.clear();
    for (std::size_t i = 1; i < words_.size(); ++i) {
      std::string_view word = words_[i];
      if (word.starts_with('#')) break;
      const std::size_t slash = std::min(word.find('/'), word.size());
      const std::uint32_t vertex = index_in(word.substr(0, slash), mesh_.vertices.size(), "vertex");
      corners_.push_back(has_attributes_ ? add_corner(vertex, word.substr(slash)) : vertex);
    }
    append_face(corners_, bytes_.line_number(), has_attributes_ ? expanded_ : mesh_);
  }

  /// The corner of a face as a vertex of its own. `rest`: /T, //N or /T/N.
  std::uint32_t add_corner(std::uint32_t vertex, std::string_view rest) {
    const std::size_t slash = rest.size() > 1 ? rest.find('/', 1) : rest.npos;
    if (slash != rest.npos && slash + 1 < rest.size()) {
      const std::uint32_t normal = index_in(rest.substr(slash + 1), normals_.size(), "normal");
      expanded_.normals.push_back(normals_[normal].normalized());
    }
    sources_.push_back(vertex);
    expanded_.vertices.push_back(mesh_.vertices[vertex]);
    return static_cast<std::uint32_t>(sources_.size() - 1);
  }

  TriangleMesh with_attributes() {
    if (expanded_.normals.size() != expanded_.vertices.size()) expanded_.normals.clear();
    if (colored_ > 0 && colored_ == mesh_.vertices.size()) {
      for (const std::uint32_t vertex : sources_) expanded_.colors.push_back(mesh_.colors[vertex]);
    }
    return std::move(expanded_);
  }

  ByteReader bytes_;
  bool has_attributes_;
  TriangleMesh mesh_;  ///< as stored: shared vertices, without normals
  std::vector<Eigen::Vector3f> normals_;
  std::size_t colored_ = 0;             ///< number of vertices with a colour
  TriangleMesh expanded_;               ///< a vertex for each corner, with its normal
  std::vector<std::uint32_t> sources_;  ///< of each corner in `mesh_`
  std::vector<std::string_view> words_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

TriangleMesh read_obj_mesh(const std::filesystem::path& file, MeshContent content) {
  return ObjReader(file, content).read();
}

}  // namespace pcavr::model
