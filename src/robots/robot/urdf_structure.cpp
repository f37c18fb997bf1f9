// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/urdf_structure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <locale>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <tinyxml.h>

namespace pcavr::robot {
namespace {

/// The parser recurses; no description comes near this.
constexpr int kMaxDepth = 100;

bool is_nested_too_deeply(std::string_view text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    const auto skip_to = [&](std::string_view end) {
      const std::size_t found = text.find(end, i);
      i = found == std::string_view::npos ? text.size() : found;
    };
    if (rest.starts_with("<!--")) {
      skip_to("-->");
    } else if (rest.starts_with("<![CDATA[")) {
      skip_to("]]>");
    } else if (rest.starts_with("</") || rest.starts_with("/>")) {
      --depth;
    } else if (rest.starts_with("<") && !rest.starts_with("<?") && !rest.starts_with("<!")) {
      if (++depth > kMaxDepth) return true;
    }
  }
  return false;
}

std::string attribute(const TiXmlElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

std::string reference(const TiXmlElement& joint, const char* child) {
  const TiXmlElement* element = joint.FirstChildElement(child);
  return element == nullptr ? "" : attribute(*element, "link");
}

bool is_finite_number(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  return stream >> value && std::isfinite(value) && (stream >> std::ws).eof();
}

/// Whether no word is a number that is not finite, or too large for a double. Words that are no
/// numbers are left to urdfdom, which names them.
bool are_finite(const std::string& text) {
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    const char* begin = word.c_str();
    char* end = nullptr;
    const double value = std::strtod(begin, &end);
    if (end != begin && !std::isfinite(value)) return false;
  }
  return true;
}

/// Collects the elements, and stops at the first fault.
class StructureParser {
 public:
  StructureParser(const TiXmlElement& robot, const std::filesystem::path& file)
      : robot_(robot), file_(file) {}

  Expected<UrdfStructure> parse() {
    structure_.robot_name = attribute(robot_, "name");
    if (auto fault = read_links()) return *fault;
    if (auto fault = read_joints()) return *fault;
    if (auto fault = order_links()) return *fault;
    return std::move(structure_);
  }

 private:
  using Fault = std::optional<Error>;

  [[nodiscard]] Error error(const UrdfElement& element, const char* kind, std::string message,
                            std::string hint) const {
    return {std::move(message), file_.string(), element.line,
            fmt::format("{} '{}'", kind, element.name), std::move(hint)};
  }

  /// The name is checked to be there and new.
  Fault read_name(const TiXmlElement& xml, const char* kind, std::map<std::string, int>& lines,
                  UrdfElement& element) {
    element = {attribute(xml, "name"), xml.Row()};
    if (element.name.empty()) {
      return error(element, kind, "has no name", fmt::format("give each <{}> a name", kind));
    }
    const auto [found, is_new] = lines.emplace(element.name, element.line);
    if (!is_new) {
      return error(element, kind, fmt::format("the name is used in line {}, too", found->second),
                   fmt::format("rename one of the two {}s, and what refers to it", kind));
    }
    return std::nullopt;
  }

  Fault read_links() {
    std::map<std::string, int> lines;
    for (const TiXmlElement* xml = robot_.FirstChildElement("link"); xml != nullptr;
         xml = xml->NextSiblingElement("link")) {
      UrdfElement link;
      if (auto fault = read_name(*xml, "link", lines, link)) return fault;
      if (auto fault = check_numbers(*xml, link, "link")) return fault;
      link_index_[link.name] = structure_.links.size();
      structure_.links.push_back(link);
    }
    if (!structure_.links.empty()) return std::nullopt;
    return Error{"has no <link>", file_.string(), robot_.Row(), "robot",
                 "a description has links, connected by joints"};
  }

