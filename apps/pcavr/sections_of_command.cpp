// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Which sections of a configuration file a command uses.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "configuration.hpp"

namespace pcavr::app {
namespace {

using Names = std::vector<std::string_view>;

/// A section, or all sections whose names begin with one of these and a dot.
const Names kPerception = {"depth_noise", "marker",    "tracking",      "masks",
                           "consistency", "model.cad", "tip_under_load"};
/// Both sites of a link, with online identification.
const Names kSites = {"teleop",
                      "inputs",
                      "prediction",
                      "friction",
                      "identification.segmentation",
                      "identification.spikes",
                      "identification.breakaway",
                      "identification.contact_fit",
                      "identification.onset",
                      "identification.limiting_friction",
                      "identification.sliding",
                      "identification.friction_priors",
                      "identification.breakaway_priors"};
/// The page and its devices, with a scene's arm.
const Names kPage = {"serve", "haptics", "devices", "robot"};

Names joined(std::initializer_list<Names> parts) {
  Names all;
  for (const Names& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

const Names kBuild =
    joined({{"recording", "reconstruction", "scene", "texture", "build"}, kPerception});

/// Commands that are not listed use no section.
const std::vector<std::pair<std::string_view, Names>>& used_sections() {
  static const std::vector<std::pair<std::string_view, Names>> kUsed = {
      {"pcavr build", kBuild},
      {"pcavr survey", kBuild},
      {"pcavr fuse", kBuild},
      {"pcavr identify robot", {"robot_identification"}},
      {"pcavr identify",
       joined({{"recording", "inputs", "identification", "friction"}, kPerception})},
      {"pcavr predict", {"arm"}},
      {"pcavr replay", joined({{"recording", "black_box", "serve.content"}, kPerception, kSites})},
      {"pcavr evaluate", {"evaluation"}},
      {"pcavr export",
       joined({{"recording", "inputs", "identification", "friction"}, kPerception})},
      {"pcavr serve", joined({{"recording", "arm.drive"}, kPerception, kSites, kPage})},
      {"pcavr inspect", joined({{"recording"}, kPerception})},
      {"pcavr record", {"record"}},
      {"pcavr robot-site", joined({{"recording", "robot_site", "black_box"}, kPerception, kSites})},
      {"pcavr operator-site",
       joined({{"recording", "robot_site.limits", "operator_site", "black_box"},
               kPerception,
               kSites,
               kPage})},
  };
  return kUsed;
}

bool begins_with_name(std::string_view text, std::string_view name, char separator) {
  return text.starts_with(name) && (text.size() == name.size() || text[name.size()] == separator);
}

}  // namespace

std::vector<OptionSection> Configuration::sections_of_command(std::string_view command) {
  std::vector<OptionSection> all = sections();
  if (command.find(' ') == std::string_view::npos) return all;
  const auto& used = used_sections();
  const auto entry = std::find_if(used.begin(), used.end(), [&](const auto& each) {
    return begins_with_name(command, each.first, ' ');
  });
  const Names names = entry == used.end() ? Names() : entry->second;
  std::erase_if(all, [&](const OptionSection& section) {
    return std::none_of(names.begin(), names.end(), [&](std::string_view name) {
      return begins_with_name(section.name, name, '.');
    });
  });
  return all;
}

}  // namespace pcavr::app
