// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Bad input: one error line with file, place and hint; exit code 1; no partial output.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "pcavr/base/core/utf8.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "support/command.hpp"
#include "support/sanitizers.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// Four frames of a bare wall a metre away: a valid recording, but without a visible tag.
void write_plain_recording(const fs::path& folder) {
  Manifest manifest;
  manifest.camera =
      CameraModel{.width = 160, .height = 120, .fx = 130.0, .fy = 130.0, .cx = 79.5, .cy = 59.5};
  manifest.depth_scale = 1000.0;
  manifest.markers = {
      {.id = {"tag36h11", 0}, .size = 0.1, .role = MarkerRole::base, .object = {}},
      {.id = {"tag36h11", 5}, .size = 0.05, .role = MarkerRole::object, .object = "box"}};
  manifest.objects = {{.name = "box", .mesh = "objects/box.obj"}};
  RecordingWriter writer(folder, manifest);
  TriangleMesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  ASSERT_TRUE(writer.write_object_mesh("objects/box.obj", tetrahedron));
  for (int i = 0; i < 4; ++i) {
    const Stamp stamp{i * 50'000'000LL};
    ASSERT_TRUE(writer.add_frame(stamp, ColorImage(160, 120, {90, 90, 90}), stamp,
                                 DepthImage(160, 120, 1.0F)));
  }
  ASSERT_TRUE(writer.finish());
}

class BadInput : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(recording());
    write_plain_recording(recording());
  }

  [[nodiscard]] fs::path recording() const { return folder_.path() / "recording"; }
  [[nodiscard]] fs::path scene() const { return folder_.path() / "scene"; }
  [[nodiscard]] fs::path first_image(const std::string& kind) const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(recording() / kind)) {
      files.push_back(entry.path());
    }
    return *std::min_element(files.begin(), files.end());
  }

  void write(const std::string& name, const std::string& content) const {
    ASSERT_TRUE(write_file(recording() / name, content));
  }

  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = read_file(recording() / name).value();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, text.npos) << text;
    write(name, text.replace(at, from.size(), to));
  }

  /// Builds, and expects one error line that contains each of `texts`, exit code 1 and no output.
  void expect_refused(const std::vector<std::string>& texts, const std::string& prefix = {}) const {
    const CommandOutcome outcome =
        run_pcavr({"build", recording().string(), "-o", scene().string()}, prefix);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.standard_output, "");
    const std::size_t at = outcome.standard_error.find("pcavr: ");
    ASSERT_NE(at, std::string::npos) << outcome.standard_error;
    const std::string line = outcome.standard_error.substr(at);
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    for (const std::string& text : texts) {
      EXPECT_NE(line.find(text), std::string::npos) << "no '" << text << "' in: " << line;
    }
    EXPECT_FALSE(fs::exists(scene()));
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      EXPECT_EQ(entry.path().filename(), "recording") << "left behind";
    }
  }

  TemporaryFolder folder_;
};

TEST_F(BadInput, NoBaseTagEverSeen) { expect_refused({"recording.yaml", "no base tag", "none"}); }

TEST_F(BadInput, TruncatedDepthImage) {
  const fs::path image = first_image("depth");
  fs::resize_file(image, fs::file_size(image) / 2);
  expect_refused({image.filename().string()});
}

TEST_F(BadInput, EightBitDepthImage) {
  // The smallest valid 8-bit PNG, byte by byte: the recording's own 8-bit images are JPEGs.
  const std::string png(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3a\x7e\x9b\x55"
      "\0\0\0\nIDATx\x9c\x63\x60\0\0\0\2\0\1\x48\xaf\xa4\x71\0\0\0\0IEND\xae\x42\x60\x82",
      67);
  const fs::path image = first_image("depth");
  ASSERT_TRUE(write_file(image, png));
  expect_refused({image.filename().string(), "16"});
}

TEST_F(BadInput, MissingFileInAList) {
  fs::remove(first_image("rgb"));
  expect_refused({"rgb.txt"});
}

TEST_F(BadInput, StampsThatGoBack) {
  const std::string image = fs::relative(first_image("depth"), recording()).string();
  write("depth.txt", "0.2 " + image + "\n0.1 " + image + "\n");
  expect_refused({"depth.txt:2"});
}

TEST_F(BadInput, NanInACsv) {
  write("tool.csv", "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n0.1,0,nan,0,0,0,0,1\n");
  expect_refused({"tool.csv:3"});
}

TEST_F(BadInput, WrongNumberOfColumns) {
  write("wrench.csv", "t,fx,fy,fz,tx,ty,tz\n0,1,2,3,4,5,6\n0.1,1,2,3\n");
  expect_refused({"wrench.csv:3"});
}

TEST_F(BadInput, TagOfSizeZero) {
  replace("recording.yaml", "size: 0.1", "size: 0");
  expect_refused({"recording.yaml:", "size"});
}

