// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_collision.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "robot/wavy_ground.hpp"
#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

/// Suppression for the leak sanitizer: Assimp 5.2's Collada reader leaks what it had read of a
/// damaged file (nothing of an intact one). Without its symbols only the library can be named.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libassimp";
}

namespace pcavr {
namespace {

RobotModel six_axis_arm() {
  return read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf").value();
}

Eigen::Vector3d random_point(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

/// The least distance of points along a segment to points of a triangle.
double sampled_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const std::array<Eigen::Vector3d, 3>& t, int steps) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d p = a + (b - a) * (double(i) / steps);
    for (int u = 0; u <= steps; ++u) {
      for (int v = 0; u + v <= steps; ++v) {
        const Eigen::Vector3d on =
            t[0] + (t[1] - t[0]) * (double(u) / steps) + (t[2] - t[0]) * (double(v) / steps);
        least = std::min(least, (p - on).norm());
      }
    }
  }
  return least;
}

// Never more than the distance of sampled points, and no less than their spacing allows.
TEST(SegmentTriangleDistance, AgreesWithSampledPoints) {
  constexpr int kSteps = 24;
  Random random(5);
  for (int round = 0; round < 40; ++round) {
    const Eigen::Vector3d a = random_point(random);
    const Eigen::Vector3d b = random_point(random);
    const std::array<Eigen::Vector3d, 3> t{random_point(random), random_point(random),
                                           random_point(random)};
    const double distance = std::sqrt(segment_triangle_distance(a, b, t).squared);
    const double sampled = sampled_distance(a, b, t, kSteps);
    const double spacing = ((b - a).norm() + (t[1] - t[0]).norm() + (t[2] - t[0]).norm()) / kSteps;
    EXPECT_LE(distance, sampled + 1e-12) << "round " << round;
    EXPECT_GE(distance, sampled - spacing) << "round " << round;
  }
}

TEST(EnclosingCapsule, ContainsAllPointsAndIsSmall) {
  Random random(6);
  std::vector<Eigen::Vector3f> points;  // in a cylinder of radius 0.1 and length 1, tilted
  const Eigen::AngleAxisd tilt(0.7, Eigen::Vector3d(1.0, 2.0, 0.5).normalized());
  for (int i = 0; i < 4000; ++i) {
    const double angle = random.uniform(0.0, 2.0 * M_PI);
    const Eigen::Vector3d p(0.1 * std::cos(angle), 0.1 * std::sin(angle),
                            random.uniform(-0.5, 0.5));
    points.push_back((tilt * p).cast<float>());
  }
  const Capsule capsule = enclosing_capsule(points).value();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>();
    const SegmentDistance at = segment_segment_distance(capsule.a, capsule.b, p, p);
    EXPECT_LE(std::sqrt(at.squared), capsule.radius * (1.0 + 1e-9));
  }
  EXPECT_LT(capsule.radius, 0.125);  // the cylinder's, and what its flat ends cost
  EXPECT_LT((capsule.b - capsule.a).norm(), 1.01);
  EXPECT_FALSE(enclosing_capsule({}).has_value());
}

/// All triangles of a mesh, one by one.
double plain_distance(const RobotCollision& collision, const TriangleMesh& mesh,
                      const std::vector<std::size_t>& links) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [link, capsule] : collision.capsules()) {
    if (std::find(links.begin(), links.end(), link) == links.end()) continue;
    for (const auto& corner : mesh.triangles) {
      const SegmentDistance found = segment_triangle_distance(
          capsule.a, capsule.b,
          {mesh.vertices[corner[0]].cast<double>(), mesh.vertices[corner[1]].cast<double>(),
           mesh.vertices[corner[2]].cast<double>()});
      least = std::min(least, std::sqrt(found.squared) - capsule.radius);
    }
  }
  return least;
}

TEST(RobotCollision, TheDistanceToASurfaceIsThatOfAllItsTriangles) {
  const RobotModel model = six_axis_arm();
  const std::size_t tip = default_tip(model);
  RobotCollision collision(model, link_meshes(model).value().of_link, tip,
                           Eigen::VectorXd::Zero(6));
  const TriangleMesh ground = test::wavy_ground(24);
  collision.place_surface(collision.add_surface(ground), Pose());
  std::vector<std::size_t> links;  // that move, but not with the tip
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (model.links[i].joint && model.links[i].joint != model.links[tip].joint) links.push_back(i);
  }
  RobotDynamics kinematics(model);
  Random random(7);
  for (int round = 0; round < 20; ++round) {
    Eigen::VectorXd q(6);
    for (double& value : q) value = random.uniform(-1.5, 1.5);
    kinematics.forward_kinematics(q);
    collision.place_links(kinematics);
    const double plain = plain_distance(collision, ground, links);
    const std::optional<NearestPair> found = collision.distance_to_surfaces(10.0);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->distance, plain, 1e-9) << "round " << round;
    EXPECT_EQ(found->surface, 0U);
    EXPECT_FALSE(collision.distance_to_surfaces(plain - 1e-6).has_value());
  }
}

