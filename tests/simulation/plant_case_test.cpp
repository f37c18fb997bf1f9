// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant_case.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"

#include "simulation/plant_bodies.hpp"

namespace pcavr {
namespace {

PlantRun run_of(const PlantCase& plant) { return run_plant(plant.bodies, plant.tool, plant.moves); }

std::size_t step_of(double t) { return static_cast<std::size_t>(std::lround(t / PlantRun::kStep)); }

/// Number of times that a body began to slide after it was free.
int slides(const PlantRun& run, std::size_t body) {
  int count = 0;
  bool was_free = false;
  for (const PlantPhaseChange& change : run.phases) {
    if (change.body != body) continue;
    was_free = was_free || change.phase == PlantPhase::free;
    if (change.phase != PlantPhase::sliding || !was_free) continue;
    was_free = false;
    ++count;
  }
  return count;
}

TEST(PlantCase, TheSameSeedHasTheSameBoxesInEveryTask) {
  const PlantCase push = make_plant_case(ToolTask::push, 9);
  for (const ToolTask task : {ToolTask::probe, ToolTask::press, ToolTask::turn}) {
    const PlantCase other = make_plant_case(task, 9);
    ASSERT_EQ(other.bodies.size(), push.bodies.size());
    for (std::size_t i = 0; i < push.bodies.size(); ++i) {
      EXPECT_EQ(other.bodies[i].name, push.bodies[i].name);
      EXPECT_EQ(other.bodies[i].parts[0].half_extents, push.bodies[i].parts[0].half_extents);
      EXPECT_EQ(other.bodies[i].parameters.mass, push.bodies[i].parameters.mass);
      EXPECT_EQ(other.bodies[i].parameters.contact_stiffness,
                push.bodies[i].parameters.contact_stiffness);
    }
  }
  EXPECT_NE(make_plant_case(ToolTask::push, 10).bodies[0].parameters.mass,
            push.bodies[0].parameters.mass);
}

TEST(PlantCase, AWideCaseHasTheSameBoxesOnWornSupports) {
  const PlantCase plain = make_plant_case(ToolTask::probe, 9);
  const PlantCase wide = make_plant_case(ToolTask::probe, 9, {}, PlantVariety::wide);
  const PlantCase pushed = make_plant_case(ToolTask::push, 9, {}, PlantVariety::wide);
  ASSERT_EQ(wide.bodies.size(), plain.bodies.size());
  for (std::size_t i = 0; i < plain.bodies.size(); ++i) {
    const PlantBody& body = wide.bodies[i];
    EXPECT_EQ(body.parameters.mass, plain.bodies[i].parameters.mass);
    EXPECT_LT(body.parameters.load_exponent, 0.0);
    EXPECT_EQ(body.parameters.load_exponent, pushed.bodies[i].parameters.load_exponent);
    double mean = 0.0, least = 1.0;
    for (std::size_t k = 0; k < body.patches.size(); ++k) {
      mean += body.patches[k].share * body.patches[k].wear;
      least = std::min(least, body.patches[k].wear);
      EXPECT_EQ(body.patches[k].wear, pushed.bodies[i].patches[k].wear);
    }
    EXPECT_NEAR(mean, 1.0, 1e-12);
    EXPECT_LT(least, 0.8);
  }
  ASSERT_EQ(wide.moves.size(), plain.moves.size());
  int turned = 0;
  for (std::size_t i = 0; i < plain.moves.size(); ++i) {
    turned += wide.moves[i].target != plain.moves[i].target ? 1 : 0;
  }
  EXPECT_GT(turned, 40);  // those of ten pushes and a slide for each box
}

TEST(PlantCase, BodiesCoverWideRangesAndArePhysical) {
  double lightest = 1e9;
  double heaviest = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    for (const PlantBody& body : make_plant_case(ToolTask::push, seed).bodies) {
      const PlantParameters& p = body.parameters;
      const double weight = p.mass * kStandardGravity;
      lightest = std::min(lightest, p.mass);
      heaviest = std::max(heaviest, p.mass);
      EXPECT_GE(p.limiting_static_friction, 0.2 * weight * 0.999);
      EXPECT_LE(p.limiting_static_friction, 1.1 * weight * 1.001);
      EXPECT_LT(p.sliding_friction_coefficient * weight, p.limiting_static_friction);
      const double penetration =
          std::pow(p.limiting_static_friction / p.contact_stiffness, 1.0 / p.contact_exponent);
      EXPECT_GE(penetration, 0.00019);
      EXPECT_LE(penetration, 0.00201);
      // Pressure: positive, with the weight as sum and the centre near the middle.
      double sum = 0.0;
      Eigen::Vector2d centre = Eigen::Vector2d::Zero();
      for (const PlantPatch& patch : body.patches) {
        EXPECT_GT(patch.share, 0.0);
        sum += patch.share;
        centre += patch.share * patch.p_body;
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_LT(centre.norm(), 0.0025);
    }
  }
  EXPECT_LT(lightest, 1.0);
  EXPECT_GT(heaviest, 5.0);
}

TEST(PlantCase, PushesSlideBothBoxesBySomeCentimetres) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const PlantCase plant = make_plant_case(ToolTask::push, seed);
    const PlantRun run = run_of(plant);
    EXPECT_LT(run.duration(), 20.0);
    for (std::size_t i = 0; i < 2; ++i) {
      const double displacement =
          (run.bodies[i].back().p_base - run.bodies[i].front().p_base).norm();
      EXPECT_GT(displacement, 0.035) << "seed " << seed << ", body " << i;
      EXPECT_LT(displacement, 0.085) << "seed " << seed << ", body " << i;
      EXPECT_EQ(slides(run, i), 1) << "seed " << seed << ", body " << i;
    }
  }
}

