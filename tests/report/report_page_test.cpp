// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_page.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"

#include "support/report_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::json;

/// A page with one of everything, and names that are markup.
ReportPage a_page() {
  Plot plot{.title = "force",
            .x_label = "time (s)",
            .y_label = "force (N)",
            .bands = {{1.0, 2.0, 3}},
            .band_labels = {"", "static", "critical", "sliding"},
            .marks = {{1.5, "t1"}},
            .pins = {{1.7, true}},
            .pin_label = "correction arrives",
            .hollow_pin_label = "correction lost",
            .y_from_zero = true,
            .x_from = 0.5};
  plot.series = {
      {.label = "measured", .color = 1, .x = {0.5, kLineBreak, 2.0}, .y = {1, kLineBreak, 3}}};
  ReportPage page{.title = "Run: </script><script>", .heading = "Run"};
  page.inputs = {{{"run "}, {"<!-- & \"my\" run", true}}};
  page.headline = {.title = "", .columns = {"metric", "value"}, .rows = {{"error", "1.5"}}};
  const LaneChart lanes{.title = "Phases",
                        .x_label = "time (s)",
                        .kind_labels = {"free"},
                        .lanes = {{"box", "truth", {{0.0, 1.0, 0}}}}};
  const ReportTable table{.title = "Nodes",
                          .columns = {"node", "time (s)"},
                          .rows = {{"t1", "1.500"}},
                          .note = "of each push",
                          .is_folded = true};
  page.sections = {{"box",
                    {PageText{"at rest", true}, lanes, PlotGroup{"Plots", {plot}},
                     std::vector{table}, PagePicture{"Picture", "jpeg!", "its file"}}}};
  page.footer = "the end";
  return page;
}

TEST(ReportPage, HasEverythingAsData) {
  const Json data = Json::parse(format_report_data(a_page()));
  EXPECT_EQ(data["title"], "Run: </script><script>");
  EXPECT_EQ(data["inputs"][0][1]["text"], "<!-- & \"my\" run");
  EXPECT_EQ(data["headline"]["rows"][0][1], "1.5");
  EXPECT_EQ(data["footer"], "the end");
  const Json& blocks = data["sections"][0]["blocks"];
  EXPECT_EQ(blocks[0], Json({{"kind", "text"}, {"text", "at rest"}, {"highlighted", true}}));
  EXPECT_EQ(blocks[1]["lanes"][0]["intervals"][0]["to"], 1.0);
  const Json& plot = blocks[2]["plots"][0];
  EXPECT_EQ(plot["series"][0]["x"], Json::parse("[0.5, null, 2.0]"));
  EXPECT_EQ(plot["series"][0]["y"], Json::parse("[1.0, null, 3.0]"));
  EXPECT_EQ(plot["x_from"], 0.5);
  EXPECT_TRUE(plot["y_from_zero"]);
  EXPECT_FALSE(plot.contains("x_to"));
  EXPECT_EQ(plot["marks"][0]["label"], "t1");
  EXPECT_TRUE(plot["pins"][0]["hollow"]);
  EXPECT_EQ(plot["bands"][0]["kind"], 3);
  EXPECT_EQ(blocks[3]["tables"][0]["note"], "of each push");
  EXPECT_TRUE(blocks[3]["tables"][0]["folded"]);
  EXPECT_EQ(blocks[4]["source"], "data:image/jpeg;base64,anBlZyE=");
  EXPECT_EQ(blocks[4]["note"], "its file");
}

TEST(ReportPage, HasNoMarkupInItsData) {
  EXPECT_EQ(format_report_data(a_page()).find('<'), std::string::npos);
}

TEST(ReportPage, IsTheSameBytesEachTime) {
  EXPECT_EQ(format_report_data(a_page()), format_report_data(a_page()));
}

TEST(ReportPage, AMillionPointsBecomeASmallFile) {
  ReportPage page;
  Plot plot{.title = "long", .x_label = "x", .y_label = "y"};
  plot.series.emplace_back();
  for (int i = 0; i < 1'000'000; ++i) {
    plot.series[0].x.push_back(1e-3 * i);
    plot.series[0].y.push_back(1e-6 * i * (i % 7));
  }
  page.sections = {{"long", {PlotGroup{"", {plot}}}}};
  EXPECT_LT(format_report_data(page).size(), 100'000U);
}

TEST(ReportPage, WritesOneFileThatHasTheData) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_report_page(a_page(), folder.path()).has_value());
  EXPECT_EQ(report_data(folder.path()).find("</"), std::string::npos);
  EXPECT_EQ(Json::parse(report_data(folder.path())), Json::parse(format_report_data(a_page())));
  const char* written = has_report_page() ? kReportPageFile : kReportDataFile;
  const char* other = has_report_page() ? kReportDataFile : kReportPageFile;
  EXPECT_NE(how_to_open(folder.path()).find(folder.path() / written), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / other));
}

TEST(ReportPage, IsAnErrorWhereItCanNotBeWritten) {
  EXPECT_FALSE(write_report_page(a_page(), "/nowhere/at/all").has_value());
}

}  // namespace
}  // namespace pcavr
