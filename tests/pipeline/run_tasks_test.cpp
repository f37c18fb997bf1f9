// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Running a plan: each task once, failures apart, and two calls at once.
#include "pcavr/pipeline/run_tasks.hpp"

#include <filesystem>
#include <future>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/pipeline/gather_results.hpp"

#include "pipeline/task_case.hpp"

namespace pcavr {
namespace {

TEST(TaskRun, DoesEachTaskOnce) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0"), lab.record("lab/b", "1")});
  ASSERT_TRUE(graph);
  const auto first = lab.run(*graph);
  ASSERT_TRUE(first) << first.error().to_string();
  EXPECT_EQ(first->ran, 4U);
  EXPECT_EQ(lab.calls(), 4);
  const auto second = lab.run(*graph);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->ran, 0U);
  EXPECT_EQ(second->were_done, 4U);
  EXPECT_EQ(lab.calls(), 4);
}

TEST(TaskRun, IsGatheredOnlyWhereATaskIsDone) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph);
  const auto gathered = gather_results(*graph, {.command = lab.path("command")}, lab.path("."));
  ASSERT_FALSE(gathered);
  EXPECT_EQ(gathered.error().message, "none of the plan's 2 tasks is done");
}

TEST(TaskRun, DoesATaskAgainWhoseOutputIsMissingOrChanged) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph && lab.run(*graph));
  std::filesystem::remove_all(graph->tasks[1].outputs[0]);
  EXPECT_EQ(lab.run(*graph)->ran, 1U);
  lab.write("results/lab/a/scene/file", "other\n");
  EXPECT_EQ(lab.run(*graph)->ran, 1U);  // the same bytes again: what follows is still done
  EXPECT_EQ(task_states(*graph)->at(1).state, TaskState::done);
}

TEST(TaskRun, SkipsWhatNeedsAFailedTaskAndDoesTheOthers) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/bad", "0"), lab.record("lab/b", "1")});
  ASSERT_TRUE(graph);
  const auto run = lab.run(*graph);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->states[0].state, TaskState::failed);
  EXPECT_EQ(run->states[0].reason, "it is bad; make it good");
  EXPECT_EQ(run->states[2].state, TaskState::skipped);
  EXPECT_EQ(run->states[2].reason, "needs lab/bad/build, which failed");
  EXPECT_EQ(run->states[3].state, TaskState::done);
  const auto states = task_states(*graph);
  ASSERT_TRUE(states);
  EXPECT_EQ(states->at(0).reason, "it is bad; make it good");
  EXPECT_EQ(states->at(2).state, TaskState::skipped);
}

TEST(TaskRun, OfOneTaskNeedsThoseBeforeIt) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph);
  const auto early = run_tasks(*graph, {.command = lab.path("command"), .only = 1});
  ASSERT_FALSE(early);
  EXPECT_NE(early.error().message.find("needs task 0, lab/a/build"), std::string::npos);
  for (const std::size_t task : {0U, 1U}) {
    const auto run = run_tasks(*graph, {.command = lab.path("command"), .only = task});
    ASSERT_TRUE(run) << run.error().to_string();
    EXPECT_EQ(run->ran, 1U);
  }
}

TEST(TaskRun, DoesNoTaskTwiceWhereTwoRunAtOnce) {
  const TaskCase lab;
  std::vector<std::string> recordings;
  for (int i = 0; i < 6; ++i)
    recordings.push_back(lab.record("lab/" + std::to_string(i), std::to_string(i)));
  const auto graph = lab.plan(recordings);
  ASSERT_TRUE(graph);
  auto other = std::async(std::launch::async, [&] { return lab.run(*graph); });
  const auto own = lab.run(*graph);
  const auto others = other.get();
  ASSERT_TRUE(own && others);
  EXPECT_EQ(lab.calls(), 12);
  EXPECT_EQ(own->ran + others->ran, 12U);
  for (const auto* run : {&*own, &*others}) {
    for (const TaskStatus& status : run->states) EXPECT_EQ(status.state, TaskState::done);
  }
}

}  // namespace
}  // namespace pcavr
