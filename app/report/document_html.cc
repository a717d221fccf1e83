// A document as one HTML page without scripts. HtmlWriter has a function for
// each kind of block (std::visit calls it) and appends to its text. Everything
// passes HtmlText() or HtmlEscape() except SVG, which is our own plotter's.
#include <fmt/core.h>

#include <string>
#include <string_view>

#include "app/report/document.h"
#include "app/report/page_style.h"
#include "app/text/format.h"
#include "app/text/text.h"

namespace touchdown::report {
namespace {

// Tables of so few rows are not split between pages.
constexpr std::size_t kKeepTogether = 12;
// Longer cells of numbers are reasons why there is none: they may be broken.
constexpr std::size_t kLongNumber = 28;

// The class that page_style.cc gives a colour; "" for plain text.
std::string_view CssClass(Tone tone) {
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

// Text with its signs: the minus and the plus-minus that a printer would set.
std::string HtmlText(std::string_view text) {
  return HtmlEscape(Typeset(text));
}

// A number whose uncertainty may stand in a line of its own, in one piece.
// Columns of Table 1 are narrow, and "± 0.048" must not be broken.
std::string InTwoLines(const std::string& text) {
  const std::size_t at = text.find(kPlusMinus);
  if (at == std::string::npos) return HtmlText(text);
  return fmt::format("{}<span class=\"u\">{}</span>",
                     HtmlText(text.substr(0, at)), HtmlText(text.substr(at)));
}

// The id that the contents lead to: "section-3" for the third heading of level
// 2 (`heading` counts from 0).
std::string Anchor(std::size_t heading) {
  return fmt::format("section-{}", heading + 1);
}

// Writes blocks of one section, of which `simulated` says whether captions bear
// the watermark's word.
class HtmlWriter {
 public:
  // `headings` counts those of level 2 written so far.
  HtmlWriter(const Document& document, bool simulated, std::size_t& headings)
      : document_(document), simulated_(simulated), headings_(headings) {}

  void operator()(const Heading& heading) {
    const std::string id = heading.level == 2
                               ? fmt::format(" id=\"{}\"", Anchor(headings_++))
                               : "";
    out_ += fmt::format("<h{0}{1}>{2}</h{0}>\n", heading.level, id,
                        HtmlText(heading.text));
  }
  // Lists the headings of the whole document, also of the sections that follow:
  // the numbers of their anchors are counted anew and agree with `headings_`.
  void operator()(const Contents&) {
    out_ += "<nav aria-label=\"Contents\">\n<ol>\n";
    std::size_t at = 0;
    for (const Heading& heading : ListHeadings(document_)) {
      out_ += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", Anchor(at++),
                          HtmlText(heading.text));
    }
    out_ += "</ol>\n</nav>\n";
  }
  void operator()(const Paragraph& paragraph) {
    out_ +=
        fmt::format("<p{}>{}</p>\n", paragraph.muted ? " class=\"muted\"" : "",
                    HtmlText(paragraph.text));
  }
  void operator()(const List& list) {
    out_ += "<ul>\n";
    for (const std::string& item : list.items) {
      out_ += "<li>" + HtmlText(item) + "</li>\n";
    }
    out_ += "</ul>\n";
  }
  void operator()(const Terms& terms) {
    out_ += terms.lead ? "<dl class=\"lead\">\n" : "<dl>\n";
    for (const auto& [term, text] : terms.items) {
      out_ += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", HtmlText(term),
                          HtmlText(text));
    }
    out_ += "</dl>\n";
  }
  void operator()(const Callout& callout) {
    out_ += fmt::format("<div class=\"callout {}\"><b>{}</b> {}</div>\n",
                        CssClass(callout.tone), HtmlText(callout.title),
                        HtmlText(callout.text));
  }
  void operator()(const Table& table) {
    // A group that the keyboard can scroll where the table is wider than the
    // page.
    out_ += fmt::format(
        "<div class=\"scroll\" role=\"group\" aria-label=\"{}\" "
        "tabindex=\"0\">\n<table class=\"{}{}\">\n",
        HtmlEscape(table.caption.empty() ? "table" : table.caption),
        table.rows.size() <= kKeepTogether ? "keep" : "",
        table.row_headings ? " across" : "");
    // A table that is copied out of the page still says that it is simulated.
    if (!table.caption.empty()) {
      out_ += fmt::format("<caption>{}{}</caption>\n", HtmlText(table.caption),
                          simulated_ ? " (simulated)" : "");
    }
    out_ += "<thead><tr>";
    for (const Column& column : table.columns) {
      out_ += column.heading.empty()
                  ? "<td></td>"
                  : fmt::format("<th scope=\"col\"{}>{}</th>",
                                column.numeric ? " class=\"num\"" : "",
                                HtmlText(column.heading));
    }
    out_ += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) WriteRow(table, row);
    out_ += "</tbody>\n</table>\n</div>\n";
  }
  // The plot with its alternative text, and the numbers behind it, folded away
  // on the screen and left out in print.
  void operator()(const Figure& figure) {
    out_ += fmt::format(
        "<figure>\n<div class=\"plot\" role=\"img\" aria-label=\"{}\" "
        "tabindex=\"0\">\n{}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
        HtmlText(figure.alt), figure.svg, HtmlText(figure.caption));
    if (!figure.data.rows.empty()) {
      out_ += "<details><summary>The numbers behind this plot</summary>\n";
      (*this)(figure.data);
      out_ += "</details>\n";
    }
  }
  // The bytes stand in the page, so that it loads nothing.
  void operator()(const Picture& picture) {
    out_ += fmt::format(
        "<figure>\n<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n"
        "<figcaption>{}</figcaption>\n</figure>\n",
        HtmlText(picture.alt), picture.png_base64, HtmlText(picture.caption));
  }
  void operator()(const Strip& strip) {
    out_ += fmt::format(
        "<figure class=\"strip\">\n<figcaption>{}</figcaption>\n<div "
        "class=\"panels\" role=\"img\" aria-label=\"{}\">\n",
        HtmlText(strip.caption), HtmlText(strip.alt));
    for (const Strip::Panel& panel : strip.panels) {
      out_ +=
          fmt::format("<div>{}{}</div>\n", panel.svg, HtmlText(panel.label));
    }
    out_ += "</div>\n</figure>\n";
  }
  void operator()(const Link& link) {
    out_ += "<p>" + Linked(link.to, link.text) + "</p>\n";
  }
  void operator()(const PageBreak&) {
    out_ += "<div class=\"page-break\"></div>\n";
  }

