// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

struct ParameterField {
  const char* name;
  std::optional<ParameterValue> ObjectParameters::*member;
  const char* doc;
};

constexpr std::array kFields{
    ParameterField{"mass", &ObjectParameters::mass, "M [kg]."},
    ParameterField{"inertial_mass", &ObjectParameters::inertial_mass,
                   "M [kg] by accelerations alone, beside a weighed one."},
    ParameterField{"limiting_static_friction", &ObjectParameters::limiting_static_friction,
                   "F_M [N]: the force at which the object breaks loose."},
    ParameterField{"limiting_static_friction_scatter",
                   &ObjectParameters::limiting_static_friction_scatter,
                   "Scatter of F_M from push to push [N]."},
    ParameterField{"sliding_friction_coefficient", &ObjectParameters::sliding_friction_coefficient,
                   "mu: the Coulomb force over M g."},
    ParameterField{"viscous_friction", &ObjectParameters::viscous_friction, "B [N s/m]."},
    ParameterField{"contact_stiffness", &ObjectParameters::contact_stiffness,
                   "k [N/m^n] of F = k d^n + damping d^n d'."},
    ParameterField{"contact_damping", &ObjectParameters::contact_damping,
                   "Damping [N s/m^(n+1)]; for n = 1 [N s/m]."},
    ParameterField{"contact_exponent", &ObjectParameters::contact_exponent, "n."},
    ParameterField{"contact_mass", &ObjectParameters::contact_mass,
                   "m [kg] of F = m d'' + damping d' + k d: material that moves with the tool."},
    ParameterField{"contact_restitution", &ObjectParameters::contact_restitution,
                   "Coefficient of restitution at contact_impact_speed."},
    ParameterField{"contact_impact_speed", &ObjectParameters::contact_impact_speed,
                   "[m/s] of the impacts that gave the restitution."},
    ParameterField{"friction_radius", &ObjectParameters::friction_radius,
                   "Maximum friction moment over maximum friction force of the support [m]."},
    ParameterField{"tool_friction_coefficient", &ObjectParameters::tool_friction_coefficient,
                   "Between the tool's tip and the object."},
    ParameterField{"loading_rate", &ObjectParameters::loading_rate,
                   "[N/s] at which F_M was measured."},
};

ParameterValue make_value(double value, std::optional<double> std) {
  if (!std::isfinite(value)) raise_error({.message = "is not finite", .place = "value"});
  if (std && !(std::isfinite(*std) && *std >= 0.0)) {
    raise_error(
        {.message = "is not a standard deviation: finite, and not negative", .place = "std"});
  }
  return {value, std};
}

std::string text_of_value(const ParameterValue& value) {
  return value.std ? fmt::format("Value({}, std={})", value.value, *value.std)
                   : fmt::format("Value({})", value.value);
}

std::string text_of_parameters(const ObjectParameters& parameters) {
  std::string text;
  for (const auto& [key, value] : list_parameters(parameters)) {
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", key, text_of_value(value));
  }
  return "<Parameters " + text + '>';
}

/// Whether a file may be replaced: only one that is a parameter file.
bool is_parameter_file(const std::filesystem::path& file) {
  return read_parameters(file).has_value();
}

void write(const std::filesystem::path& file, const ParameterTable& table,
           const std::string& comment, bool replace) {
  const std::string text = format_parameters(table, comment);
  static_cast<void>(value_of(parse_parameters(text, file.string())));  // ranges
  OutputFile output = value_of(OutputFile::create(
      file, {.replace = replace, .kind = "parameter file", .is_replaceable = is_parameter_file}));
  check(output.write(text));
  check(output.commit());
}

void bind_value(py::module_& module) {
  py::class_<ParameterValue>(module, "Value", R"(A value and its standard deviation.

Immutable: assign a new Value to change a parameter. float(value) is the number alone.)")
      .def(py::init(&make_value), py::arg("value"), py::arg("std") = py::none(),
           "Raises Error unless both are finite and std is not negative.")
      .def_readonly("value", &ParameterValue::value, "In the parameter's unit.")
      .def_readonly("std", &ParameterValue::std,
                    "Standard deviation in the value's unit; None: not known.")
      .def("__float__", [](const ParameterValue& value) { return value.value; })
      .def("__eq__", [](const ParameterValue& a,
                        const ParameterValue& b) { return a.value == b.value && a.std == b.std; })
      .def("__repr__", &text_of_value);
}

void bind_fields(py::class_<ObjectParameters>& parameters) {
  for (const ParameterField& field : kFields) {
    parameters.def_readwrite(field.name, field.member, field.doc);
  }
  parameters
      .def_property(
          "contact_surface_offset",
          [](const ObjectParameters& self) -> py::object {
            if (!self.contact_surface_offset) return py::none();
            return array_of(*self.contact_surface_offset);
          },
          [](ObjectParameters& self, const py::object& offset) {
            self.contact_surface_offset.reset();
            if (!offset.is_none()) {
              self.contact_surface_offset = vector_of(offset, "contact_surface_offset");
            }
          },
          "(3,) [m] in the object's frame, by which the touched surface lies outside the CAD "
          "body's; None: 0.")
      .def_property_readonly(
          "given", [](const ObjectParameters& self) { return self.sources.given; },
          "Names of the values that were stated or assumed, not identified.")
      .def_property_readonly(
          "recordings", [](const ObjectParameters& self) { return self.sources.recordings; },
          "The recordings that the values rest on, by their content.")
      .def(
          "correlation",
          [](const ObjectParameters& self, const std::string& a, const std::string& b) {
            return correlation_of(a, b, self.sources);
          },
          py::arg("a"), py::arg("b"),
          "The correlation coefficient of two parameters; None where none is stated. Names are\n"
          "those of the parameter file: 'viscous_friction', 'contact.stiffness'.");
}

}  // namespace

void bind_parameters(py::module_& module) {
  bind_value(module);
  py::class_<ObjectParameters> parameters(module, "Parameters",
                                          R"(What is known of an object's contact and friction.

Each attribute is a Value, or None where it is not known.)");
  parameters.def(py::init<>(), "Nothing is known.");
  bind_fields(parameters);
  parameters
      .def(
          "known",
          [](const ObjectParameters& self) {
            py::dict known;
            for (const auto& [key, value] : list_parameters(self)) known[key.c_str()] = value;
            return known;
          },
          "The known parameters as a dict from name to Value, in the file's order.")
      .def("__repr__", &text_of_parameters);

  module.def(
      "read_parameters",
      [](const py::object& file) { return value_of(read_parameters(path_of(file, "file"))); },
      py::arg("file"),
      R"(Reads a parameter file: a dict from object to Parameters.

Raises Error with file, line and key for unknown keys and numbers out of range.)");
  module.def(
      "parse_parameters",
      [](const std::string& text) { return value_of(parse_parameters(text, "text")); },
      py::arg("text"), "The same from the text of a parameter file.");
  module.def(
      "write_parameters",
      [](const py::object& file, const ParameterTable& table, const std::string& comment,
         bool replace) { write(path_of(file, "file"), table, comment, replace); },
      py::arg("file"), py::arg("parameters"), py::arg("comment") = "", py::arg("replace") = false,
      R"(Writes a parameter file, atomically, from a dict from object to Parameters.

`comment` lines come first. With `replace` an existing parameter file is replaced; other files
never are. Raises Error for a value out of range, and where the file can't be written.)");
}

}  // namespace pcavr::python
