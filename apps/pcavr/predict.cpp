// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/robots/arm/arm_queries.hpp"
#include "pcavr/robots/arm/identified_arm.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/serve/scene_arm.hpp"

#include "commands.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

using Numbers = std::vector<double>;

struct PredictArguments {
  std::string robot;
  std::string scene;
  std::string identified;
  std::string parameters;
  std::string tip;
  Numbers joints;
  Numbers point;
  Numbers velocity;
  Numbers force;
  Numbers direction;
  std::string object;
  std::optional<double> time;
  double distance = 0.0;
};

/// The arm in question, and where it stands.
struct PredictedArm {
  QueriedArm arm;
  Pose T_base_robot;
  std::optional<SceneManifest> scene;
};

Eigen::Vector3d vector_of(const Numbers& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// The scene's arm with its surroundings: the mesh and the objects.
Expected<PredictedArm> arm_of_scene(const PredictArguments& arguments) {
  Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  Expected<std::optional<SceneArm>> found = read_scene_arm(*scene);
  if (!found) return found.error();
  if (!*found) {
    return Error{.message = "has no robot",
                 .file = arguments.scene,
                 .hint = "build the scene from a recording with a robot, or give --robot"};
  }
  SceneArm& arm = **found;
  PredictedArm predicted{.arm = {.model = std::move(arm.model),
                                 .friction = {},
                                 .tip = arm.tip,
                                 .q = std::move(arm.q),
                                 .link_meshes = std::move(arm.link_meshes)},
                         .T_base_robot = arm.T_base_robot,
                         .scene = std::move(*scene)};
  return predicted;
}

Expected<PredictedArm> arm_of_description(const PredictArguments& arguments,
                                          const Observer& observer) {
  // Identified inertias take the place of the description's.
  const bool is_identified = !arguments.identified.empty();
  Expected<RobotModel> model = read_urdf(
      arguments.robot, {.requires_inertia = !is_identified, .ignores_inertia = is_identified});
  if (!model) return model.error();
  Expected<LinkMeshes> meshes = link_meshes(*model);
  if (!meshes) return meshes.error();
  for (const std::vector<Error>* warnings : {&model->warnings, &meshes->warnings}) {
    for (const Error& warning : *warnings) observer.on_warning(warning.to_string());
  }
  PredictedArm predicted{.arm = {.model = std::move(*model),
                                 .friction = {},
                                 .tip = 0,
                                 .q = {},
                                 .link_meshes = std::move(meshes->of_link)},
                         .T_base_robot = {},
                         .scene = {}};
  QueriedArm& arm = predicted.arm;
  arm.tip = default_tip(arm.model);
  arm.q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.model.dof));
  for (const std::size_t i : arm.model.coordinate_joints()) {
    const JointLimits& limits = arm.model.joints[i].limits;
    double& q = arm.q[static_cast<Eigen::Index>(arm.model.joints[i].coordinate)];
    q = std::clamp(q, limits.lower.value_or(q),
                   std::max(limits.upper.value_or(q), limits.lower.value_or(q)));
  }
  return predicted;
}

Expected<void> set_start(const PredictArguments& arguments, QueriedArm& arm) {
  if (!arguments.tip.empty()) {
    const std::optional<std::size_t> tip = arm.model.link_index(arguments.tip);
    if (!tip) {
      return Error{.message = "the robot has no link '" + arguments.tip + "'",
                   .hint = "give a link of the description with --tip"};
    }
    arm.tip = *tip;
  }
  if (arguments.joints.empty()) return {};
  if (arguments.joints.size() != arm.model.dof) {
    return Error{.message = fmt::format("--joints has {} numbers, the arm {} joints",
                                        arguments.joints.size(), arm.model.dof),
                 .hint = "give one position for each joint, in the order of the chain"};
  }
  arm.q = Eigen::Map<const Eigen::VectorXd>(arguments.joints.data(),
                                            static_cast<Eigen::Index>(arguments.joints.size()));
  return {};
}

/// Joints that were not identified and carry none that was: a gripper's. An Error where one is
/// between the base and an identified joint, because the dynamics of those depend on it.
Expected<std::vector<std::string>> joints_beyond(const RobotModel& described,
                                                 const RobotModel& identified) {
  std::vector<std::string> beyond;
  std::vector<bool> carries(described.joints.size());
  for (std::size_t i = described.joints.size(); i-- > 0;) {
    const RobotJoint& joint = described.joints[i];
    const bool is_identified = identified.joint_index(joint.name).has_value();
    if (!is_identified && carries[i]) {
      return Error{.message = "identifies fewer joints than the arm has: not " + joint.name,
                   .hint = "identify all joints"};
    }
    if (!is_identified) beyond.insert(beyond.begin(), joint.name);
    if (joint.parent && (is_identified || carries[i])) carries[*joint.parent] = true;
  }
  return beyond;
}

