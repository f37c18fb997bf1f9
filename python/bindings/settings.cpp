// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"

#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "pcavr/pipeline/option_sets.hpp"
#include "pcavr/recordings/recording/option_file.hpp"

#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

void append(std::vector<OptionSection>& sections, std::vector<OptionSection> more) {
  for (OptionSection& section : more) sections.push_back(std::move(section));
}

bool is_option_name(const std::string& name) {
  const std::string letters = "abcdefghijklmnopqrstuvwxyz0123456789_.";
  return name.find('.') != name.npos && name.find_first_not_of(letters) == name.npos;
}

std::string value_text(const std::string& name, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (PyNumber_Check(value.ptr()) == 0 || py::isinstance<py::str>(value)) {
    throw py::type_error("options: " + name + ": a number or a bool is expected");
  }
  return fmt::format("{}", py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>());
}

/// The dict as the text of a configuration file.
std::string configuration_text(const py::dict& options) {
  std::map<std::string, std::string> lines;  // by section
  for (const auto& [key, value] : options) {
    const std::string name = py::str(key);
    if (!is_option_name(name)) {
      raise_error({.message = "'" + name + "' is not the name of an option",
                   .place = "options",
                   .hint = "give section.key, as pcavr --print-config lists them"});
    }
    const std::size_t dot = name.rfind('.');
    lines[name.substr(0, dot)] +=
        "  " + name.substr(dot + 1) + ": " + value_text(name, value) + '\n';
  }
  std::string text;
  for (const auto& [section, keys] : lines) text += section + ":\n" + keys;
  return text;
}

}  // namespace

void Settings::set(const py::object& options) {
  if (options.is_none()) return;
  if (!py::isinstance<py::dict>(options)) {
    throw py::type_error("options: a dict from \"section.key\" to a number is expected");
  }
  const std::string text = configuration_text(options);
  if (text.empty()) return;
  const Expected<void> parsed = parse_options(text, "options", sections());
  if (parsed) return;
  Error error = parsed.error();
  error.line = 0;  // of the text above, which the caller has not seen
  raise_error(error);
}

std::vector<OptionSection> Settings::sections() {
  std::vector<OptionSection> sections{section_of(reading)};
  append(sections, sections_of(build.perception));
  append(sections, sections_of(build));
  append(sections, sections_of(teleop));
  append(sections, sections_of(evaluation));
  append(sections, {section_of(plan), section_of(estimator), section_of(estimator.averaging)});
  append(sections,
         {section_of(robot.signals), section_of(robot.fit), section_of(robot.contact),
          section_of(robot.trial), section_of(robot.intervals), section_of(robot.payload)});
  return sections;
}

std::vector<std::pair<std::string, std::string>> Settings::changed() {
  return changed_options(sections());
}

TeleopOptions Settings::replayed() const { return replay_options(teleop); }

IdentificationOptions Settings::identification() const {
  return identification_options(teleop, plan, estimator);
}

}  // namespace pcavr::python