TEST(PlantCase, AProbeHasTenBreakawaysAndAContinuousSlide) {
  const PlantCase plant = make_plant_case(ToolTask::probe, 4);
  const PlantRun run = run_of(plant);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(slides(run, i), 11) << i;
    // The last one is the longest: 90 mm at some 60 mm/s without a stop.
    double longest = 0.0;
    double began = 0.0;
    PlantPhase before = PlantPhase::free;
    for (const PlantPhaseChange& change : run.phases) {
      if (change.body != i) continue;
      if (before == PlantPhase::sliding) longest = std::max(longest, change.t - began);
      before = change.phase;
      began = change.t;
    }
    EXPECT_GT(longest, 1.2);
    EXPECT_LT(run.duration(), 75.0);
  }
}

TEST(PlantCase, SlowPushesOfAProbeBreakAwayWithinThreePerCentOfTheLimit) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const PlantCase plant = make_plant_case(ToolTask::probe, seed);
    // Long enough for the first push of the first box.
    const PlantRun run = run_plant(plant.bodies, plant.tool, plant.moves, {.max_duration = 12.0});
    const double limit = plant.bodies[0].parameters.limiting_static_friction;
    const auto first =
        std::find_if(run.phases.begin(), run.phases.end(), [](const PlantPhaseChange& change) {
          return change.body == 0 && change.phase == PlantPhase::sliding;
        });
    ASSERT_NE(first, run.phases.end()) << seed;
    double max_force = 0.0;
    for (std::size_t k = step_of(first->t - 0.5); k < step_of(first->t + 0.03); ++k) {
      max_force = std::max(max_force, run.force_base[k].head<2>().norm());
    }
    EXPECT_GT(max_force, 0.995 * limit) << "seed " << seed;
    EXPECT_LT(max_force, 1.03 * limit) << "seed " << seed;
  }
}