  /// Every number below a link or joint that is read: urdfdom takes those of inertias that are no
  /// numbers for 0, and all that are not finite, and says nothing.
  [[nodiscard]] Fault check_numbers(const TiXmlElement& parent, const UrdfElement& element,
                                    const char* kind) const {
    static const std::map<std::string, std::vector<const char*>> kNumbers{
        {"origin", {"xyz", "rpy"}},
        {"mass", {"value"}},
        {"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}},
        {"box", {"size"}},
        {"cylinder", {"radius", "length"}},
        {"sphere", {"radius"}},
        {"mesh", {"scale"}},
        {"axis", {"xyz"}},
        {"limit", {"lower", "upper", "effort", "velocity"}},
        {"dynamics", {"damping", "friction"}},
        {"mimic", {"multiplier", "offset"}}};
    for (const TiXmlElement* xml = parent.FirstChildElement(); xml != nullptr;
         xml = xml->NextSiblingElement()) {
      const auto names = kNumbers.find(xml->ValueStr());
      for (const char* name :
           names == kNumbers.end() ? std::vector<const char*>{} : names->second) {
        const char* text = xml->Attribute(name);
        const bool is_inertia = parent.ValueStr() == "inertial" && xml->ValueStr() != "origin";
        if (text == nullptr || (is_inertia ? is_finite_number(text) : are_finite(text))) continue;
        return error(
            {element.name, xml->Row()}, kind,
            fmt::format("{} of <{}> is '{}', not a finite number", name, xml->Value(), text),
            is_inertia ? "correct its <inertial>; units are kg and m"
                       : fmt::format("correct its <{}>; units are SI", xml->Value()));
      }
      if (auto fault = check_numbers(*xml, element, kind)) return fault;
    }
    return std::nullopt;
  }

  Fault read_joints() {
    std::map<std::string, int> lines;
    for (const TiXmlElement* xml = robot_.FirstChildElement("joint"); xml != nullptr;
         xml = xml->NextSiblingElement("joint")) {
      UrdfJointElement joint;
      if (auto fault = read_name(*xml, "joint", lines, joint)) return fault;
      if (auto fault = check_numbers(*xml, joint, "joint")) return fault;
      joint.type = attribute(*xml, "type");
      if (auto fault = check_type(joint)) return fault;
      if (auto fault = read_end(*xml, "parent", joint, joint.parent)) return fault;
      if (auto fault = read_end(*xml, "child", joint, joint.child)) return fault;
      if (auto fault = check_child(joint)) return fault;
      structure_.joints.push_back(joint);
    }
    return std::nullopt;
  }

  [[nodiscard]] Fault check_type(const UrdfJointElement& joint) const {
    static const std::set<std::string> kKnown{"fixed", "revolute", "continuous", "prismatic"};
    if (kKnown.contains(joint.type)) return std::nullopt;
    const bool is_free = joint.type == "floating" || joint.type == "planar";
    return error(joint, "joint", fmt::format("type '{}' is not supported", joint.type),
                 is_free ? "the base is fixed; connect the link by a fixed joint"
                         : "use fixed, revolute, continuous or prismatic");
  }

  Fault read_end(const TiXmlElement& xml, const char* end, const UrdfElement& joint,
                 std::size_t& link) const {
    const std::string name = reference(xml, end);
    if (name.empty()) {
      return error(joint, "joint", fmt::format("has no <{}>", end),
                   fmt::format("add <{} link=\"...\"/>", end));
    }
    const auto found = link_index_.find(name);
    if (found == link_index_.end()) {
      return error(joint, "joint", fmt::format("{} link '{}' does not exist", end, name),
                   fmt::format("add <link name=\"{}\"/>, or correct the name", name));
    }
    link = found->second;
    return std::nullopt;
  }

  [[nodiscard]] Fault check_child(const UrdfJointElement& joint) const {
    const std::string& name = structure_.links[joint.child].name;
    if (joint.child == joint.parent) {
      return error(joint, "joint", fmt::format("connects link '{}' with itself", name),
                   "parent and child must differ");
    }
    for (const UrdfJointElement& other : structure_.joints) {
      if (other.child != joint.child) continue;
      return error(
          joint, "joint",
          fmt::format("link '{}' has two parents: it is the child of joint '{}' (line {}), "
                      "too",
                      name, other.name, other.line),
          "closed chains are not supported; remove one of the two joints");
    }
    return std::nullopt;
  }

  Fault order_links() {
    std::vector<std::vector<std::size_t>> children(structure_.links.size());
    std::vector<bool> has_parent(structure_.links.size());
    for (std::size_t i = 0; i < structure_.joints.size(); ++i) {
      children[structure_.joints[i].parent].push_back(i);
      has_parent[structure_.joints[i].child] = true;
    }
    if (auto fault = check_roots(has_parent)) return fault;
    const auto root = static_cast<std::size_t>(
        std::find(has_parent.begin(), has_parent.end(), false) - has_parent.begin());
    std::vector<UrdfStructure::Step> stack{{root, std::nullopt}};
    while (!stack.empty()) {
      const UrdfStructure::Step step = stack.back();
      stack.pop_back();
      structure_.order.push_back(step);
      const std::vector<std::size_t>& joints = children[step.link];
      for (auto joint = joints.rbegin(); joint != joints.rend(); ++joint) {
        stack.push_back({structure_.joints[*joint].child, *joint});
      }
    }
    return check_loops();
  }

  [[nodiscard]] Fault check_roots(const std::vector<bool>& has_parent) const {
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < has_parent.size(); ++i) {
      if (!has_parent[i]) roots.push_back(i);
    }
    if (roots.size() == 1) return std::nullopt;
    if (roots.empty()) return loop_error(0);
    const UrdfElement& second = structure_.links[roots[1]];
    return error(second, "link",
                 fmt::format("is a second root link: no joint leads to it, nor to '{}' (line {})",
                             structure_.links[roots[0]].name, structure_.links[roots[0]].line),
                 "connect it by a joint, or remove it");
  }

