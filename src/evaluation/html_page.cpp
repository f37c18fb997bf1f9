// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/evaluation/html_page.hpp"

#include "pcavr/evaluation/html_text.hpp"

namespace pcavr {
namespace {

// Series colours: Okabe & Ito's palette, distinguishable with any kind of colour vision; lighter
// ones of the same hues on dark.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1c2126; --soft: #5b6570; --paper: #ffffff;
  --panel: #f5f7f9; --rule: #d7dde3; --moving: #f3dfb4; --static: #dde3e9; --critical: #f7dd93;
  --sliding: #c9e7d8; --lane-static: #b4bfca; --lane-critical: #e8b321; --lane-sliding: #3fa57c;
  --c0: #0072b2; --c1: #d55e00;
  --c2: #009e73; --c3: #aa4499; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8ebee; --soft: #a2adb8; --paper: #14181c;
  --panel: #1d2329; --rule: #39424b; --moving: #4a4022; --static: #2c353e; --critical: #574715;
  --sliding: #1d4536; --lane-static: #66727e; --lane-critical: #c99a1c; --lane-sliding: #38a079;
  --c0: #56b4e9; --c1: #f0905a;
  --c2: #3cc8a0; --c3: #dd99cc; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 24px 20px 48px; color: var(--ink);
  background: var(--paper); font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 26px; margin: 0 0 4px; }
h2 { font-size: 19px; margin: 36px 0 10px; }
.inputs { color: var(--soft); margin: 0; overflow-wrap: anywhere; }
.inputs b { color: var(--ink); font-weight: 600; }
.note { border-left: 4px solid var(--c1); padding: 4px 12px; background: var(--panel); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 12px 4px 0; border-bottom: 1px solid var(--rule); text-align: right;
  white-space: nowrap; }
th { color: var(--soft); font-weight: 600; }
th:first-child, td:first-child { text-align: left; }
.headline { margin-top: 16px; }
.headline td:first-child { white-space: normal; }
.headline td:nth-child(2) { font-weight: 650; font-size: 17px; padding-left: 20px;
  padding-right: 6px; }
.headline td:nth-child(3), .headline th:nth-child(3) { text-align: left; color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr));
  gap: 18px; align-items: start; }
figure { margin: 0; padding: 12px 14px 8px; background: var(--panel); border-radius: 8px;
  break-inside: avoid; }
figure.map { grid-row: span 2; }
figure.wide { margin-bottom: 18px; }
.tables { display: flex; flex-wrap: wrap; gap: 14px 48px; align-items: flex-start; }
.tables > * { max-width: 100%; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 440px), 1fr));
  gap: 0 40px; align-items: start; }
.plots + .tables { margin-top: 14px; }
h3, summary { font-size: 15px; font-weight: 600; margin: 8px 0 4px; }
summary { cursor: pointer; }
.below { color: var(--soft); font-size: 13px; max-width: 76ch; margin: 6px 0 0; }
.words td { text-align: left; white-space: normal; vertical-align: top; }
.words th { text-align: left; }
.words td:first-child { min-width: 22ch; }
figcaption { font-weight: 600; }
.legend { margin: 2px 0 4px; color: var(--soft); font-size: 13px; display: flex; flex-wrap: wrap;
  gap: 2px 16px; }
.legend span { display: inline-flex; align-items: center; gap: 6px; }
.key { width: 24px; height: 8px; }
.plot { width: 100%; height: auto; display: block; }
.plot text { fill: var(--soft); font-size: 12px; }
.plot .label { fill: var(--ink); font-size: 13px; }
.middle { text-anchor: middle; }
.end { text-anchor: end; }
.grid { stroke: var(--rule); stroke-width: 1; }
.frame { fill: none; stroke: var(--soft); stroke-width: 1; }
.mark { stroke: var(--soft); stroke-width: 1; stroke-dasharray: 2 3; }
.band0 { fill: var(--moving); } .band1 { fill: var(--static); }
.band2 { fill: var(--critical); } .band3 { fill: var(--sliding); }
.lane0 { fill: var(--rule); } .lane1 { fill: var(--lane-static); }
.lane2 { fill: var(--lane-critical); } .lane3 { fill: var(--lane-sliding); }
path { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
.dashed { stroke-dasharray: 6 5; }
path.pin { fill: var(--c3); stroke: var(--c3); stroke-width: 1; }
path.hollow { fill: none; }
.s0 { stroke: var(--c0); } .s1 { stroke: var(--c1); }
.s2 { stroke: var(--c2); } .s3 { stroke: var(--c3); }
footer { margin-top: 36px; color: var(--soft); font-size: 13px; }
@media print { body { max-width: none; padding: 0; } }
)";

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + body +
         "</body>\n</html>\n";
}

}  // namespace pcavr
