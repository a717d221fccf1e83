#include <fmt/core.h>

#include <string>
#include <string_view>

#include "app/report/document.h"
#include "app/report/text.h"

namespace touchdown::report {
namespace {

// The watermark is a background picture of each simulated section, so that it
// lies behind every line of it, on the screen and on paper.
constexpr std::string_view kStyle = R"css(
:root { --ink: #1c2126; --soft: #5b6670; --line: #d4dadf; --slide: #17548f;
  --bounce: #b3430f; --good: #1f6f3f; --bad: #a3201d; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1120px; padding: 28px 36px 60px;
  color: var(--ink); background: #fff; font: 15px/1.5 "Liberation Sans", Arial,
  Helvetica, sans-serif; }
h1 { font-size: 27px; line-height: 1.2; margin: 0 0 6px; }
h2 { font-size: 20px; margin: 34px 0 8px; padding-top: 10px;
  border-top: 2px solid var(--ink); }
h3 { font-size: 16px; margin: 22px 0 6px; }
p { margin: 6px 0 10px; max-width: 84ch; }
ul { margin: 6px 0 12px; padding-left: 22px; max-width: 84ch; }
li { margin: 3px 0; }
.muted { color: var(--soft); font-size: 13px; }
table { border-collapse: collapse; margin: 10px 0 16px; font-size: 13.5px;
  font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: bold; padding: 0 0 5px; }
th { text-align: left; vertical-align: bottom; border-bottom: 1.5px solid
  var(--ink); padding: 3px 12px 3px 0; font-size: 12.5px; }
td { border-bottom: 1px solid var(--line); padding: 3px 12px 3px 0;
  vertical-align: top; }
th.num { text-align: right; }
td.num { text-align: right; white-space: nowrap; }
td.long { white-space: normal; min-width: 14ch; }
td.muted { overflow-wrap: anywhere; min-width: 8ch; }
td.muted:last-child { min-width: 16ch; }
.slide { color: var(--slide); }
.bounce { color: var(--bounce); font-weight: bold; }
.undecided { font-style: italic; }
.good { color: var(--good); }
.bad { color: var(--bad); font-weight: bold; }
.callout { border-left: 5px solid var(--soft); background: #f3f5f7cc;
  padding: 9px 14px; margin: 10px 0; }
.callout.good { border-color: var(--good); color: inherit; }
.callout.bad { border-color: var(--bad); color: inherit; font-weight: normal; }
.callout b { margin-right: 4px; }
.banner { border: 1.5px solid var(--bad); color: var(--bad); font-weight: bold;
  padding: 5px 12px; margin: 10px 0; letter-spacing: .03em; background: #fff; }
section.simulated { background-image: url("data:image/svg+xml,%3Csvg \
xmlns='http://www.w3.org/2000/svg' width='400' height='260'%3E%3Ctext x='200' \
y='146' text-anchor='middle' transform='rotate(-26 200 130)' font-family='Arial,sans-serif' \
font-size='46' font-weight='bold' fill='%23a3201d' fill-opacity='0.09'\
%3ESIMULATED%3C/text%3E%3C/svg%3E"); -webkit-print-color-adjust: exact;
  print-color-adjust: exact; }
figure { margin: 12px 0 16px; break-inside: avoid; }
figure img { max-width: 100%; height: auto; display: block; }
a { color: var(--slide); }
figure svg { width: 100%; height: auto; display: block; }
figure svg text { font-family: "Liberation Sans", Arial, sans-serif; }
figcaption { font-size: 13px; color: var(--soft); max-width: 92ch; }
details { font-size: 13px; margin: 4px 0 12px; }
summary { cursor: pointer; color: var(--soft); }
@page { size: A4; margin: 15mm 14mm 16mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; line-height: 1.38; }
  h1 { font-size: 17pt; } h2 { font-size: 13pt; } h3 { font-size: 11pt; }
  h2, h3 { break-after: avoid; } ul { font-size: 9pt; line-height: 1.3; }
  table { font-size: 8.6pt; margin: 6px 0 10px; } th { font-size: 8pt; }
  th, td { padding: 1.5px 10px 1.5px 0; }
  p, .callout, .banner, figure { margin: 5px 0 6px; }
  .callout { font-size: 9.4pt; padding: 6px 11px; }
  thead { display: table-header-group; }
  tr, .keep, .callout, .banner, figure { break-inside: avoid; }
  caption { break-after: avoid; }
  .muted, figcaption { font-size: 8.8pt; }
  p, ul, figcaption { max-width: none; }
  .page-break { break-before: page; }
  .page-break + h2 { border-top: 0; margin-top: 0; }
  details { display: none; }
}
)css";

// Tables of so few rows are not split between pages.
constexpr std::size_t kKeepTogether = 12;
// Longer cells of numbers are reasons why there is none: they may be broken.
constexpr std::size_t kLongNumber = 28;

std::string_view ClassOf(Tone tone) {
  switch (tone) {
    case Tone::kSlide:
      return "slide";
    case Tone::kBounce:
      return "bounce";
    case Tone::kUndecided:
      return "undecided";
    case Tone::kGood:
      return "good";
    case Tone::kBad:
      return "bad";
    case Tone::kMuted:
      return "muted";
    case Tone::kPlain:
      break;
  }
  return "";
}

class Writer {
 public:
  explicit Writer(bool simulated) : simulated_(simulated) {}