TEST(RobotCollision, AFoldedArmMeetsItself) {
  const RobotModel model = six_axis_arm();
  RobotCollision collision(model, link_meshes(model).value().of_link, default_tip(model),
                           Eigen::VectorXd::Zero(6));
  ASSERT_GT(collision.pairs(), 3U);
  RobotDynamics kinematics(model);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(6);
  kinematics.forward_kinematics(q);
  collision.place_links(kinematics);
  const double apart = collision.distance_to_itself().value().distance;
  EXPECT_GT(apart, 0.0);
  q << 0.0, 1.9, 1.2, 0.0, 1.5, 0.0;  // the wrist turned back to the base
  double least = apart;
  for (double part = 0.0; part <= 1.0; part += 0.02) {
    const Eigen::VectorXd at = part * q;
    kinematics.forward_kinematics(at);
    collision.place_links(kinematics);
    least = std::min(least, collision.distance_to_itself().value().distance);
  }
  EXPECT_LT(least, apart);
}

/// An arm over a ground at z = 0.05 m whose tip is commanded along a line, 1 ms a step.
class FollowerTest : public testing::Test {
 protected:
  FollowerTest() {
    const RobotModel model = six_axis_arm();
    const std::size_t tip = default_tip(model);
    Eigen::VectorXd q(6);
    q << 0.0, 0.3, 0.2, 0.0, 0.6, 0.0;
    follower.emplace(model, link_meshes(model).value().of_link, tip, q);
    ground = follower->add_surface(test::wavy_ground(40));
    follower->place_surface(ground, Pose::from_translation({0.0, 0.0, -0.1}));
    follower->reset();
    start = follower->T_base_tip().translation();
  }
  void move(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int cycles) {
    for (int i = 1; i <= cycles; ++i) {
      follower->follow(from + (to - from) * (double(i) / cycles), 0.001);
      if (follower->state().nearest) least = std::min(least, follower->state().nearest->distance);
      stopped += follower->state().is_stopped ? 1 : 0;
    }
  }

  std::optional<ArmFollower> follower;
  std::size_t ground = 0;
  Eigen::Vector3d start;
  double least = std::numeric_limits<double>::infinity();
  int stopped = 0;
};

TEST_F(FollowerTest, TheTipFollowsACommandedPoint) {
  const Eigen::Vector3d to = start + Eigen::Vector3d(-0.05, 0.1, 0.05);
  move(start, to, 500);
  EXPECT_TRUE(follower->state().is_reached);
  EXPECT_LT((follower->T_base_tip().translation() - to).norm(), 1e-4);
  EXPECT_EQ(stopped, 0);
}

TEST_F(FollowerTest, ACommandThatWouldCollideIsStoppedBeforeItDoes) {
  const Eigen::Vector3d below = start - Eigen::Vector3d(0.0, 0.0, 0.9);
  move(start, below, 1500);
  EXPECT_TRUE(follower->state().is_stopped);
  EXPECT_GE(least, ArmFollowerOptions().stop_distance);
  ASSERT_TRUE(follower->state().nearest.has_value());
  EXPECT_LT(follower->state().nearest->distance, 0.02);
  const int while_stopped = stopped;
  EXPECT_GT(while_stopped, 0);
  move(below, start, 1500);  // and it goes on when the command leads away
  EXPECT_TRUE(follower->state().is_reached);
  EXPECT_GE(least, ArmFollowerOptions().stop_distance);
}

TEST(LinkMeshes, ShapesAreDrawnAndMissingFilesBecomeRods) {
  const RobotModel model = six_axis_arm();
  const LinkMeshes drawn = link_meshes(model).value();
  EXPECT_TRUE(drawn.warnings.empty());
  const std::string text =
      "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://x/a.stl'/>"
      "</geometry></visual></link><link name='b'/><joint name='j' type='revolute'>"
      "<parent link='a'/><child link='b'/><origin xyz='0 0 0.5'/><axis xyz='0 0 1'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  const RobotModel plain = parse_urdf(text, "r.urdf").value();
  const LinkMeshes rods = link_meshes(plain).value();
  ASSERT_EQ(rods.warnings.size(), 1U);
  EXPECT_NEAR(bounds(rods.of_link[0].vertices).max().z(), 0.5F, 1e-6F);
  EXPECT_NEAR(signed_volume(rods.of_link[0]), M_PI * 0.04 * 0.04 * 0.5, 2e-5);
  EXPECT_TRUE(rods.of_link[1].triangles.empty());
}

