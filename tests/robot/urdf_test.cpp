// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/urdf.hpp"

#include <fstream>
#include <numbers>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "fuzz/targets.hpp"
#include "support/shared_data.hpp"
#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

const std::string kInertia =
    "<inertial><mass value='2'/><origin xyz='0 0 0.1'/>"
    "<inertia ixx='0.02' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.01'/></inertial>";

std::string link(const std::string& name, const std::string& content = kInertia) {
  return "<link name='" + name + "'>" + content + "</link>\n";
}

std::string joint(
    const std::string& name, const std::string& parent, const std::string& child,
    const std::string& type = "revolute",
    const std::string& content = "<limit lower='-1' upper='2' velocity='3' effort='40'/>") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/><origin xyz='0.1 0 0.3' rpy='0 0 0'/>" +
         "<axis xyz='0 1 0'/>" + content + "</joint>\n";
}

std::string robot(const std::string& content) {
  return "<robot name='r'>\n" + content + "</robot>\n";
}

Expected<RobotModel> parse(const std::string& content, const UrdfOptions& options = {}) {
  return parse_urdf(robot(content), "the.urdf", options);
}

/// The one line that a user sees.
std::string error_line(const std::string& content, const UrdfOptions& options = {}) {
  const Expected<RobotModel> model = parse(content, options);
  return model ? "no error" : model.error().to_string();
}

TEST(Urdf, ReadsJointsLimitsAndInertias) {
  const Expected<RobotModel> model =
      parse(link("base", "") + link("upper") + link("plate") + joint("shoulder", "base", "upper") +
            joint("weld", "upper", "plate", "fixed", ""));
  ASSERT_TRUE(model) << model.error().to_string();
  ASSERT_EQ(model->joints.size(), 1U);
  const RobotJoint& shoulder = model->joints[0];
  EXPECT_EQ(shoulder.name, "shoulder");
  EXPECT_EQ(shoulder.axis, Eigen::Vector3d::UnitY());
  EXPECT_EQ(shoulder.limits.lower, -1.0);
  EXPECT_EQ(shoulder.limits.upper, 2.0);
  EXPECT_EQ(shoulder.limits.velocity, 3.0);
  EXPECT_EQ(shoulder.limits.effort, 40.0);
  // Two bodies of 2 kg, the second 0.1, 0, 0.3 from the first.
  EXPECT_EQ(shoulder.body.mass, 4.0);
  EXPECT_TRUE(shoulder.body.centre_of_mass.isApprox(Eigen::Vector3d(0.05, 0.0, 0.25)));
  EXPECT_NEAR(shoulder.body.inertia_at_com(1, 1), 2 * 0.02 + 4.0 * (0.05 * 0.05 + 0.15 * 0.15),
              1e-15);
  ASSERT_EQ(model->links.size(), 3U);
  EXPECT_EQ(model->links[2].joint, 0U);
  EXPECT_TRUE(model->warnings.empty());
}

TEST(Urdf, KeepsTheOrderOfTheFile) {
  const Expected<RobotModel> model =
      parse(link("a") + link("c") + link("b") + joint("z", "a", "b") + joint("y", "a", "c"));
  ASSERT_TRUE(model);
  EXPECT_EQ(model->joints[0].name, "z");
  EXPECT_EQ(model->joints[1].name, "y");
  EXPECT_EQ(model->joint_index("y"), 1U);
  EXPECT_EQ(model->joint_index("x"), std::nullopt);
  EXPECT_EQ(model->link_index("c"), 2U);
}

