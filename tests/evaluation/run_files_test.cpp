// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/run_files.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "run_samples.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class RunFolder : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& content) const {
    ASSERT_TRUE(write_file(folder_.path() / name, content).has_value());
  }
  TemporaryFolder folder_;
};

TEST_F(RunFolder, MayBeEmpty) {
  const auto run = read_run_files(folder_.path());
  ASSERT_TRUE(run.has_value());
  EXPECT_TRUE(run->forces.empty() && run->measured.empty() && !run->corrections);
  const auto truth = read_truth_files(folder_.path());
  ASSERT_TRUE(truth.has_value());
  EXPECT_TRUE(truth->phases.empty() && !truth->parameters);
}

TEST_F(RunFolder, IsReadCompletely) {
  write("force.csv", "t,object,measured,virtual\n1.000000,box,2.5,2.4\n1.002000,box,2.6,-0.1\n");
  write("phases.csv",
        "t,object,measured,predicted\n0,box,free,free\n0,ball,free,free\n"
        "1.0,box,static,free\n1.1,box,static,static\n");
  write("corrections.csv",
        "t,object,case,what,bytes\n1.0,box,2,position+friction parameters,120\n"
        "1.0,box,1.2a,position+lost,64\n");
  write("run.yaml",
        "format: pcavr-run/1\nrecording: somewhere\nparameters: none\nforward_delay: 0.2\n"
        "backward_delay: 0.1\ncorrections: true\nidentifies: false\nloss: 0.05\n"
        "traffic: {correction_bytes: 184, streaming_bytes: 1000}\n"
        "assumed: {box: [mass, viscous_friction]}\nnotes: [one, two]\n");
  const auto run = read_run_files(folder_.path());
  ASSERT_TRUE(run.has_value()) << run.error().to_string();
  ASSERT_EQ(run->forces.at("box").size(), 2U);
  EXPECT_EQ(run->forces.at("box")[1].rendered, -0.1);
  ASSERT_EQ(run->measured.at("box").size(), 2U);  // the third row changes only the prediction
  EXPECT_EQ(run->predicted.at("box")[1].stamp, at(1.1));
  EXPECT_EQ(run->measured.at("ball").size(), 1U);
  ASSERT_EQ(run->corrections->size(), 2U);
  EXPECT_EQ((*run->corrections)[0].what,
            std::vector<std::string>({"position", "friction parameters"}));
  EXPECT_TRUE((*run->corrections)[1].is_lost);
  EXPECT_EQ((*run->corrections)[1].what, std::vector<std::string>({"position"}));
  EXPECT_EQ(run->settings.backward_delay, 0.1);
  EXPECT_EQ(run->settings.identifies, false);
  EXPECT_EQ(run->settings.streaming_bytes, 1000.0);
  EXPECT_EQ(run->settings.assumed.at("box").size(), 2U);
  EXPECT_EQ(run->settings.notes.size(), 2U);
}

TEST_F(RunFolder, NamesTheLineOfABadRow) {
  struct Case {
    const char* file;
    const char* text;
    int line;
    const char* word;
  };
  const Case cases[] = {
      {"force.csv", "t,object,measured,rendered\n", 1, "header"},
      {"force.csv", "", 0, "empty"},
      {"force.csv", "t,object,measured,virtual\n1,box,2\n", 2, "columns"},
      {"force.csv", "t,object,measured,virtual\n1,box,2,nan\n", 2, "finite"},
      {"force.csv", "t,object,measured,virtual\none,box,2,2\n", 2, "one"},
      {"force.csv", "t,object,measured,virtual\n1,box,2,2\n1,box,2,2\n", 3, "not after"},
      {"force.csv", "t,object,measured,virtual\n1,,2,2\n", 2, "no object"},
      {"phases.csv", "t,object,measured,predicted\n1,box,free,gliding\n", 2, "gliding"},
      {"phases.csv", "t,object,measured,predicted\n2,box,free,free\n1,box,static,free\n", 3,
       "not after"},
      {"parameters.csv", "t,object,parameter,running,transmitted\n1,box,mass,3,x\n", 2, "'x'"},
      {"corrections.csv", "t,object,case,what,bytes\n1,box,1.4,position,3\n", 2, "1.4"},
      {"corrections.csv", "t,object,case,what,bytes\n1,box,2,position,-3\n", 2, "out of range"},
      {"run.yaml", "forward_delay: soon\n", 1, "soon"},
      {"run.yaml", "a: 1\nbackward_delay: -0.1\n", 2, "out of range"},
  };
  for (const Case& bad : cases) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_file(folder.path() / bad.file, bad.text).has_value());
    const auto run = read_run_files(folder.path());
    ASSERT_FALSE(run.has_value()) << bad.text;
    EXPECT_EQ(run.error().file, (folder.path() / bad.file).string());
    EXPECT_EQ(run.error().line, bad.line) << bad.text;
    EXPECT_NE(run.error().message.find(bad.word), std::string::npos)
        << run.error().message << " of " << bad.text;
  }
}

TEST_F(RunFolder, MayHaveTwoObjectsAtOneTime) {
  write("phases.csv", "t,object,measured,predicted\n1,a,free,free\n1,b,free,free\n");
  EXPECT_TRUE(read_run_files(folder_.path()).has_value());
}

TEST_F(RunFolder, ReadsTheTruthsPhasesAndParameters) {
  write("phase.csv", "t,object,phase\n0,box,free\n1.5,box,sliding\n");
  write("parameters.yaml", "box:\n  mass: 3\n");
  const auto truth = read_truth_files(folder_.path());
  ASSERT_TRUE(truth.has_value()) << truth.error().to_string();
  EXPECT_EQ(truth->phases.at("box")[1].phase, Phase::sliding);
  EXPECT_EQ(truth->parameters->at("box").mass->value, 3.0);
}

}  // namespace
}  // namespace pcavr