TEST_F(BadInput, UnknownKey) {
  write("recording.yaml", read_file(recording() / "recording.yaml").value() + "colour: blue\n");
  expect_refused({"recording.yaml:", "colour"});
}

TEST_F(BadInput, NoFrames) {
  write("rgb.txt", "# nothing\n");
  write("depth.txt", "# nothing\n");
  expect_refused({"no frames"});
}

TEST_F(BadInput, AllDepthZero) {
  fs::remove_all(recording());
  fs::create_directories(recording());
  write_plain_recording(recording());
  const std::string blank = [] {
    const TemporaryFolder folder;
    Manifest manifest;
    manifest.camera =
        CameraModel{.width = 160, .height = 120, .fx = 130.0, .fy = 130.0, .cx = 79.5, .cy = 59.5};
    manifest.depth_scale = 1000.0;
    RecordingWriter writer(folder.path(), manifest);
    EXPECT_TRUE(writer.add_frame({}, ColorImage(160, 120), {}, DepthImage(160, 120)));
    EXPECT_TRUE(writer.finish());
    return read_file(fs::directory_iterator(folder.path() / "depth")->path()).value();
  }();
  for (const auto& entry : fs::directory_iterator(recording() / "depth")) {
    ASSERT_TRUE(write_file(entry.path(), blank));
  }
  expect_refused({"depth.txt", "measurement"});
}

TEST_F(BadInput, CadFileMissing) {
  fs::remove(recording() / "objects/box.obj");
  expect_refused({"box.obj"});
}