TEST(Urdf, MimicJointsShareACoordinate) {
  const std::string limit = "<limit lower='0' upper='0.04' velocity='1' effort='20'/>";
  const Expected<RobotModel> model = parse(
      link("hand") + link("left") + link("right") + link("tip") +
      joint("right", "hand", "right", "prismatic",
            limit + "<mimic joint='left' multiplier='-2' offset='0.01'/>") +
      joint("tip", "hand", "tip", "prismatic", limit + "<mimic joint='right' multiplier='3'/>") +
      joint("left", "hand", "left", "prismatic", limit));
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_EQ(model->dof, 1U);
  const RobotJoint& tip = model->joints[model->joint_index("tip").value()];
  EXPECT_EQ(tip.coordinate, 0U);
  EXPECT_DOUBLE_EQ(tip.multiplier, -6.0);
  EXPECT_DOUBLE_EQ(tip.offset, 0.03);
  EXPECT_EQ(model->coordinate_joints(),
            std::vector<std::size_t>{model->joint_index("left").value()});
}

TEST(Urdf, FaultsOfTheTreeHaveTheirPlace) {
  const std::string two = link("a") + link("b");
  EXPECT_EQ(error_line(two + joint("j", "a", "b") + joint("k", "b", "a")),
            "the.urdf:5: joint 'k': the links form a loop: 'a' - 'b' - 'a'; closed chains are not "
            "supported; remove one of the joints");
  EXPECT_EQ(
      error_line(two + link("c") + joint("j", "a", "c") + joint("k", "b", "c")),
      "the.urdf:6: joint 'k': link 'c' has two parents: it is the child of joint 'j' (line 5), "
      "too; closed chains are not supported; remove one of the two joints");
  EXPECT_EQ(
      error_line(two),
      "the.urdf:3: link 'b': is a second root link: no joint leads to it, nor to 'a' (line 2); "
      "connect it by a joint, or remove it");
  EXPECT_EQ(
      error_line(two + link("a") + joint("j", "a", "b")),
      "the.urdf:4: link 'a': the name is used in line 2, too; rename one of the two links, and "
      "what refers to it");
  EXPECT_EQ(error_line(two + link("c") + joint("j", "a", "b") + joint("j", "b", "c")),
            "the.urdf:6: joint 'j': the name is used in line 5, too; rename one of the two joints, "
            "and what refers to it");
  EXPECT_EQ(
      error_line(two + joint("j", "a", "elbow")),
      "the.urdf:4: joint 'j': child link 'elbow' does not exist; add <link name=\"elbow\"/>, or "
      "correct the name");
  EXPECT_EQ(error_line(link("a") + joint("j", "a", "a")),
            "the.urdf:3: joint 'j': connects link 'a' with itself; parent and child must differ");
  EXPECT_EQ(
      error_line(two + joint("j", "a", "b", "floating", "")),
      "the.urdf:4: joint 'j': type 'floating' is not supported; the base is fixed; connect the "
      "link by a fixed joint");
  // A loop beside a sound tree.
  EXPECT_NE(error_line(two + link("c") + link("d") + joint("j", "a", "b") + joint("k", "c", "d") +
                       joint("l", "d", "c"))
                .find("form a loop: 'c' - 'd' - 'c'"),
            std::string::npos);
}

TEST(Urdf, FaultsOfJointsHaveTheirPlace) {
  const std::string two = link("a") + link("b");
  EXPECT_EQ(
      error_line(two + joint("j", "a", "b", "revolute",
                             "<limit lower='2' upper='-1' velocity='3' effort='40'/>")),
      "the.urdf:4: joint 'j': limits reversed: lower 2 is above upper -1; swap lower and upper");
  EXPECT_NE(error_line(two + joint("j", "a", "b", "revolute", "")).find("the.urdf:4: joint 'j': "),
            std::string::npos);
  EXPECT_EQ(error_line(two + joint("j", "a", "b", "continuous", "<mimic joint='k'/>")),
            "the.urdf:4: joint 'j': mimics 'k', which is no movable joint; correct the name in its "
            "<mimic>");
  EXPECT_EQ(
      error_line(two + joint("j", "a", "b", "continuous", "<mimic joint='j'/>")),
      "the.urdf:4: joint 'j': mimics itself, by way of others; one of the joints must move of "
      "its own");
  EXPECT_EQ(
      error_line(two + "<joint name='j' type='continuous'><parent link='a'/>"
                       "<child link='b'/><axis xyz='0 0 0'/></joint>"),
      "the.urdf:4: joint 'j': axis has no direction; set <axis xyz=\"...\"/> to a vector other "
      "than zero");
}

