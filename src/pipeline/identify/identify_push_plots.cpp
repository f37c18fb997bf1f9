// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/report/number_text.hpp"

#include "identify_plots.hpp"

namespace pcavr {
namespace {

constexpr double kMinPhase = 0.020;  // [s] of a phase that is drawn
// Indices of the page's shades.
constexpr int kStatic = 1, kCritical = 2, kSliding = 3;

double critical_from(const LimitingFriction& limit) {
  return limit.pushes == 0 ? std::numeric_limits<double>::infinity()
                           : limit.mean - std::max(limit.std, 0.1 * limit.mean);
}

/// [s] for which the force is above `from` [N] before the breakaway.
double time_above(const Contact& contact, double from) {
  const std::vector<SmoothedSample> force = smooth(contact.t, contact.force, contact.t, 0.010);
  double above_since = contact.breakaway.t;
  for (std::size_t i = contact.t.size(); i-- > 0;) {
    if (contact.t[i] > contact.breakaway.t) continue;
    if (force[i].value < from || contact.t[i] < contact.begin) break;
    above_since = contact.t[i];
  }
  return contact.breakaway.t - above_since;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void add_bands(const Contact& contact, double critical, std::vector<PlotBand>& bands) {
  const std::vector<SmoothedSample> force = smooth(contact.t, contact.force, contact.t, 0.010);
  PlotBand* open = nullptr;
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    const double t = contact.t[i];
    if (t < contact.begin || t > contact.end) continue;
    const bool slides =
        std::any_of(contact.slides.begin(), contact.slides.end(),
                    [t](const SlideInterval& slide) { return t >= slide.begin && t <= slide.end; });
    const int kind = slides ? kSliding : force[i].value >= critical ? kCritical : kStatic;
    if (open == nullptr || (open->kind != kind && open->to - open->from >= kMinPhase)) {
      bands.push_back({t, t, kind});
      open = &bands.back();
    } else if (open->kind != kind) {
      open->kind = kind;
    }
    open->to = t;
  }
}

/// Force along the push, and the object's displacement: the tip's less the contact's penetration.
struct PushSeries {
  PlotSeries force{.label = "force along the push", .color = 1};
  PlotSeries object{.label = "object", .color = 0};
  PlotSeries tool{.label = "tool", .color = 2, .dashed = true};
  double base = 0.0;  ///< [m] displacement in earlier contacts