TEST_F(BadInput, CadFileWithoutAVolume) {
  write("objects/box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refused({"box.obj", "volume"});
}

TEST_F(BadInput, OutputFolderThatCanNotBeWritten) {
  const CommandOutcome outcome =
      run_pcavr({"build", recording().string(), "-o", "/proc/nowhere/scene"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("/proc/nowhere/scene"), std::string::npos);
}

TEST_F(BadInput, OutputFolderThatIsThereAlready) {
  fs::create_directories(scene());
  std::ofstream(scene() / "precious.txt") << "keep me";
  const CommandOutcome outcome = run_pcavr({"build", recording().string(), "-o", scene().string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.standard_error.find("--force"), std::string::npos);
  EXPECT_EQ(read_file(scene() / "precious.txt").value(), "keep me");
}

TEST_F(BadInput, RecordingThatIsNotThere) {
  fs::remove_all(recording());
  const CommandOutcome outcome = run_pcavr({"build", recording().string(), "-o", scene().string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_FALSE(fs::exists(scene()));
}

/// A file size limit simulates a full disk: writes fail half-way.
TEST(DiskFull, LeavesNothingBehind) {
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "recording";
  const CommandOutcome outcome =
      run_pcavr({"simulate", "tabletop", "-o", recording.string(), "--seed", "1"},
                "trap '' XFSZ; ulimit -f 40; ");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(BadInput, IsAJsonObjectWithJsonAndStillOneLine) {
  replace("recording.yaml", "size: 0.1", "size: 0");
  const CommandOutcome outcome =
      run_pcavr({"build", recording().string(), "-o", scene().string(), "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  const auto json = nlohmann::json::parse(outcome.standard_output, nullptr, false);
  ASSERT_TRUE(json.contains("error")) << outcome.standard_output;
  const auto& error = json["error"];
  EXPECT_EQ(error["file"], (recording() / "recording.yaml").string());
  EXPECT_EQ(error["place"], "markers[0].size");
  EXPECT_GT(error["line"].get<int>(), 0);
  EXPECT_EQ(error["exit_code"], 1);
  EXPECT_EQ("pcavr: " + error["text"].get<std::string>() + '\n', outcome.standard_error);
}

TEST_F(BadInput, PipesAndDevicesInsteadOfFiles) {
  for (const char* name : {"recording.yaml", "rgb.txt", "tool.csv", "objects/box.obj"}) {
    fs::remove_all(recording());
    fs::create_directories(recording());
    write_plain_recording(recording());
    fs::remove(recording() / name);
    ASSERT_EQ(::mkfifo((recording() / name).c_str(), 0600), 0);
    expect_refused({name, "pipe"}, "timeout 20 ");
    fs::remove(recording() / name);
    fs::create_symlink("/dev/zero", recording() / name);
    expect_refused({name, "device"}, "timeout 20 ");
    fs::remove(recording() / name);
    fs::create_symlink(recording() / name, recording() / name);
    expect_refused({name, "symbolic links"}, "timeout 20 ");
  }
}

TEST_F(BadInput, PipesAndLoopsInsteadOfAnImage) {
  const fs::path image = first_image("depth");
  fs::remove(image);
  ASSERT_EQ(::mkfifo(image.c_str(), 0600), 0);
  expect_refused({"depth.txt", image.filename().string(), "pipe"}, "timeout 20 ");
  fs::remove(image);
  fs::create_symlink(image, image);
  expect_refused({"depth.txt", image.filename().string(), "symbolic links"}, "timeout 20 ");
}

TEST_F(BadInput, ValuesThatAreEmpty) {
  const std::string folder = recording().string();
  const std::string out = scene().string();
  const std::vector<std::vector<std::string>> commands{
      {"build", "", "-o", out},
      {"build", folder, "-o", out, "--sensor", ""},
      {"identify", "friction", folder, "--scene", "", "-o", out},
      {"replay", folder, "--scene", folder, "--parameters", "", "-o", out},
      {"replay", folder, "--scene", folder, "--tracked", "", "-o", out},
      {"replay", folder, "--scene", folder, "--video", "", "-o", out},
      {"evaluate", folder, "--truth", "", "-o", out}};
  for (const std::vector<std::string>& command : commands) {
    const CommandOutcome outcome = run_pcavr(command);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find("is empty"), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists(scene()));
  }
}

TEST_F(BadInput, FolderAndNamesThatAreTooLong) {
  const std::string name(300, 'x');
  CommandOutcome outcome = run_pcavr({"build", recording().string() + name, "-o", "/nowhere/s"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("too long"), std::string::npos) << outcome.standard_error;
  outcome = run_pcavr({"build", recording().string(), "-o", (folder_.path() / name).string()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
}

TEST_F(BadInput, BytesThatAreNoUtf8InAName) {
  const fs::path odd = folder_.path() / "rec\xff\xfe";
  fs::rename(recording(), odd);
  const CommandOutcome outcome =
      run_pcavr({"build", odd.string(), "-o", scene().string(), "--json"});
  EXPECT_EQ(outcome.exit_code, 1);  // no tag is visible
  const auto json = nlohmann::json::parse(outcome.standard_output, nullptr, false);
  ASSERT_TRUE(json.contains("error")) << outcome.standard_output;
  EXPECT_NE(outcome.standard_error.find(R"(rec\xff\xfe/recording.yaml)"), std::string::npos)
      << outcome.standard_error;
  EXPECT_TRUE(is_utf8_text(outcome.standard_error));
  EXPECT_TRUE(is_utf8_text(outcome.standard_output));
  fs::rename(odd, recording());
}

TEST_F(BadInput, CountsSkippedRowsWithSkipBad) {
  // No images: the scene comes from the manifest alone, so that only the rows are bad.
  for (const char* name : {"rgb.txt", "depth.txt", "written.yaml"}) fs::remove(recording() / name);
  write("recording.yaml",
        "format: pcavr-recording/1\nobjects:\n  - name: box\n    mesh: objects/box.obj\n"
        "    pose: {t: [0.5, 0, 0.1], q: [0, 0, 0, 1]}\n");
  write("tool.csv",
        "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n0.1,nan,0,0,0,0,0,1\n0.2,inf,0,0,0,0,0,1\n"
        "0.3,1e9,0,0,0,0,0,1\n0.4,0,0,0,0,0,0,1\n");
  const CommandOutcome outcome =
      run_pcavr({"build", recording().string(), "-o", scene().string(), "--skip-bad", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  const auto json = nlohmann::json::parse(outcome.standard_output);
  const auto expected = nlohmann::json::parse(
      R"([{"file": "tool.csv", "reason": "not a finite number", "rows": 2},
          {"file": "tool.csv", "reason": "number out of range", "rows": 1}])");
  EXPECT_EQ(json["left_out"], expected);
  const std::string manifest = read_file(scene() / "scene.yaml").value();
  EXPECT_NE(manifest.find("not a finite number"), std::string::npos) << manifest;
  const CommandOutcome summary =
      run_pcavr({"build", recording().string(), "-o", scene().string(), "--skip-bad", "--force"});
  EXPECT_NE(summary.standard_output.find("tool.csv: not a finite number: 2"), std::string::npos)
      << summary.standard_output;
}

#ifndef PCAVR_IS_SANITIZED
TEST_F(BadInput, MemoryThatRunsOut) {
  int refusals = 0;
  // [KiB] The limits go from just enough to map the libraries to enough for the whole command.
  for (int limit = 350'000; limit <= 900'000; limit += 50'000) {
    const CommandOutcome outcome =
        run_pcavr({"build", recording().string(), "-o", scene().string()},
                  "ulimit -v " + std::to_string(limit) + "; ");
    if (outcome.exit_code == 127) continue;  // the dynamic loader failed
    EXPECT_EQ(outcome.exit_code, 1) << limit << ": " << outcome.standard_error;
    EXPECT_EQ(outcome.standard_error.find("internal error"), std::string::npos)
        << limit << ": " << outcome.standard_error;
    EXPECT_FALSE(fs::exists(scene()));
    ++refusals;
  }
  EXPECT_GT(refusals, 2);
}

/// [KiB] A thread's stack is as large as the limit on stacks, and does not fit into the memory.
TEST_F(BadInput, ThreadsThatRunOut) {
  expect_refused({"can't create a thread", "ulimit -u"}, "ulimit -s 4000000; ulimit -v 3000000; ");
}
#endif

}  // namespace
}  // namespace pcavr
