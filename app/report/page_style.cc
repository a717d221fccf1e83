#include "app/report/page_style.h"

#include <fmt/core.h>

namespace touchdown::report {

// The watermark is a background picture of each simulated section, so that it
// lies behind every line of it, on the screen and on paper. What a colour says
// is said by a word, a weight or a mark, too: readers and printers may see
// none.
//
// The parts, in order: colours in light and dark; text, tables and figures on a
// screen of any width; A4 paper, where rows and figures are not split between
// pages and what is folded on the screen is left out. The classes are those
// that document_html.cc writes.
const std::string_view kPageStyle = R"css(
:root { color-scheme: light dark; --ink: #1c2126; --soft: #56616b;
  --line: #d4dadf; --paper: #fff; --box: #f3f5f7; --slide: #17548f;
  --bounce: #a83d0b; --good: #1f6f3f; --bad: #a3201d; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ec; --soft: #a9b4bd; --line: #3a434b; --paper: #15191d;
    --box: #20272d; --slide: #8fc1f2; --bounce: #f5a277; --good: #84d3a3;
    --bad: #ff9d97; }
  .plot svg { filter: invert(1) hue-rotate(180deg); }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1120px; padding: 28px 36px 60px;
  color: var(--ink); background: var(--paper); font: 15px/1.5 "Liberation Sans",
  Arial, Helvetica, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 27px; line-height: 1.2; margin: 0 0 10px; }
h2 { font-size: 20px; margin: 34px 0 8px; padding-top: 10px;
  border-top: 2px solid var(--ink); }
h3 { font-size: 16px; margin: 22px 0 6px; }
p { margin: 6px 0 10px; max-width: 84ch; }
ul, ol { margin: 6px 0 12px; padding-left: 22px; max-width: 84ch; }
li { margin: 3px 0; }
nav ol { columns: 2 300px; font-size: 14px; }
.muted { color: var(--soft); font-size: 13px; }
dl { margin: 10px 0 16px; font-size: 14px; }
dl div { display: grid; grid-template-columns: 12em 1fr; gap: 0 16px;
  padding: 3px 0; border-bottom: 1px solid var(--line); }
dt { font-weight: bold; } dd { margin: 0; max-width: 92ch; }
dl.lead { font-size: 16.5px; } dl.lead div { border: 0; }
.scroll { overflow-x: auto; margin: 10px 0 16px; }
table { border-collapse: collapse; font-size: 13.5px;
  font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: bold; padding: 0 0 5px; }
th { text-align: left; vertical-align: bottom; padding: 3px 12px 3px 0;
  font-size: 12.5px; }
thead th { border-bottom: 1.5px solid var(--ink); }
td, tbody th { border-bottom: 1px solid var(--line); padding: 3px 12px 3px 0;
  vertical-align: top; }
th.num, td.num { text-align: right; }
td.num { white-space: nowrap; }
td.long { white-space: normal; min-width: 14ch; }
.across td, .across th { padding-right: 9px; }
.across td.num { white-space: normal; } .u { white-space: nowrap; }
td.muted { overflow-wrap: anywhere; min-width: 8ch; }
td.muted:last-child { min-width: 20ch; }
.across td.muted { min-width: 0; } .across tbody th { min-width: 13em; }
.slide { color: var(--slide); }
.bounce { color: var(--bounce); font-weight: bold; }
.undecided { font-style: italic; }
.good { color: var(--good); }
.bad { color: var(--bad); font-weight: bold; }
.callout { border-left: 5px solid var(--soft); background: var(--box);
  padding: 9px 14px; margin: 10px 0; }
.callout.good { border-color: var(--good); color: inherit; }
.callout.bad { border-color: var(--bad); color: inherit; font-weight: normal; }
.callout b { margin-right: 4px; }
.banner { border: 1.5px solid var(--bad); color: var(--bad); font-weight: bold;
  padding: 5px 12px; margin: 10px 0; letter-spacing: .03em;
  background: var(--paper); }
section.simulated { background-image: url("data:image/svg+xml,%3Csvg \
xmlns='http://www.w3.org/2000/svg' width='400' height='260'%3E%3Ctext x='200' \
y='146' text-anchor='middle' transform='rotate(-26 200 130)' font-family='Arial,sans-serif' \
font-size='46' font-weight='bold' fill='%23a3201d' fill-opacity='0.09'\
%3ESIMULATED%3C/text%3E%3C/svg%3E"); -webkit-print-color-adjust: exact;
  print-color-adjust: exact; }
figure { margin: 12px 0 16px; break-inside: avoid; }
figure img { max-width: 100%; height: auto; display: block; }
a { color: var(--slide); }
.plot { overflow-x: auto; }
.plot svg { width: 100%; min-width: 640px; height: auto; display: block; }
figure svg text { font-family: "Liberation Sans", Arial, sans-serif; }
figcaption { font-size: 13px; color: var(--soft); max-width: 92ch; }
figure.strip figcaption { color: var(--ink); margin-bottom: 4px; }
.panels { display: grid; grid-template-columns: repeat(auto-fit,
  minmax(150px, 1fr)); gap: 6px; }
.panels div { font-size: 12.5px; font-variant-numeric: tabular-nums; }
.panels svg { width: 100%; height: auto; display: block; }
details { font-size: 13px; margin: 4px 0 12px; }
summary { cursor: pointer; color: var(--soft); }
@media (max-width: 600px) {
  body { padding: 16px 14px 40px; } h1 { font-size: 22px; }
  dl div { grid-template-columns: 1fr; }
}
@page { size: A4; margin: 15mm 14mm 18mm; }
@media print {
  :root { color-scheme: light; --ink: #1c2126; --soft: #56616b;
    --line: #d4dadf; --paper: #fff; --box: #f3f5f7; --slide: #17548f;
    --bounce: #a83d0b; --good: #1f6f3f; --bad: #a3201d; }
  .plot svg { filter: none; min-width: 0; }
  body { max-width: none; padding: 0; font-size: 10pt; line-height: 1.38; }
  h1 { font-size: 16pt; } h2 { font-size: 13pt; } h3 { font-size: 11pt; }
  h2, h3 { break-after: avoid; } ul, ol { font-size: 9pt; line-height: 1.3; }
  nav ol { font-size: 9pt; columns: 2; }
  dl { font-size: 8.8pt; line-height: 1.3; margin: 5px 0 8px; }
  dl.lead { font-size: 9.6pt; } dd { max-width: none; }
  dl div { grid-template-columns: 36mm 1fr; padding: 1.2px 0;
    break-inside: avoid; }
  .scroll, .plot { overflow: visible; }
  table { font-size: 8.6pt; } .scroll { margin: 6px 0 10px; }
  th { font-size: 8pt; }
  th, td { padding: 1.5px 10px 1.5px 0; }
  .across td, .across th { padding-right: 5px; font-size: 8pt; }
  .across tbody th { min-width: 33mm; }
  td.muted:last-child { min-width: 24ch; } .across td.muted { min-width: 0; }
  p, .callout, .banner, figure { margin: 5px 0 6px; }
  .callout { font-size: 9.4pt; padding: 6px 11px; }
  thead { display: table-header-group; }
  tr, .keep, .callout, .banner, figure { break-inside: avoid; }
  caption { break-after: avoid; }
  .muted, figcaption { font-size: 8.8pt; }
  .panels { grid-template-columns: repeat(3, 1fr); }
  .panels div { font-size: 8pt; }
  p, ul, ol, figcaption { max-width: none; }
  .page-break { break-before: page; }
  .page-break + h2 { border-top: 0; margin-top: 0; }
  details { display: none; }
}
)css";

std::string PrintedFooter(std::string_view footer) {
  // A string of CSS: whatever is no letter, digit or space is written as its
  // number ("\2c " for a comma), so that no name of a laboratory ends the
  // string. Bytes of UTF-8 above 127 stand for themselves.
  std::string text;
  for (const char c : footer) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || c == ' ' || (c >= '0' && c <= '9') ||
                       (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    text += plain ? std::string(1, c) : fmt::format("\\{:x} ", byte);
  }
  // Margin boxes take no style from the page.
  constexpr std::string_view kLook =
      "font: 8pt \"Liberation Sans\", Arial, sans-serif; color: #56616b;";
  return fmt::format(
      "@page {{ @bottom-left {{ content: \"{0}\"; {1} }} @bottom-right {{ "
      "content: \"page \" counter(page) \" of \" counter(pages); {1} }} }}\n",
      text, kLook);
}

}  // namespace touchdown::report