/// A tetrahedron with a vertex at the origin and edges of 200, 300 and 400 units along x, y and z.
std::string collada_tetrahedron(const std::string& unit, const std::string& up_axis) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset><unit name='u' meter='" +
         unit + "'/><up_axis>" + up_axis +
         "</up_axis></asset><library_geometries><geometry id='g'><mesh><source id='p'>"
         "<float_array id='a' count='12'>0 0 0 200 0 0 0 300 0 0 0 400</float_array>"
         "<technique_common><accessor source='#a' count='4' stride='3'><param name='X' "
         "type='float'/><param name='Y' type='float'/><param name='Z' type='float'/></accessor>"
         "</technique_common></source><vertices id='v'><input semantic='POSITION' source='#p'/>"
         "</vertices><triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/>"
         "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id='s'><node id='n'><instance_geometry url='#g'/>"
         "</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/>"
         "</scene></COLLADA>";
}

// The file's unit counts, its up axis does not, as in RViz.
TEST(LinkMeshes, ColladaFilesAreReadInMetresOnTheirOwnAxes) {
  const TemporaryFolder folder;
  const std::string urdf =
      "<robot name='r'><link name='a'><visual><geometry><mesh filename='link.dae'/></geometry>"
      "</visual></link><link name='b'/><joint name='j' type='revolute'><parent link='a'/>"
      "<child link='b'/><origin xyz='0 0 0.5'/><axis xyz='0 0 1'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  ASSERT_TRUE(write_file(folder.path() / "r.urdf", urdf));
  for (const std::string up_axis : {"Z_UP", "Y_UP", "X_UP"}) {
    ASSERT_TRUE(write_file(folder.path() / "link.dae", collada_tetrahedron("0.001", up_axis)));
    const RobotModel model = read_urdf(folder.path() / "r.urdf").value();
    const Expected<LinkMeshes> drawn = link_meshes(model);
    ASSERT_TRUE(drawn) << drawn.error().to_string();
    EXPECT_TRUE(drawn->warnings.empty());
    const TriangleMesh& mesh = drawn->of_link[0];
    EXPECT_LT((bounds(mesh.vertices).max() - Eigen::Vector3f(0.2F, 0.3F, 0.4F)).norm(), 1e-6F)
        << up_axis << bounds(mesh.vertices).max().transpose();
    EXPECT_NEAR(signed_volume(mesh), 0.2 * 0.3 * 0.4 / 6.0, 1e-8) << up_axis;
  }
}

TEST(LinkMeshes, TruncatedAndDamagedColladaIsReadOrRejected) {
  const TemporaryFolder folder;
  const std::string text = collada_tetrahedron("0.001", "Z_UP");
  Random random(4);
  int errors = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = text;
    if (i % 3 == 0) damaged.resize(random.below(text.size()));
    for (int k = 0; k < i % 3; ++k) {
      damaged[random.below(damaged.size())] = "0'<>9- /#"[random.below(9)];
    }
    ASSERT_TRUE(write_file(folder.path() / "damaged.dae", damaged));
    errors += read_mesh(folder.path() / "damaged.dae") ? 0 : 1;
  }
  EXPECT_GT(errors, 50);
}

/// The tetrahedron's node within `depth` others.
std::string nested_tetrahedron(int depth) {
  std::string text = collada_tetrahedron("0.001", "Z_UP");
  const std::string node = "<node id='n'>", end = "</node>";
  std::string nodes, ends = "<!-- <node> -->";
  for (int i = 0; i < depth; ++i) {
    nodes += "<node name=\"a>'/\"><extra/>";
    ends += end;
  }
  text.insert(text.find(end) + end.size(), ends);
  text.insert(text.find(node), nodes);
  return text;
}

TEST(LinkMeshes, NestedColladaIsReadAsFarAsItIsSafe) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "nested.dae";
  for (const int depth : {0, 50, 990, 1000}) {
    ASSERT_TRUE(write_file(file, nested_tetrahedron(depth)));
    const auto mesh = read_mesh(file);
    EXPECT_EQ(mesh.has_value(), depth < 1000) << depth;
    if (mesh) {
      EXPECT_EQ(mesh->triangles.size(), 4U);
    }
  }
}

TEST(LinkMeshes, DeeplyNestedColladaIsAnError) {
  const TemporaryFolder folder;
  std::string nodes;
  for (int i = 0; i < 100000; ++i) nodes += "<node>";
  ASSERT_TRUE(write_file(folder.path() / "deep.dae",
                         "<COLLADA version='1.4.1'><library_visual_scenes>" + nodes));
  const auto mesh = read_mesh(folder.path() / "deep.dae");
  ASSERT_FALSE(mesh);
  EXPECT_NE(mesh.error().message.find("nested too deeply"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