  const std::string& html() const { return out_; }

 private:
  // One row. A cell has the class of its tone, and "num" in a column of
  // numbers, which are set flush right.
  void WriteRow(const Table& table, const std::vector<Cell>& row) {
    out_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::string classes(CssClass(row[i].tone));
      if (i < table.columns.size() && table.columns[i].numeric) {
        classes += classes.empty() ? "num" : " num";
        // Such a cell holds a reason for an absence.
        if (row[i].text.size() > kLongNumber) classes += " long";
      }
      const bool is_heading = i == 0 && table.row_headings;
      out_ += is_heading ? "<th scope=\"row\"" : "<td";
      if (!classes.empty()) out_ += fmt::format(" class=\"{}\"", classes);
      const bool is_narrow = table.row_headings && !is_heading;
      out_ += ">" +
              (is_narrow ? InTwoLines(row[i].text)
                         : Linked(row[i].link, row[i].text)) +
              (is_heading ? "</th>" : "</td>");
    }
    out_ += "</tr>\n";
  }

  // Text as a link where there is a target. A link is a name, in which hyphens
  // stay hyphens.
  static std::string Linked(const std::string& to, const std::string& text) {
    if (to.empty()) return HtmlText(text);
    return fmt::format("<a href=\"{}\">{}</a>", HtmlEscape(to),
                       HtmlEscape(text));
  }

  const Document& document_;
  bool simulated_;
  std::size_t& headings_;
  std::string out_;
};

}  // namespace

std::vector<Heading> ListHeadings(const Document& document) {
  std::vector<Heading> out;
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      const auto* heading = std::get_if<Heading>(&block);
      if (heading != nullptr && heading->level == 2) out.push_back(*heading);
    }
  }
  return out;
}

std::string ToHtml(const Document& document) {
  // The policy lets the browser load nothing at all but styles and pictures in
  // the page itself, even if a text of a trial held markup.
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; style-src 'unsafe-inline'; img-src data:\">\n"
      "<title>{0}</title>\n<style>{1}{2}</style>\n</head>\n<body>\n<main>\n"
      "<h1>{0}</h1>\n",
      HtmlText(document.title), kPageStyle, PrintedFooter(document.footer));
  // Counted over all sections, as the anchors are.
  std::size_t headings = 0;
  for (const Section& section : document.sections) {
    out +=
        section.simulated ? "<section class=\"simulated\">\n" : "<section>\n";
    HtmlWriter writer(document, section.simulated, headings);
    // The banner follows a leading page break and heading: it belongs to the
    // page that they begin.
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
    HtmlWriter rest(document, section.simulated, headings);
    for (; block != section.blocks.end(); ++block) std::visit(rest, *block);
    out += rest.html() + "</section>\n";
  }
  out += "</main>\n</body>\n</html>\n";
  return out;
}

}  // namespace touchdown::report
