// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A plan of many recordings: its tasks, its file, and what it refuses.
#include "pcavr/pipeline/task_graph.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/pipeline/slurm_scripts.hpp"

#include "pipeline/task_case.hpp"

namespace pcavr {
namespace {

TEST(TaskChain, IsReadInItsOrderOnly) {
  const auto chain = parse_chain("build,identify,replay,evaluate");
  ASSERT_TRUE(chain);
  EXPECT_EQ(chain->size(), 4U);
  EXPECT_FALSE(parse_chain("replay,build"));
  EXPECT_FALSE(parse_chain("build,build"));
  EXPECT_FALSE(parse_chain("evaluate"));
  EXPECT_FALSE(parse_chain("build,pool"));
  EXPECT_FALSE(parse_chain(""));
}

TEST(TaskGraphOfRecordings, HasAStageAfterTheOther) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0"), lab.record("lab/b", "1")});
  ASSERT_TRUE(graph) << graph.error().to_string();
  ASSERT_EQ(graph->tasks.size(), 4U);
  EXPECT_EQ(graph->tasks[0].name, "lab/a/build");
  EXPECT_EQ(graph->tasks[3].name, "lab/b/replay");
  EXPECT_EQ(graph->tasks[3].after, std::vector<std::size_t>{1});
  EXPECT_EQ(graph->recordings[0].support, "lab");
  EXPECT_EQ(graph->recordings[0].samples, 2U);
}

TEST(TaskGraphOfRecordings, IsTheSameFromItsFile) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph);
  const std::string text = format_task_graph(*graph);
  lab.write("plan.json", text);
  const auto read = read_task_graph(lab.path("plan.json"));
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(format_task_graph(*read), text);
}

// A task after a later one would be a cycle.
TEST(TaskGraphOfRecordings, IsRefusedFromAChangedFile) {
  const TaskCase lab;
  auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph);
  graph->tasks[0].after = {1};
  lab.write("plan.json", format_task_graph(*graph));
  const auto read = read_task_graph(lab.path("plan.json"));
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("is no plan of pcavr"), std::string::npos);
}

TEST(TaskGraphOfRecordings, RefusesTheSameRecordingTwice) {
  const TaskCase lab;
  const std::string one = lab.record("lab/a", "0");
  const std::string copy = lab.record("lab/copy", "0");
  for (const std::string& second : {one, copy}) {
    const auto graph = lab.plan({one, second});
    ASSERT_FALSE(graph);
    EXPECT_NE(graph.error().message.find("is the same recording as"), std::string::npos);
  }
}

TEST(TaskGraphOfRecordings, RefusesTwoBodiesOfOneName) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0"), lab.record("lab/b", "1", "v 1 0 0\n")});
  ASSERT_FALSE(graph);
  EXPECT_NE(graph.error().message.find("box has another CAD file"), std::string::npos);
}

// A recording in the root folder had an absolute name: its results would have been written into it.
TEST(TaskGraphOfRecordings, HasItsResultsInTheirFolderWhateverTheSupport) {
  const TaskCase lab;
  const std::string recording = lab.record("_pooled/a", "0");
  const auto graph = lab.plan({recording});
  ASSERT_TRUE(graph) << graph.error().to_string();
  EXPECT_EQ(graph->recordings[0].support, "unnamed");
  for (const char* support : {"../out", "/tmp", "a/b", ".", "_pooled"}) {
    const auto refused = make_task_graph({.recordings = {recording},
                                          .chain = {TaskStage::build},
                                          .results = lab.path("results"),
                                          .support = support});
    ASSERT_FALSE(refused) << support;
    EXPECT_EQ(refused.error().message, "is no name of a support");
  }
}

TEST(TaskGraphOfRecordings, RefusesAMissingRecording) {
  const TaskCase lab;
  EXPECT_FALSE(lab.plan({lab.record("lab/a", "0"), lab.path("lab/none")}));
}

TEST(PlannedInputs, AreCheckedByTheirContent) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0")});
  ASSERT_TRUE(graph);
  lab.record("lab/a", "0");  // another time of change, the same bytes
  EXPECT_TRUE(check_planned_inputs(*graph));
  lab.record("lab/a", "2");
  const auto changed = check_planned_inputs(*graph);
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().message, "has changed since the plan was made");
}

TEST(SlurmScripts, AreAnArrayForEachStageWithItsDependency) {
  const TaskCase lab;
  const auto graph = lab.plan({lab.record("lab/a", "0"), lab.record("lab/b", "1")});
  ASSERT_TRUE(graph);
  const auto scripts = slurm_scripts(*graph, "/lab/it's.json", "/usr/bin/pcavr");
  ASSERT_EQ(scripts.size(), 3U);
  EXPECT_NE(scripts[1].text.find("#SBATCH --array=0-1\n"), std::string::npos);
  EXPECT_NE(scripts[1].text.find("run '/lab/it'\\''s.json' --task $((2 + SLURM_ARRAY_TASK_ID))"),
            std::string::npos)
      << scripts[1].text;
  EXPECT_NE(scripts[2].text.find("--dependency=\"aftercorr:${job_0%%;*}\""), std::string::npos)
      << scripts[2].text;
}

// A scene needs all parts of its tiles, and each of them the one survey: not element by element.
TEST(SlurmScripts, WaitForAllPartsOfAScenesTiles) {
  TaskGraph graph;
  graph.settings.resize(1);
  const auto add = [&](TaskStage stage, std::vector<std::size_t> after) {
    graph.tasks.push_back({.name = std::string(name_of(stage)), .stage = stage, .after = after});
  };
  add(TaskStage::survey, {});
  add(TaskStage::fuse, {0});
  add(TaskStage::fuse, {0});
  add(TaskStage::build, {0, 1, 2});
  add(TaskStage::identify, {3});
  const auto scripts = slurm_scripts(graph, "/lab/hall.json", "/usr/bin/pcavr");
  ASSERT_EQ(scripts.size(), 5U);
  EXPECT_NE(scripts[1].text.find("#SBATCH --array=0-1\n"), std::string::npos);
  const std::string& submit = scripts[4].text;
  EXPECT_NE(submit.find("--dependency=\"afterany:${job_0%%;*}\" "), std::string::npos) << submit;
  EXPECT_NE(submit.find("--dependency=\"afterany:${job_0%%;*},afterany:${job_1%%;*}\" "),
            std::string::npos)
      << submit;
  EXPECT_NE(submit.find("--dependency=\"aftercorr:${job_2%%;*}\" "), std::string::npos) << submit;
}

TEST(TaskGraphOfRecordings, HasNoTilesWithoutImages) {
  const TaskCase lab;
  const auto graph = make_task_graph({.recordings = {lab.record("lab/a", "0")},
                                      .chain = {TaskStage::build},
                                      .results = lab.path("results"),
                                      .tile_size = 4.0,
                                      .parts = 2});
  ASSERT_TRUE(graph) << graph.error().to_string();
  ASSERT_EQ(graph->tasks.size(), 1U);
  EXPECT_TRUE(graph->tasks[0].after.empty());
  EXPECT_FALSE(parse_chain("survey,build"));
}

}  // namespace
}  // namespace pcavr