TEST(Urdf, InertiasThatAreNoNumbersAreErrors) {
  const auto line_with = [](const std::string& mass, const std::string& ixx) {
    return error_line(link("a", "<inertial><mass value='" + mass + "'/><inertia ixx='" + ixx +
                                    "' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"));
  };
  for (const std::string text : {"nan", "inf", "-inf", "2.0kg", "1,5", ""}) {
    EXPECT_EQ(line_with(text, "1"),
              "the.urdf:2: link 'a': value of <mass> is '" + text +
                  "', not a finite number; correct its <inertial>; units are kg and m");
    EXPECT_EQ(line_with("1", text),
              "the.urdf:2: link 'a': ixx of <inertia> is '" + text +
                  "', not a finite number; correct its <inertial>; units are kg and m");
  }
  EXPECT_TRUE(parse_urdf("<robot name='r'>\n" +
                             link("a",
                                  "<inertial><mass value=' 1e-3'/><inertia "
                                  "ixx='+1' ixy='0' ixz='0' iyy='1' iyz='0' "
                                  "izz='1'/></inertial>") +
                             "</robot>",
                         "the.urdf", {}));
}

TEST(Urdf, ShapesThatAreNotUnderstoodAreErrorsAndTheOthersDoNotGetLost) {
  const std::string sphere = "<geometry><sphere radius='0.1'/></geometry>";
  const struct {
    std::string shape;
    std::string message;
  } cases[] = {
      {"<visual><origin xyz='0 q 0'/>" + sphere + "</visual>",
       "Unable to parse component [q] to a double (while parsing a vector value); Could not parse "
       "visual element for Link [b]"},
      {"<visual><origin rpy='0 0'/>" + sphere + "</visual>",
       "Parser found 2 elements but 3 expected while parsing vector [0 0]; Could not parse visual "
       "element for Link [b]"},
      {"<collision><geometry><sphere radius='x'/></geometry></collision>",
       "radius [x] is not a valid float; Could not parse collision element for Link [b]"},
  };
  // White space behind a number is refused, too: the link's mass would be lost, and the shapes.
  EXPECT_EQ(error_line(link("a", "<inertial><mass value='1 '/></inertial>")).substr(0, 76),
            "the.urdf:2: link 'a': Inertial: mass [1 ] is not a float; Could not parse in");
  for (const auto& [shape, message] : cases) {
    EXPECT_EQ(error_line(link("a") + link("b", shape + "<collision>" + sphere + "</collision>") +
                         joint("j", "a", "b")),
              "the.urdf:3: link 'b': " + message +
                  "; check it by check_urdf of Debian's liburdfdom-tools");
  }
}

TEST(Urdf, MaterialsThatAreNotDefinedDoNotMatter) {
  const std::string visual =
      "<visual><geometry><sphere radius='0.1'/></geometry><material name='silver'/></visual>";
  const Expected<RobotModel> arm =
      parse_urdf("<robot name='r'>\n" + link("a", visual) + "</robot>", "the.urdf", {});
  ASSERT_TRUE(arm) << arm.error().to_string();
  EXPECT_EQ(arm->links.front().visuals.size(), 1U);
}