/// Replaces the arm's dynamics by those of a report of pcavr identify robot.
Expected<void> use_identified(const std::string& report, QueriedArm& arm,
                              const Observer& observer) {
  Expected<IdentifiedArm> identified = read_identified_arm(report, arm.model);
  if (!identified) return identified.error();
  const Expected<std::vector<std::string>> beyond = joints_beyond(arm.model, identified->model);
  if (!beyond) {
    Error error = beyond.error();
    error.file = report;
    return error;
  }
  if (!beyond->empty()) {
    observer.on_warning(fmt::format("{}: joints that are not identified are held at 0: {}", report,
                                    fmt::join(*beyond, ", ")));
  }
  Eigen::VectorXd q(static_cast<Eigen::Index>(identified->model.dof));
  for (const RobotJoint& joint : identified->model.joints) {
    const std::size_t described = arm.model.joint_index(joint.name).value();
    if (joint.mimics) continue;
    q[static_cast<Eigen::Index>(joint.coordinate)] =
        arm.q[static_cast<Eigen::Index>(arm.model.joints[described].coordinate)];
  }
  arm.tip = identified->model.link_index(arm.model.links[arm.tip].name).value();
  arm.q = q;
  arm.model = std::move(identified->model);
  arm.friction = std::move(identified->joints);
  return {};
}

Expected<PredictedArm> read_arm(const PredictArguments& arguments, const Observer& observer) {
  Expected<PredictedArm> predicted =
      arguments.scene.empty() ? arm_of_description(arguments, observer) : arm_of_scene(arguments);
  if (!predicted) return predicted;
  QueriedArm& arm = predicted->arm;
  if (!arguments.identified.empty()) {
    if (auto used = use_identified(arguments.identified, arm, observer); !used) return used.error();
  }
  if (!arm.model.has_inertia()) {
    return Error{.message = "the arm's description has no masses",
                 .hint = "give what pcavr identify robot found with --identified"};
  }
  if (const Expected<void> set = set_start(arguments, arm); !set) return set.error();
  return predicted;
}

/// The scene's mesh as an obstacle, in the robot's frame.
Expected<void> add_obstacles(PredictedArm& predicted) {
  if (!predicted.scene) return {};
  if (!predicted.scene->is_scanned()) return {};  // built without images
  Expected<TriangleMesh> mesh = read_mesh(predicted.scene->folder / "mesh.ply");
  if (!mesh) return mesh.error();
  const Pose T_robot_base = predicted.T_base_robot.inverse();
  for (Eigen::Vector3f& vertex : mesh->vertices) {
    vertex = (T_robot_base * vertex.cast<double>()).cast<float>();
  }
  predicted.arm.obstacles.push_back(std::move(*mesh));
  return {};
}

std::string name_of_joint(const QueriedArm& arm, std::size_t coordinate) {
  return arm.model.joints[arm.model.coordinate_joints()[coordinate]].name;
}

void describe_answer(bool is_possible, const std::string& reason, const TorqueUse& torque,
                     const QueriedArm& arm, CommandResult& result) {
  result.summary = (is_possible ? "yes\n" : "no: " + reason + '\n') + result.summary;
  if (torque.ratio > 0.0) {
    result.summary += fmt::format("  torque: at most {:.0f} % of the limit, at joint {}\n",
                                  100.0 * torque.ratio, name_of_joint(arm, torque.joint));
  }
  result.json["is_possible"] = is_possible;
  result.is_no = !is_possible;
  if (!reason.empty()) result.json["reason"] = reason;
  if (torque.ratio > 0.0) {
    result.json["torque_ratio"] = torque.ratio;
    result.json["torque_joint"] = name_of_joint(arm, torque.joint);
  }
}

Expected<CommandResult> predict_reach(const PredictArguments& arguments,
                                      const ArmQueryOptions& options, const Observer& observer) {
  Expected<PredictedArm> predicted = read_arm(arguments, observer);
  if (!predicted) return predicted.error();
  if (const Expected<void> added = add_obstacles(*predicted); !added) return added.error();
  const Pose T_robot_base = predicted->T_base_robot.inverse();
  const Eigen::Vector3d p_base = vector_of(arguments.point);
  const Eigen::Vector3d v_base =
      arguments.velocity.empty() ? Eigen::Vector3d::Zero() : vector_of(arguments.velocity);
  const auto p_target = [&](double t) { return T_robot_base * (p_base + t * v_base); };
  const ReachAnswer answer = can_reach(predicted->arm, p_target, arguments.time, options);
  CommandResult result;
  result.json["time"] = answer.time;
  if (answer.min_time) {
    result.summary +=
        fmt::format("  the tip can be there after {:.3f} s at the earliest\n", *answer.min_time);
    result.json["min_time"] = *answer.min_time;
  }
  if (answer.error) {
    result.summary +=
        fmt::format("  at {:.3f} s: {:.2f} mm from the target\n", answer.time, 1e3 * *answer.error);
    result.json["error"] = *answer.error;
  }
  if (answer.speed_ratio > 0.0) {
    result.summary +=
        fmt::format("  speed: at most {:.0f} % of a joint's limit\n", 100.0 * answer.speed_ratio);
    result.json["speed_ratio"] = answer.speed_ratio;
  }
  describe_answer(answer.is_possible, answer.reason, answer.torque, predicted->arm, result);
  return result;
}