TEST(PlantCase, PressesDoNotMoveTheBoxes) {
  const PlantCase plant = make_plant_case(ToolTask::press, 2);
  const PlantRun run = run_of(plant);
  for (const auto& states : run.bodies) {
    EXPECT_LT((states.back().p_base - states.front().p_base).norm(), 1e-5);
  }
  double max_force = 0.0;
  for (const Eigen::Vector3d& force : run.force_base) max_force = std::max(max_force, -force.z());
  EXPECT_GT(max_force, 10.0);
  EXPECT_LT(max_force, 90.0);
}

TEST(PlantCase, SoftBoxesAreDeformedByMoreThanTheTipsRadius) {
  const PlantCase plant = make_plant_case(ToolTask::soft, 2);
  const PlantRun run = run_of(plant);
  for (const PlantBody& body : plant.bodies) {
    const double top = 2.0 * body.parts.front().half_extents.z();
    double deepest = 0.0;
    for (const Eigen::Vector3d& tip : run.p_base_tip) {
      const Eigen::Vector2d off = (tip - body.T_base_object.translation()).head<2>();
      if (off.norm() < 0.01) deepest = std::max(deepest, top + plant.tool.radius - tip.z());
    }
    EXPECT_GT(deepest, 0.013) << body.name;
    EXPECT_LT(deepest, 0.016) << body.name;
  }
}

TEST(PlantCase, ASoftBoxIsPressedThroughTheFaceThatTheTipEnteredAlsoBesideACorner) {
  const PlantCase plant = make_plant_case(ToolTask::corner, 1);
  const PlantRun run = run_of(plant);
  for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
    const Eigen::Vector3d half = plant.bodies[i].parts.front().half_extents;
    int deep = 0;
    for (std::size_t step = 0; step < run.p_base_tip.size(); ++step) {
      const double t = PlantRun::kStep * static_cast<double>(step);
      const Pose T_object_base = T_base_object_at(run, plant.bodies[i], i, t).inverse();
      const Eigen::Vector3d tip = T_object_base * run.p_base_tip[step];
      const Eigen::Vector3d clearance = tip.cwiseAbs() - half;
      const bool is_deep = clearance.maxCoeff() < 0.0 && clearance.y() < clearance.x();
      if (!is_deep) continue;
      ++deep;
      const Eigen::Vector3d force = T_object_base.rotation() * run.force_base[step];
      ASSERT_GT(force.y(), 2.0 * std::abs(force.x())) << t;  // friction at most
    }
    EXPECT_GT(deep, 200) << plant.bodies[i].name;
  }
}

TEST(PlantCase, ImpactsLast2To80MillisecondsAndBounce) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const PlantCase plant = make_plant_case(ToolTask::impact, seed);
    const PlantRun run =
        run_plant(plant.bodies, plant.tool, plant.moves, {.substeps = plant.substeps});
    int count = 0;
    for (const PlantImpact& impact : run.impacts) {
      if (impact.approach_speed < 0.05) continue;  // a slow press that bounces
      ++count;
      EXPECT_GT(impact.duration, 0.002) << seed;
      EXPECT_LT(impact.duration, 0.08) << seed;
      EXPECT_GT(impact.restitution, 0.05) << seed;
      EXPECT_LT(impact.restitution, 1.0) << seed;
    }
    EXPECT_EQ(count, 10) << seed;
    // Half the step gives the same, to a thousandth of the restitution.
    const PlantRun finer =
        run_plant(plant.bodies, plant.tool, plant.moves, {.substeps = 2 * plant.substeps});
    ASSERT_EQ(finer.impacts.size(), run.impacts.size()) << seed;
    for (std::size_t i = 0; i < run.impacts.size(); ++i) {
      if (run.impacts[i].approach_speed < 0.05) continue;
      EXPECT_NEAR(finer.impacts[i].restitution, run.impacts[i].restitution, 2e-3) << seed;
    }
  }
}