TEST(Urdf, UnlikelyInertiasAreErrorsOnlyWhereWanted) {
  const auto arm = [](const std::string& mass, const std::string& moments) {
    return link("a") +
           link("b", "<inertial><mass value='" + mass + "'/><inertia " + moments +
                         " ixy='0' ixz='0' iyz='0'/></inertial>") +
           joint("j", "a", "b");
  };
  const struct {
    std::string content;
    std::string message;
  } cases[] = {
      {arm("0", "ixx='1' iyy='1' izz='1'"), "mass 0 kg is not positive"},
      {arm("1", "ixx='1' iyy='1' izz='3'"),
       "inertia violates the triangle inequality: principal moments 1 + 1 < 3 kg m^2"},
      {arm("1", "ixx='1' iyy='-0.1' izz='1'"),
       "inertia is not positive definite: principal moments -0.1, 1, 1 kg m^2"},
      {arm("2", "ixx='0' iyy='0' izz='0'"), "mass is 2 kg, and the inertia 0"},
  };
  for (const auto& [content, message] : cases) {
    EXPECT_EQ(error_line(content, {.requires_inertia = true}),
              "the.urdf:3: link 'b': " + message + "; correct its <inertial>");
    const Expected<RobotModel> model = parse(content);
    ASSERT_TRUE(model);
    EXPECT_EQ(model->warnings.front().message, message);
  }
  EXPECT_EQ(error_line(arm("-1", "ixx='1' iyy='1' izz='1'")),
            "the.urdf:3: link 'b': mass -1 kg is negative; correct its <inertial>, or leave it out "
            "for kinematics");
  EXPECT_EQ(
      error_line(link("a") + link("b", "") + joint("j", "a", "b"), {.requires_inertia = true}),
      "the.urdf: no moving link has an inertia; enough for kinematics; dynamics need <inertial> "
      "in each moving link");
}

TEST(Urdf, NumbersBeyondAnyRobotAreErrors) {
  const auto with_dynamics = [](const std::string& dynamics) {
    return error_line(link("a") + link("b") +
                      joint("j", "a", "b", "revolute",
                            "<limit lower='-1' upper='2' velocity='3' effort='40'/><dynamics " +
                                dynamics + "/>"));
  };
  EXPECT_EQ(with_dynamics("damping='10' friction='0'"), "no error");
  for (const char* value : {"-20", "1e9"}) {
    for (const std::string name : {"damping", "friction"}) {
      const std::string line = with_dynamics(name + "='" + value + "'");
      EXPECT_NE(line.find("joint 'j': " + name + " of <dynamics> is "), std::string::npos) << line;
    }
  }
  const auto shape = [](const std::string& origin, const std::string& geometry) {
    return error_line(
        link("a", "<visual>" + origin + "<geometry>" + geometry + "</geometry></visual>"));
  };
  for (const std::string& line : {with_dynamics("damping='nan'"), with_dynamics("friction='inf'"),
                                  shape("<origin xyz='0 nan 0'/>", "<sphere radius='1'/>"),
                                  shape("<origin rpy='0 1e999 0'/>", "<sphere radius='1'/>"),
                                  shape("", "<box size='1 inf 1'/>"),
                                  shape("", "<mesh filename='m.stl' scale='1 1 nan'/>")}) {
    EXPECT_NE(line.find("not a finite number"), std::string::npos) << line;
  }
  EXPECT_NE(shape("", "<sphere radius='1e30'/>").find("is 10000 or more"), std::string::npos);
  EXPECT_NE(shape("", "<sphere radius='-1'/>").find("is not positive"), std::string::npos);
}

TEST(Urdf, ShapesWithoutExtentAreLeftOut) {
  const auto part = [](const std::string& kind, const std::string& geometry) {
    return "<" + kind + "><geometry>" + geometry + "</geometry></" + kind + ">";
  };
  const Expected<RobotModel> model =
      parse(link("a", part("visual", "<cylinder radius='0.1' length='0'/>") +
                          part("visual", "<box size='1 2 3'/>") +
                          part("visual", "<mesh filename='m.stl' scale='0 0 0'/>") +
                          part("collision", "<sphere radius='0'/>")));
  ASSERT_TRUE(model) << model.error().to_string();
  ASSERT_EQ(model->links[0].visuals.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<BoxShape>(model->links[0].visuals[0].geometry));
  EXPECT_TRUE(model->links[0].collisions.empty());
  std::string text;
  for (const Error& warning : model->warnings) text += warning.to_string() + "\n";
  for (const char* which : {"visual 1: ", "visual 3: ", "collision 1: "}) {
    EXPECT_NE(text.find(std::string(which) + "a dimension or scale is 0: it is left out"),
              std::string::npos)
        << text;
  }
}

