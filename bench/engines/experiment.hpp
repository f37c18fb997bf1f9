// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

// The experiments of experiment.mjs, for engines in C++.
namespace engines {

using Json = nlohmann::json;
using Vector = std::array<double, 3>;

/// [kg] of the tool: contact does not move it, and its change of velocity in a step is the force.
inline constexpr double kToolMass = 100.0;
/// [m] Place of a tool that meets nothing.
inline constexpr Vector kAway{0.0, 0.0, 50.0};

inline Vector vector_of(const Json& json) { return {json[0], json[1], json[2]}; }

/// The body after a step.
struct BodyState {
  Vector position{};  ///< [m] of its origin
  std::array<double, 4> quaternion{};
  Vector velocity{};  ///< [m/s] of its centre of mass
  Vector spin{};      ///< [rad/s]
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step() = 0;
  virtual void set_tool(const Vector& position, const Vector& velocity) = 0;
  [[nodiscard]] virtual Vector tool_force() const = 0;  ///< [N] on the body
  [[nodiscard]] virtual BodyState state() const = 0;
  virtual void set_velocity(const Vector& linear, const Vector& angular) = 0;
  /// About the centre of mass, for the next step [N], [N m].
  virtual void apply_wrench(const Vector& force, const Vector& torque) = 0;
};

/// The identified friction of a body by its slip speed, as in friction_law.mjs.
class FrictionLaw {
 public:
  explicit FrictionLaw(const Json& body) : law_(body.value("law", Json())) {}

  /// The body's coefficient over the exported one: 1 without a law.
  [[nodiscard]] double share(const BodyState& body) const {
    if (law_.is_null()) return 1.0;
    const auto number = [&](const char* key) { return law_[key].get<double>(); };
    const double turning = std::hypot(body.spin[0], body.spin[1], body.spin[2]);
    const double slip =
        std::hypot(body.velocity[0], body.velocity[1], turning * number("friction_radius"));
    const double ratio = slip / number("stribeck_speed");
    const double rise =
        number("stribeck_speed") > 0.0 ? std::exp(-ratio * ratio) : (slip < 1e-3 ? 1.0 : 0.0);
    const double coulomb = number("coulomb_friction");
    const double viscous = number("viscous") * slip / (9.80665 * number("mass"));
    return (coulomb + viscous + (number("static_friction") - coulomb) * rise) / number("friction");
  }

 private:
  Json law_;
};

/// Rows [t, ...], read in the order of time.
class Table {
 public:
  explicit Table(const Json& json) : rows_(json.get<std::vector<std::vector<double>>>()) {}
  [[nodiscard]] std::pair<Vector, Vector> at(double t) {
    while (row_ + 2 < rows_.size() && rows_[row_ + 1][0] <= t) ++row_;
    const auto& a = rows_[row_];
    const auto& b = rows_[std::min(row_ + 1, rows_.size() - 1)];
    const double s = b[0] > a[0] ? std::clamp((t - a[0]) / (b[0] - a[0]), 0.0, 1.0) : 0.0;
    const auto value = [&](std::size_t i) { return a[i] + s * (b[i] - a[i]); };
    return {{value(1), value(2), value(3)}, {value(4), value(5), value(6)}};
  }

 private:
  std::vector<std::vector<double>> rows_;
  std::size_t row_ = 0;
};

inline Json row_of(double t, const Engine& engine) {
  const BodyState body = engine.state();
  const auto& [x, y, z, w] = body.quaternion;
  const double yaw = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  const Vector force = engine.tool_force();
  return {t,        body.position[0], body.position[1], body.position[2],
          yaw,      body.velocity[0], body.velocity[1], body.spin[2],
          force[0], force[1],         force[2]};
}

inline Json run_experiment(Engine& engine, const Json& experiment) {
  const double dt = experiment["dt"], settle = experiment["settle"];
  for (double t = 0.0; t < settle; t += dt) {
    engine.set_tool(kAway, {});
    engine.step();
  }
  if (!experiment["twist"].is_null()) {
    const Vector twist = vector_of(experiment["twist"]);
    engine.set_velocity({twist[0], twist[1], 0.0}, {0.0, 0.0, twist[2]});
  }
  const bool is_pushed = !experiment["tool"].is_null(), is_loaded = !experiment["wrench"].is_null();
  Table tool(is_pushed ? experiment["tool"] : Json::array());
  Table wrench(is_loaded ? experiment["wrench"] : Json::array());
  Json rows = Json::array();
  const int every = experiment["every"];
  for (int step = 0; step * dt < experiment["duration"].get<double>(); ++step) {
    const double t = step * dt;
    const auto [position, velocity] = is_pushed ? tool.at(t) : std::pair(kAway, Vector{});
    engine.set_tool(position, velocity);
    if (is_loaded) {
      const auto [force, torque] = wrench.at(t);
      engine.apply_wrench(force, torque);
    }
    engine.step();
    if (step % every == 0) rows.push_back(row_of(t, engine));
  }
  return rows;
}

/// Runs the jobs of a file, a line of JSON each, and prints a line for each.
template <typename MakeEngine>
int run_jobs(int argc, char** argv, const MakeEngine& make_engine) {
  std::ifstream jobs(argc == 2 ? argv[1] : "");
  if (!jobs) {
    std::cerr << "give the file of the jobs\n";
    return 1;
  }
  for (std::string line; std::getline(jobs, line);) {
    const Json job = Json::parse(line);
    const auto engine = make_engine(job);
    std::cout << Json{{"id", job["id"]}, {"rows", run_experiment(*engine, job["experiment"])}}
              << '\n';
  }
  return 0;
}

}  // namespace engines
