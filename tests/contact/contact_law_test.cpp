// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/contact_law.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ContactLaw, KelvinVoigtIsSpringPlusDamper) {
  EXPECT_DOUBLE_EQ(contact_force(KelvinVoigt{2000.0, 10.0}, {0.003, 0.02, 9.0}), 6.2);
}

TEST(ContactLaw, MassDamperSpringAddsInertia) {
  EXPECT_DOUBLE_EQ(contact_force(MassDamperSpring{0.5, 10.0, 2000.0}, {0.003, 0.02, 4.0}), 8.2);
}

TEST(ContactLaw, HuntCrossleyIsAPowerOfPenetration) {
  const HuntCrossley law{1e5, 2e4, 1.5};
  EXPECT_NEAR(contact_force(law, {0.01, 0.0}), 100.0, 1e-12);
  EXPECT_NEAR(contact_force(law, {0.01, 0.5}), 110.0, 1e-12);
  EXPECT_NEAR(contact_force(HuntCrossley{1e5, 0.0, 1.0}, {0.01, 3.0}), 1000.0, 1e-10);
}

TEST(ContactLaw, HuntCrossleyDoesNotJumpAtImpactButKelvinVoigtDoes) {
  const ContactMotion just_touching{1e-12, 0.1};
  EXPECT_LT(contact_force(HuntCrossley{1e5, 1e5, 1.5}, just_touching), 1e-10);
  EXPECT_GT(contact_force(KelvinVoigt{1e5, 10.0}, just_touching), 0.99);
}

TEST(ContactLaw, NeverPullsWhenRenderedButMayWhenFitted) {
  const ContactMotion leaving{0.001, -1.0, -50.0};
  for (const ContactLaw& law :
       {ContactLaw{KelvinVoigt{2000.0, 10.0}}, ContactLaw{MassDamperSpring{0.5, 10.0, 2000.0}},
        ContactLaw{HuntCrossley{1e5, 2e5, 1.5}}}) {
    EXPECT_EQ(contact_force(law, leaving), 0.0);
    EXPECT_LT(unclamped_contact_force(law, leaving), 0.0);
  }
}

TEST(ContactLaw, IsZeroOutOfContact) {
  for (const double penetration : {0.0, -1e-3, kNaN}) {
    const ContactMotion apart{penetration, 1.0, 1.0};
    EXPECT_EQ(contact_force(KelvinVoigt{2000.0, 10.0}, apart), 0.0);
    EXPECT_EQ(contact_force(MassDamperSpring{1.0, 10.0, 2000.0}, apart), 0.0);
    EXPECT_EQ(unclamped_contact_force(HuntCrossley{1e5, 2e4, 1.5}, apart), 0.0);
  }
}

TEST(ContactLaw, IsPassiveOverAClosedCycle) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const ContactLaw laws[] = {KelvinVoigt{random.uniform(100, 5000), random.uniform(0, 50)},
                               HuntCrossley{random.uniform(1e3, 1e6), random.uniform(0, 1e6), 1.5}};
    const double omega = random.uniform(1.0, 60.0);
    for (const ContactLaw& law : laws) {
      double work = 0.0;
      const int steps = 4000;
      for (int i = 0; i < steps; ++i) {
        const double phase = 2.0 * M_PI * (i + 0.5) / steps;
        const double rate = 0.001 * omega * std::sin(phase);
        const double penetration = 0.001 * (0.8 - std::cos(phase));
        work += contact_force(law, {penetration, rate}) * rate * 2.0 * M_PI / omega / steps;
      }
      EXPECT_GE(work, -1e-12);
    }
  }
}

TEST(ContactLaw, RejectsParametersThatAreNotPhysical) {
  EXPECT_TRUE(is_physical(KelvinVoigt{2000.0, 0.0}));
  EXPECT_FALSE(is_physical(KelvinVoigt{2000.0, -1.0}));
  EXPECT_FALSE(is_physical(KelvinVoigt{0.0, 1.0}));
  EXPECT_TRUE(is_physical(MassDamperSpring{0.0, 0.0, 1.0}));
  EXPECT_FALSE(is_physical(MassDamperSpring{kNaN, 0.0, 1.0}));
  EXPECT_TRUE(is_physical(HuntCrossley{1.0, 0.0, 1.0}));
  EXPECT_FALSE(is_physical(HuntCrossley{1.0, 0.0, 0.9}));
  EXPECT_FALSE(is_physical(HuntCrossley{std::numeric_limits<double>::infinity(), 0.0, 1.5}));
}

}  // namespace
}  // namespace pcavr