TEST(Urdf, MeshesElsewhereOnTheDiskAreNotRead) {
  const TemporaryFolder folder;
  const std::filesystem::path own = folder.path() / "work" / "mine";
  std::filesystem::create_directories(own);
  std::filesystem::create_directories(folder.path() / "secrets");
  const std::filesystem::path secret = folder.path() / "secrets/key.stl";
  std::ofstream(secret) << "solid";
  const auto found = [&](const std::string& reference, const UrdfOptions& options = {}) {
    const Expected<RobotModel> model =
        parse_urdf(robot(link("a", "<visual><geometry><mesh filename='" + reference +
                                       "'/></geometry></visual>")),
                   own / "arm.urdf", options);
    if (!model->warnings.empty()) {
      EXPECT_NE(model->warnings[0].message.find("outside the description's folder"),
                std::string::npos)
          << model->warnings[0].message;
    }
    return std::get<MeshShape>(model->links[0].visuals[0].geometry).file;
  };
  for (const std::string& reference :
       {secret.string(), "file://" + secret.string(), std::string("../../secrets/key.stl"),
        std::string("package://mine/../../secrets/key.stl"),
        std::string("package://secrets/key.stl")}) {
    EXPECT_EQ(found(reference), "") << reference;
  }
  const UrdfOptions given{.package_folders = {folder.path() / "secrets"}};
  EXPECT_EQ(found("file://" + secret.string(), given), secret);
  // A folder that says that it is a package may be found farther up.
  std::ofstream(folder.path() / "secrets/package.xml") << "<package/>";
  EXPECT_EQ(found("package://secrets/key.stl"), secret);
}

TEST(Urdf, OtherFilesAreErrors) {
  const auto line = [](const std::string& text) {
    return parse_urdf(text, "the.urdf").error().to_string();
  };
  const std::string hint = "; a robot description in URDF is expected";
  EXPECT_EQ(line(""), "the.urdf: is empty" + hint);
  EXPECT_EQ(line("t,q1,q2\n0,1,2\n").substr(0, 20), "the.urdf: is not XML");
  EXPECT_EQ(line("<robot name='r'>\n<link name='a'>\n</robot>").substr(0, 22),
            "the.urdf:3: is not XML");
  EXPECT_EQ(line("<sdf/>"), "the.urdf:1: has no <robot>" + hint);
  EXPECT_EQ(line("<robot name='r'/>"),
            "the.urdf:1: robot: has no <link>; a description has links, connected by joints");
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  EXPECT_EQ(line(deep), "the.urdf: is not URDF: elements nested more than 100 deep" + hint);
  EXPECT_EQ(
      line("<robot name='r'><xacro:arm/></robot>"),
      "the.urdf:1: robot: is a xacro macro, not URDF; expand it first: xacro FILE > robot.urdf");
  EXPECT_NE(read_urdf("no/such.urdf").error().to_string().find("no/such.urdf"), std::string::npos);
}

TEST(Urdf, PassesTheFuzzersChecks) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(source_folder() / "tests/fuzz/corpus/urdf")) {
    const auto bytes = read_file(entry.path());
    ASSERT_TRUE(bytes);
    EXPECT_NO_THROW(fuzz::urdf(*bytes)) << entry.path();
    // The file is truncated at every 7th byte, too: a description is long.
    for (std::size_t i = 0; i < bytes->size(); i += 7) {
      EXPECT_NO_THROW(fuzz::urdf(std::string_view(*bytes).substr(0, i))) << entry.path() << i;
    }
    ++files;
  }
  EXPECT_GE(files, 4);
}

