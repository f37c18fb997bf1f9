// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

namespace pcavr {
namespace {

constexpr std::string_view kTopicPrefix = "rt";  // of plain topics; services have others
constexpr std::string_view kScope = "::";
constexpr std::string_view kTypeScope = "dds_::";

}  // namespace

std::string dds_topic_name(std::string_view topic) {
  const bool has_slash = !topic.empty() && topic.front() == '/';
  return std::string(kTopicPrefix) + (has_slash ? "" : "/") + std::string(topic);
}

std::string dds_type_name(std::string_view type) {
  std::string name;
  for (std::size_t slash = type.find('/'); slash != type.npos; slash = type.find('/')) {
    name += type.substr(0, slash);
    name += kScope;
    type.remove_prefix(slash + 1);
  }
  return name + std::string(kTypeScope) + std::string(type) + '_';
}

std::string ros_type_name(std::string_view dds_type) {
  const std::size_t scope = dds_type.find(kTypeScope);
  if (scope == dds_type.npos || dds_type.back() != '_') return std::string(dds_type);
  std::string name(dds_type.substr(0, scope));
  for (std::size_t at = name.find(kScope); at != name.npos; at = name.find(kScope)) {
    name.replace(at, kScope.size(), "/");
  }
  const std::string_view rest = dds_type.substr(scope + kTypeScope.size());
  return name + std::string(rest.substr(0, rest.size() - 1));
}

}  // namespace pcavr