  void add(const Contact& contact, const std::optional<HuntCrossley>& contact_law) {
    std::vector<double> penetration(contact.t.size(), 0.0);
    if (contact_law) penetration = penetration_from_force(contact.t, contact.force, *contact_law);
    const auto first = static_cast<std::size_t>(
        std::lower_bound(contact.t.begin(), contact.t.end(), contact.begin) - contact.t.begin());
    const double zero = contact.tool[first] - penetration[first];
    double displacement = 0.0;
    for (std::size_t i = 0; i < contact.t.size(); ++i) {
      const double t = contact.t[i];
      force.x.push_back(t), force.y.push_back(contact.force[i]);
      const double tip = contact.tool[i] - zero;
      tool.x.push_back(t), tool.y.push_back(kMillimetres * (base + tip));
      const bool touches = t >= contact.begin && t <= contact.end;
      if (touches) displacement = tip - penetration[i];
      object.x.push_back(t), object.y.push_back(kMillimetres * (base + displacement));
    }
    base += displacement;
    for (PlotSeries* series : {&force, &object, &tool}) {
      series->x.push_back(kLineBreak), series->y.push_back(kLineBreak);
    }
  }
};

void add_figures(const std::string& what, const PushSeries& series,
                 const std::vector<PlotBand>& bands, std::vector<Plot>& plots) {
  const std::vector<std::string> labels{"", "static", "critical", "sliding"};
  plots.push_back({.title = what + ": force and phases",
                   .x_label = "time (s)",
                   .y_label = "force (N)",
                   .series = {series.force},
                   .bands = bands,
                   .band_labels = labels});
  plots.push_back({.title = what + ": displacement and phases",
                   .x_label = "time (s)",
                   .y_label = "displacement (mm)",
                   .series = {series.object, series.tool},
                   .bands = bands,
                   .band_labels = labels});
}

Plot breakaway_plot(const std::vector<const Contact*>& pushes, const LimitingFriction& limit) {
  Plot plot{.title = "Breakaway of each push", .x_label = "push", .y_label = "force (N)"};
  PlotSeries peak{.label = "measured at the tool", .color = 1, .points = true};
  PlotSeries own{.label = "friction limit without inertia", .color = 0, .points = true};
  double number = 0.0;
  for (const Contact* push : pushes) {
    if (!push->limit.is_excited) continue;
    number += 1.0;
    peak.x.push_back(number), peak.y.push_back(push->breakaway.force);
    own.x.push_back(number), own.y.push_back(push->limit.value);
  }
  plot.series = {peak, own};
  const std::vector<double> ends{0.5, number + 0.5};
  plot.series.push_back({.label = "F_M", .color = 2, .x = ends, .y = {limit.mean, limit.mean}});
  const double high = limit.mean + limit.std, low = limit.mean - limit.std;
  plot.series.push_back({.label = "± STD",
                         .color = 2,
                         .x = {ends[0], ends[1], kLineBreak, ends[0], ends[1]},
                         .y = {high, high, kLineBreak, low, low},
                         .dashed = true});
  return plot;
}

}  // namespace

ReportTable critical_band_table(const Identification& found, std::size_t object) {
  ReportTable table{.title = "Critical band below F_M",
                    .columns = {"band", "from (N)", "to (N)",
                                "median time in it before the breakaway (ms)", "pushes"}};
  const LimitingFriction& limit = found.objects[object].limit;
  if (limit.pushes < 2) return table;
  struct Band {
    const char* name;
    double from;
    double to;
  };
  const Band bands[] = {
      {"paper C: F_M ± STD", limit.mean - limit.std, limit.mean + limit.std},
      {"here: F_M less the larger of STD and 10 %", critical_from(limit), limit.mean}};
  for (const auto& [name, from, to] : bands) {
    std::vector<double> times;
    for (const Contact& contact : found.contacts) {
      const bool counts = contact.object == object && contact.left_out.empty() &&
                          contact.limit.is_excited && contact.breakaway.is_found;
      if (counts) times.push_back(time_above(contact, from));
    }
    if (times.empty()) continue;
    table.rows.push_back({name, readable(from), readable(to), readable(1e3 * median_of(times)),
                          std::to_string(times.size())});
  }
  table.note =
      "Why not paper C's band: the STD of repeated pushes is so small that the force crosses it "
      "within a few milliseconds, fewer than a phase needs to be detected and shown. Its width is "
      "the option teleop.phases.critical_share; 0 is paper C's.";
  return table;
}

std::vector<Plot> push_plots(const Identification& found, std::size_t object) {
  std::vector<Plot> plots;
  std::vector<const Contact*> pushes;
  for (const Contact& contact : found.contacts) {
    const bool is_push = contact.kind != ContactKind::press;
    if (contact.object == object && is_push && contact.left_out.empty()) {
      pushes.push_back(&contact);
    }
  }
  if (pushes.empty()) return plots;
  const ObjectIdentification& of = found.objects[object];
  const std::optional<HuntCrossley> contact_law = contact_law_of(of.parameters);
  const double critical = critical_from(of.limit);
  PushSeries all;
  std::vector<PlotBand> bands;
  for (const Contact* push : pushes) {
    all.add(*push, contact_law);
    add_bands(*push, critical, bands);
  }
  add_figures("All pushes", all, bands, plots);
  if (pushes.size() > 1) {
    PushSeries one;
    std::vector<PlotBand> own;
    one.add(*pushes.front(), contact_law);
    add_bands(*pushes.front(), critical, own);
    add_figures("The first push", one, own, plots);
  }
  if (of.limit.pushes > 0) plots.push_back(breakaway_plot(pushes, of.limit));
  return plots;
}

}  // namespace pcavr