TEST(Urdf, MeshesAreFoundByPackageFileAndPath) {
  const TemporaryFolder folder;
  const std::filesystem::path package = folder.path() / "arm_description";
  std::filesystem::create_directories(package / "urdf");
  std::filesystem::create_directories(package / "meshes");
  const std::filesystem::path mesh = package / "meshes/link.stl";
  std::ofstream(mesh) << "solid";
  const auto resolved = [&](const std::string& reference, const UrdfOptions& options = {},
                            const std::filesystem::path& place = "arm_description/urdf/arm.urdf") {
    const Expected<RobotModel> model =
        parse_urdf(robot(link("a", "<visual><geometry><mesh filename='" + reference +
                                       "' scale='0.001 0.001 0.001'/></geometry></visual>")),
                   folder.path() / place, options);
    if (!model) return model.error().message;
    return std::get<MeshShape>(model->links[0].visuals.at(0).geometry)
        .file.lexically_normal()
        .string();
  };
  const std::string by_package = "package://arm_description/meshes/link.stl";
  EXPECT_EQ(resolved(by_package), mesh);
  EXPECT_EQ(resolved("../meshes/link.stl"), mesh);
  EXPECT_EQ(resolved("file://" + mesh.string()), mesh);
  EXPECT_EQ(resolved(by_package, {}, "elsewhere.urdf"), mesh);  // its folder holds the package
  EXPECT_EQ(resolved(by_package, {.package_folders = {folder.path()}}, "/other/arm.urdf"), mesh);
  EXPECT_EQ(resolved(by_package, {.package_folders = {package}}, "/other/arm.urdf"), mesh);
  EXPECT_EQ(resolved("package://arm_description/../../etc"), "");
  EXPECT_EQ(resolved("no.stl"), "");
  EXPECT_EQ(resolved("no.stl", {.requires_meshes = true}), "visual 1: no mesh at no.stl");
}

TEST(Urdf, LockedJointsKeepTheMotionOfTheOthers) {
  const RobotModel arm = read_urdf(source_folder() / "calib/robots/pa10/pa10.urdf").value();
  const RobotModel locked = lock_joints(arm, {{"joint3", 0.4}, {"joint7", -1.0}});
  ASSERT_EQ(locked.dof, 5U);
  EXPECT_EQ(locked.joint_index("joint3"), std::nullopt);
  RobotDynamics whole(arm);
  RobotDynamics reduced(locked);
  Eigen::VectorXd q(7);
  q << 0.3, -0.5, 0.4, 1.1, 0.2, -0.7, -1.0;
  Eigen::VectorXd dq(7);
  dq << 1.0, 0.5, 0.0, -0.6, 2.0, 0.3, 0.0;
  const std::vector<Eigen::Index> free{0, 1, 3, 4, 5};
  Eigen::VectorXd tau(7);
  Eigen::VectorXd tau_free(5);
  whole.inverse_dynamics(q, dq, dq, tau);
  reduced.inverse_dynamics(q(free), dq(free), dq(free), tau_free);
  EXPECT_LT((tau_free - tau(free)).norm(), 1e-12);
  whole.forward_kinematics(q);
  reduced.forward_kinematics(q(free));
  const std::size_t tool = arm.link_index("tool").value();
  EXPECT_LT((whole.T_base_link(tool).matrix() - reduced.T_base_link(tool).matrix()).norm(), 1e-14);
  EXPECT_THROW((void)lock_joints(arm, {{"elbow", 0.0}}), ContractError);
}