Expected<CommandResult> predict_hold(const PredictArguments& arguments,
                                     const ArmQueryOptions& options, const Observer& observer) {
  Expected<PredictedArm> predicted = read_arm(arguments, observer);
  if (!predicted) return predicted.error();
  const Eigen::Vector3d force_base = vector_of(arguments.force);
  if (force_base.norm() == 0.0) {
    return Error{.message = "--force is zero", .hint = "give the force of the tip, in newtons"};
  }
  const Pose T_robot_base = predicted->T_base_robot.inverse();
  const HoldAnswer answer = can_hold(predicted->arm, T_robot_base * vector_of(arguments.point),
                                     T_robot_base.rotation() * force_base, options);
  CommandResult result;
  if (answer.deflection) {
    result.summary =
        fmt::format("  the tip gives way by {:.2f} mm\n  at most {:.4g} N in this direction\n",
                    1e3 * *answer.deflection, answer.max_force);
    result.json["deflection"] = *answer.deflection;
    result.json["max_force"] = answer.max_force;
  }
  describe_answer(answer.is_possible, answer.reason, answer.torque, predicted->arm, result);
  return result;
}

/// The body's friction: from the parameter file.
Expected<FrictionParameters> body_of(const PredictArguments& arguments) {
  const Expected<ParameterTable> table = read_parameters(arguments.parameters);
  if (!table) return table.error();
  const auto found = table->find(arguments.object);
  const auto missing = [&](const std::string& what) {
    return Error{.message = "has no " + what + " of '" + arguments.object + "'",
                 .file = arguments.parameters,
                 .hint = "name an object of the file, identified by pcavr identify friction"};
  };
  if (found == table->end()) return missing("parameters");
  const ObjectParameters& known = found->second;
  if (!known.mass) return missing("mass");
  if (!known.sliding_friction_coefficient) return missing("sliding friction coefficient");
  const double coulomb =
      known.sliding_friction_coefficient->value * known.mass->value * kStandardGravity;
  FrictionParameters body{.mass = known.mass->value,
                          .limiting_force = coulomb,
                          .limiting_force_std = 0.0,
                          .coulomb_force = coulomb};
  if (known.limiting_static_friction) {
    body.limiting_force = known.limiting_static_friction->value;
  }
  if (known.viscous_friction) body.viscous = known.viscous_friction->value;
  if (!is_physical(body)) return missing("possible parameters");
  return body;
}

Expected<CommandResult> predict_push(const PredictArguments& arguments,
                                     const ArmQueryOptions& options, const Observer& observer) {
  Expected<PredictedArm> predicted = read_arm(arguments, observer);
  if (!predicted) return predicted.error();
  const Expected<FrictionParameters> body = body_of(arguments);
  if (!body) return body.error();
  const Eigen::Vector3d direction(arguments.direction[0], arguments.direction[1], 0.0);
  if (direction.norm() == 0.0) {
    return Error{.message = "--direction is zero", .hint = "give x and y of the push"};
  }
  const Pose T_robot_base = predicted->T_base_robot.inverse();
  const PushAnswer answer =
      can_push(predicted->arm, *body, arguments.distance, T_robot_base * vector_of(arguments.point),
               T_robot_base.rotation() * direction, options);
  CommandResult result;
  result.summary = fmt::format(
      "  it must leave the tip at {:.4f} m/s and slides for {:.3f} s\n"
      "  force: up to {:.4g} N over {:.0f} mm; the tip reaches {:.4f} m/s\n",
      answer.speed, answer.sliding_time, answer.force, 1e3 * options.run_up, answer.reached_speed);
  result.json["speed"] = answer.speed;
  result.json["sliding_time"] = answer.sliding_time;
  result.json["force"] = answer.force;
  result.json["reached_speed"] = answer.reached_speed;
  describe_answer(answer.is_possible, answer.reason, answer.torque, predicted->arm, result);
  return result;
}