TEST(PlantCase, TheSlotPressesOnBothWallsWithoutSliding) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const PlantCase plant = make_plant_case(ToolTask::slot, seed);
    const PlantRun run = run_of(plant);
    const Eigen::Vector3d across =
        plant.bodies[0].T_base_object.rotation() * Eigen::Vector3d::UnitX();
    double one = 0.0;
    double other = 0.0;
    for (const Eigen::Vector3d& force : run.force_base) {
      one = std::max(one, force.dot(across));
      other = std::max(other, -force.dot(across));
    }
    EXPECT_GT(one, 5.0) << seed;
    EXPECT_GT(other, 5.0) << seed;
    EXPECT_LT((run.bodies[0].back().p_base - run.bodies[0].front().p_base).norm(), 1e-3) << seed;
  }
}

/// Paper B's slotting: driven along z alone, into the hole the block slides aside and turns.
TEST(PlantCase, TheObliqueHoleSlidesAndTurnsTheBlockUnderATipThatMovesAlongZ) {
  const PlantCase plant = make_plant_case(ToolTask::hole, 1);
  const PlantRun run = run_of(plant);
  const PlantBody& block = plant.bodies[0];
  const double top = 2.0 * simulation::half_extents_of(block).z();
  double max_force = 0.0, max_wall = 0.0;
  std::optional<std::size_t> first, last;  // steps with the tip's centre below the top face
  for (std::size_t i = 0; i < run.force_base.size(); ++i) {
    const Eigen::Vector2d offset = run.p_base_tip[i].head<2>() - run.bodies[0][i].p_base;
    if (run.p_base_tip[i].z() > top || offset.norm() > 0.06) continue;
    if (!first) first = i;
    last = i;
    max_force = std::max(max_force, run.force_base[i].norm());
    max_wall = std::max(max_wall, run.force_base[i].head<2>().norm());
  }
  ASSERT_TRUE(first);
  EXPECT_GT(max_force, 85.0);
  EXPECT_LT(max_force, 100.0);
  EXPECT_GT(max_wall, 2.0);
  double slid = 0.0, turned = 0.0, sideways = 0.0;
  for (std::size_t i = *first; i <= *last; ++i) {
    const PlantBodyState& now = run.bodies[0][i];
    slid = std::max(slid, (now.p_base - run.bodies[0][*first].p_base).norm());
    turned = std::max(turned, std::abs(now.yaw - run.bodies[0][*first].yaw));
  }
  for (std::size_t i = *first; i + 1 < *first + 1500; ++i) {
    sideways = std::max(sideways, (run.p_base_tip[i] - run.p_base_tip[*first]).head<2>().norm());
  }
  EXPECT_GT(slid, 0.005);
  EXPECT_GT(turned, 0.01);
  EXPECT_LT(sideways, 0.001);  // the arm gives way a little
}

TEST(PlantCase, TurnsRotateTheBoxes) {
  const PlantCase plant = make_plant_case(ToolTask::turn, 1);
  const PlantRun run = run_of(plant);
  for (const auto& states : run.bodies) {
    double turned = 0.0;
    for (std::size_t i = 1; i < states.size(); ++i) {
      turned += std::abs(states[i].yaw - states[i - 1].yaw);
    }
    EXPECT_GT(turned, 20.0 / 180.0 * std::numbers::pi);
  }
}

TEST(PlantCase, ThePapersRunIsShortAndHasItsTenTimeNodes) {
  const PlantCase plant = make_plant_case(ToolTask::paper, 1);
  const PlantRun run = run_of(plant);
  EXPECT_LT(run.duration(), 26.0);
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<PlantPhase> last;
    for (const PlantPhaseChange& change : run.phases) {
      if (change.body == i) last.push_back(change.phase);
    }
    ASSERT_GE(last.size(), 5U);
    last.erase(last.begin(), last.end() - 5);
    const std::vector<PlantPhase> expected{PlantPhase::static_friction, PlantPhase::critical,
                                           PlantPhase::sliding, PlantPhase::static_friction,
                                           PlantPhase::free};
    EXPECT_EQ(last, expected) << plant.bodies[i].name;
  }
}

}  // namespace
}  // namespace pcavr