  [[nodiscard]] Fault check_loops() const {
    if (structure_.order.size() == structure_.links.size()) return std::nullopt;
    std::vector<bool> is_reached(structure_.links.size());
    for (const UrdfStructure::Step& step : structure_.order) is_reached[step.link] = true;
    return loop_error(static_cast<std::size_t>(
        std::find(is_reached.begin(), is_reached.end(), false) - is_reached.begin()));
  }

  /// The joints of the loop that one gets into upwards from a link.
  [[nodiscard]] Error loop_error(std::size_t link) const {
    const auto joint_to = [&](std::size_t child) -> const UrdfJointElement& {
      return *std::find_if(structure_.joints.begin(), structure_.joints.end(),
                           [&](const UrdfJointElement& joint) { return joint.child == child; });
    };
    for (std::size_t i = 0; i < structure_.links.size(); ++i) link = joint_to(link).parent;
    std::string path = "'" + structure_.links[link].name + "'";
    std::size_t at = link;
    do {
      at = joint_to(at).parent;
      path = "'" + structure_.links[at].name + "' - " + path;
    } while (at != link);
    return error(joint_to(link), "joint", fmt::format("the links form a loop: {}", path),
                 "closed chains are not supported; remove one of the joints");
  }

  const TiXmlElement& robot_;
  const std::filesystem::path& file_;
  UrdfStructure structure_;
  std::map<std::string, std::size_t> link_index_;
};

}  // namespace

Expected<UrdfStructure> parse_urdf_structure(const std::string& text,
                                             const std::filesystem::path& file) {
  const std::string hint = "a robot description in URDF is expected";
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return Error{"is empty", file.string(), 0, "", hint};
  }
  if (text.find('\0') != std::string::npos) {
    return Error{"is not XML: contains a zero byte", file.string(), 0, "", hint};
  }
  if (is_nested_too_deeply(text)) {
    return Error{fmt::format("is not URDF: elements nested more than {} deep", kMaxDepth),
                 file.string(), 0, "", hint};
  }
  TiXmlDocument document;
  document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  if (document.Error()) {
    return Error{fmt::format("is not XML: {}", document.ErrorDesc()), file.string(),
                 document.ErrorRow(), "", hint};
  }
  const TiXmlElement* root = document.RootElement();
  if (root == nullptr || root->ValueStr() != "robot") {
    return Error{"has no <robot>", file.string(), root == nullptr ? 0 : root->Row(), "", hint};
  }
  if (text.find("<xacro:") != std::string::npos) {
    return Error{"is a xacro macro, not URDF", file.string(), root->Row(), "robot",
                 "expand it first: xacro FILE > robot.urdf"};
  }
  return StructureParser(*root, file).parse();
}

}  // namespace pcavr::robot