// The modified Denavit-Hartenberg table of paper A, multiplied out.
TEST(Pa10, IsWhereItsTableSays) {
  const RobotModel arm =
      read_urdf(source_folder() / "calib/robots/pa10/pa10.urdf", {.requires_inertia = true})
          .value();
  EXPECT_TRUE(arm.warnings.empty());
  EXPECT_TRUE(arm.has_inertia());
  ASSERT_EQ(arm.dof, 7U);
  const double alpha[] = {0.0, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5};  // times pi
  const double d[] = {0.315, 0.0, 0.45, 0.0, 0.5, 0.0, 0.08};
  Eigen::VectorXd q(7);
  q << 0.3, -0.5, 0.9, 1.1, 0.2, -0.7, 2.0;
  RobotDynamics dynamics(arm);
  dynamics.forward_kinematics(q);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 7; ++i) {
    T = T * Eigen::AngleAxisd(alpha[i] * std::numbers::pi, Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(q[i], Eigen::Vector3d::UnitZ()) * Eigen::Translation3d(0.0, 0.0, d[i]);
    const std::size_t index = arm.link_index("link" + std::to_string(i + 1)).value();
    EXPECT_LT((dynamics.T_base_link(index).matrix() - T.matrix()).norm(), 1e-14) << i;
  }
  double mass = 0.0;
  for (const RobotJoint& joint : arm.joints) mass += joint.body.mass;
  EXPECT_NEAR(mass, 31.16, 1e-12);
}

TEST(Irb120Like, IsSoundAndReachesItsWrist) {
  const RobotModel arm = read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf",
                                   {.requires_inertia = true})
                             .value();
  EXPECT_TRUE(arm.warnings.empty());
  ASSERT_EQ(arm.dof, 6U);
  RobotDynamics dynamics(arm);
  dynamics.forward_kinematics(Eigen::VectorXd::Zero(6));
  const Pose T_base_tool = dynamics.T_base_link(arm.link_index("tool").value());
  EXPECT_TRUE(T_base_tool.translation().isApprox(Eigen::Vector3d(0.374, 0.0, 0.63)));
}

TEST(SharedRobots, AreReadWithTheirDoubts) {
  PCAVR_NEEDS_SHARED_DATA("real/robots");
  const auto warnings = [](const RobotModel& model) {
    std::string text;
    for (const Error& warning : model.warnings) text += warning.to_string() + "\n";
    return text;
  };
  const RobotModel panda = read_urdf(shared_data("real/robots/panda/panda.urdf")).value();
  EXPECT_EQ(panda.joints.size(), 9U);
  EXPECT_EQ(panda.dof, 8U);
  EXPECT_FALSE(panda.has_inertia());
  EXPECT_NE(warnings(panda).find("no moving link has an inertia"), std::string::npos);
  const RobotModel pa10 = read_urdf(shared_data("real/robots/pa10/pa10.urdf")).value();
  EXPECT_EQ(pa10.dof, 7U);
  EXPECT_NE(warnings(pa10).find("placeholders"), std::string::npos);
  EXPECT_NE(warnings(pa10).find("continuous, yet limited"), std::string::npos);
  EXPECT_FALSE(read_urdf(shared_data("real/robots/pa10/pa10.urdf"), {.requires_inertia = true}));
  const RobotModel irb120 =
      read_urdf(shared_data("real/robots/irb120/irb120_3_58.urdf"), {.requires_inertia = true})
          .value();
  EXPECT_EQ(irb120.dof, 6U);
  EXPECT_EQ(irb120.joints[0].limits.effort, std::nullopt);
  EXPECT_NE(warnings(irb120).find("no limit of effort"), std::string::npos);
  EXPECT_NE(warnings(irb120).find("link 'link_6': inertia is 0.001 kg m^2 about all axes"),
            std::string::npos);
  EXPECT_NE(warnings(irb120).find("no mesh at package://"), std::string::npos);
  EXPECT_FALSE(read_urdf(shared_data("real/robots/irb120/irb120_3_58_macro.xacro")));
}

}  // namespace
}  // namespace pcavr