  void operator()(const Heading& heading) {
    out_ += fmt::format("<h{0}>{1}</h{0}>\n", heading.level,
                        HtmlEscape(heading.text));
  }
  void operator()(const Paragraph& paragraph) {
    out_ +=
        fmt::format("<p{}>{}</p>\n", paragraph.muted ? " class=\"muted\"" : "",
                    HtmlEscape(paragraph.text));
  }
  void operator()(const List& list) {
    out_ += "<ul>\n";
    for (const std::string& item : list.items) {
      out_ += "<li>" + HtmlEscape(item) + "</li>\n";
    }
    out_ += "</ul>\n";
  }
  void operator()(const Callout& callout) {
    out_ += fmt::format("<div class=\"callout {}\"><b>{}</b> {}</div>\n",
                        ClassOf(callout.tone), HtmlEscape(callout.title),
                        HtmlEscape(callout.text));
  }
  void operator()(const Table& table) {
    out_ += table.rows.size() <= kKeepTogether ? "<table class=\"keep\">\n"
                                               : "<table>\n";
    if (!table.caption.empty()) {
      out_ +=
          fmt::format("<caption>{}{}</caption>\n", HtmlEscape(table.caption),
                      simulated_ ? " (simulated)" : "");
    }
    out_ += "<thead><tr>";
    for (const Column& column : table.columns) {
      out_ += fmt::format("<th scope=\"col\"{}>{}</th>",
                          column.numeric ? " class=\"num\"" : "",
                          HtmlEscape(column.heading));
    }
    out_ += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      out_ += "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i) {
        std::string classes(ClassOf(row[i].tone));
        if (i < table.columns.size() && table.columns[i].numeric) {
          classes += classes.empty() ? "num" : " num";
          if (row[i].text.size() > kLongNumber) classes += " long";
        }
        out_ += classes.empty() ? "<td>"
                                : fmt::format("<td class=\"{}\">", classes);
        out_ += Linked(row[i].link, row[i].text) + "</td>";
      }
      out_ += "</tr>\n";
    }
    out_ += "</tbody>\n</table>\n";
  }
  void operator()(const Figure& figure) {
    out_ += fmt::format(
        "<figure>\n<div role=\"img\" aria-label=\"{}\">\n{}</div>\n"
        "<figcaption>{}</figcaption>\n</figure>\n",
        HtmlEscape(figure.alt), figure.svg, HtmlEscape(figure.caption));
    if (!figure.data.rows.empty()) {
      out_ += "<details><summary>The numbers behind this plot</summary>\n";
      (*this)(figure.data);
      out_ += "</details>\n";
    }
  }
  void operator()(const Picture& picture) {
    out_ += fmt::format(
        "<figure>\n<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n"
        "<figcaption>{}</figcaption>\n</figure>\n",
        HtmlEscape(picture.alt), picture.png_base64,
        HtmlEscape(picture.caption));
  }
  void operator()(const Link& link) {
    out_ += "<p>" + Linked(link.to, link.text) + "</p>\n";
  }
  void operator()(const PageBreak&) {
    out_ += "<div class=\"page-break\"></div>\n";
  }

  const std::string& html() const { return out_; }

 private:
  static std::string Linked(const std::string& to, const std::string& text) {
    if (to.empty()) return HtmlEscape(text);
    return fmt::format("<a href=\"{}\">{}</a>", HtmlEscape(to),
                       HtmlEscape(text));
  }

  bool simulated_;
  std::string out_;
};

}  // namespace

std::string ToHtml(const Document& document) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; style-src 'unsafe-inline'; img-src data:\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n"
      "<h1>{0}</h1>\n",
      HtmlEscape(document.title), kStyle);
  for (const Section& section : document.sections) {
    out +=
        section.simulated ? "<section class=\"simulated\">\n" : "<section>\n";
    Writer writer(section.simulated);
    // The banner follows a leading page break and heading.
    auto block = section.blocks.begin();
    while (block != section.blocks.end() &&
           (std::holds_alternative<PageBreak>(*block) ||
            std::holds_alternative<Heading>(*block))) {
      std::visit(writer, *block++);
    }
    out += writer.html();
    if (section.simulated) {
      out += fmt::format("<div class=\"banner\">{}</div>\n", kWatermark);
    }
    Writer rest(section.simulated);
    for (; block != section.blocks.end(); ++block) std::visit(rest, *block);
    out += rest.html() + "</section>\n";
  }
  out += "</body>\n</html>\n";
  return out;
}

}  // namespace touchdown::report
