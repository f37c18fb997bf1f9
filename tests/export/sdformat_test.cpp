// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What Gazebo's reader makes of an exported SDF world.
#include <string>

#include <gtest/gtest.h>
#include <sdf/Collision.hh>
#include <sdf/Element.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>

#include "pcavr/results/export/write_export.hpp"

#include "export/exported_box.hpp"

namespace pcavr {
namespace {

TEST(ExportedSdf, IsReadBackBySdformatWithItsMassesFramesAndFriction) {
  const std::string name = "a box & <\xC3\xA9t\xC3\xA9>";
  const ExportedBox box(name);
  auto world = box.world({{name, identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_TRUE(write_sdf(*world, box.target()));
  sdf::Root root;
  const sdf::Errors errors = root.Load((box.target() / kSdfFile).string());
  for (const sdf::Error& error : errors) ADD_FAILURE() << error.Message();
  ASSERT_EQ(root.WorldCount(), 1U);
  const sdf::Model* model = root.WorldByIndex(0)->ModelByName(name);
  ASSERT_NE(model, nullptr);
  const ExportedBody& body = world->bodies.front();
  const auto& position = model->RawPose().Pos();
  EXPECT_NEAR(
      (Eigen::Vector3d(position.X(), position.Y(), position.Z()) - body.T_base_object.translation())
          .norm(),
      0.0, 1e-6);
  const auto& rotation = model->RawPose().Rot();
  EXPECT_NEAR(Eigen::Quaterniond(rotation.W(), rotation.X(), rotation.Y(), rotation.Z())
                  .angularDistance(body.T_base_object.rotation()),
              0.0, 1e-6);
  const sdf::Link* link = model->LinkByName("body");
  ASSERT_NE(link, nullptr);
  const auto& mass = link->Inertial().MassMatrix();
  EXPECT_NEAR(mass.Mass(), kBoxMass, 1e-6 * kBoxMass);
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned j = 0; j < 3; ++j) {
      EXPECT_NEAR(mass.Moi()(i, j),
                  body.inertia.inertia_object(static_cast<int>(i), static_cast<int>(j)), 1e-9);
    }
  }
  ASSERT_EQ(link->CollisionCount(), 1 + body.feet.size());
  for (std::size_t i = 0; i < body.feet.size(); ++i) {
    const sdf::Collision* foot = link->CollisionByName("foot_" + std::to_string(i));
    ASSERT_NE(foot, nullptr);
    const auto surface = foot->Element()->GetElement("surface");
    const auto ode = surface->GetElement("friction")->GetElement("ode");
    EXPECT_NEAR(ode->Get<double>("mu"), body.feet[i].friction, 1e-6);
    const auto contact = surface->GetElement("contact")->GetElement("ode");
    EXPECT_GT(contact->Get<double>("kp"), 0.0);
  }
}

}  // namespace
}  // namespace pcavr