CLI::Option* add_numbers(CLI::App& command, const std::string& name, Numbers& numbers, int count,
                         const InputRange& range, const std::string& what) {
  return command.add_option(name, numbers, what)->expected(count)->check(number_in(range));
}

constexpr InputRange kReachTime{"time", 0.001, 600.0, "s",
                                "one cycle of the controller; ten minutes"};
constexpr InputRange kPointSpeed{"speed", -100.0, 100.0, "m/s",
                                 "faster than anything that is caught"};
constexpr InputRange kPushDistance{"distance", 0.001, 10.0, "m", "a table's length"};

void add_arm_options(CLI::App& command, PredictArguments& arguments) {
  CLI::Option* robot = command.add_option("--robot", arguments.robot,
                                          "Robot description (URDF); it stands at base's origin");
  CLI::Option* scene =
      command.add_option("--scene", arguments.scene, "Scene from pcavr build, with its arm");
  robot->excludes(scene);
  command.add_option("--identified", arguments.identified,
                     "Report folder of pcavr identify robot: the arm's inertias and friction; by "
                     "default those of the description");
  command.add_option("--tip", arguments.tip, "Link that is the tip");
  command
      .add_option("--joints", arguments.joints,
                  "Where the arm is now [rad]; by default as in the scene, else at 0")
      ->expected(1, 64)
      ->check(number_in(ranges::kJoint));
  add_numbers(command, "--point", arguments.point, 3, ranges::kCoordinate,
              "x y z of the tip in base [m]")
      ->required();
}

constexpr char kExitCodes[] = "\nExit code: 0 yes, 3 no, 1 an input is wrong, 2 wrong usage.";

using Ask = Expected<CommandResult> (*)(const PredictArguments&, const ArmQueryOptions&,
                                        const Observer&);

/// One question: a subcommand.
std::shared_ptr<PredictArguments> add_question(CLI::App& predict, const char* name,
                                               const char* what, Ask ask,
                                               Configuration& configuration, Action& action,
                                               CLI::App*& command) {
  command = predict.add_subcommand(name, what);
  auto arguments = std::make_shared<PredictArguments>();
  add_arm_options(*command, *arguments);
  command->callback([arguments, ask, &configuration, &action] {
    if (arguments->robot.empty() && arguments->scene.empty()) {
      throw CLI::RequiredError("--robot or --scene");
    }
    action = [arguments, ask, &configuration](const Observer& observer) -> Expected<CommandResult> {
      ArmQueryOptions options = configuration.arm_query;
      options.drive = configuration.arm_drive;
      return ask(*arguments, options, observer);
    };
  });
  return arguments;
}

}  // namespace

void add_predict(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* predict = app.add_subcommand(
      "predict", "Can an arm do it? Answered by simulation of its identified dynamics");
  predict->require_subcommand(1);
  CLI::App* command = nullptr;
  const auto reach =
      add_question(*predict, "reach", "Can the tip be at a point, still or moving, in time?",
                   predict_reach, configuration, action, command);
  add_numbers(*command, "--velocity", reach->velocity, 3, kPointSpeed,
              "of the point in base [m/s]");
  add_number(*command, "--time", reach->time, kReachTime,
             "When the tip has to be there [s]; without it the earliest time is searched");
  command->footer("Example:\n  pcavr predict reach --robot arm.urdf --point 0.4 0.1 0.3 --time 1" +
                  std::string(kExitCodes));
  const auto hold = add_question(*predict, "hold", "Can the tip exert a force at a point?",
                                 predict_hold, configuration, action, command);
  add_numbers(*command, "--force", hold->force, 3, ranges::kForce,
              "of the tip on what it touches, in base [N]")
      ->required();
  command->footer(
      "Example:\n  pcavr predict hold --robot arm.urdf --point 0.4 0.1 0.3 --force 0 0 -40" +
      std::string(kExitCodes));
  const auto push = add_question(*predict, "push",
                                 "How fast must a body be pushed to slide a distance after it left "
                                 "the tip, and can the arm do it?",
                                 predict_push, configuration, action, command);
  command->add_option("--object", push->object, "The body's name in the parameter file")
      ->required();
  command->add_option("--parameters", push->parameters, "Parameter file from pcavr identify")
      ->required();
  add_number(*command, "--distance", push->distance, kPushDistance, "that it has to slide [m]")
      ->required();
  add_numbers(*command, "--direction", push->direction, 2, ranges::kCoordinate,
              "x y of the push in base")
      ->required();
  command->footer(
      "Example:\n  pcavr predict push --scene my_scene --object box --parameters "
      "my_parameters.yaml --point 0.4 0.1 0.05 --direction 0 1 --distance 0.3" +
      std::string(kExitCodes));
}

}  // namespace pcavr::app
