// A document as GitHub's Markdown. What a page shows by colour, fold or link
// target is left out; plots and pictures are their alternative texts.
#include <fmt/core.h>

#include <string>

#include "app/report/document.h"
#include "app/text/text.h"

namespace touchdown::report {
namespace {

// Escaped text with the signs of a printer.
std::string MarkdownText(const std::string& text) {
  return MarkdownEscape(Typeset(text));
}

// Writes the blocks of one section. Headings, tables and figures of simulated
// trials say so one by one: Markdown has no background.
class MarkdownWriter {
 public:
  MarkdownWriter(const Document& document, bool simulated)
      : document_(document), simulated_(simulated) {}

  void operator()(const Heading& heading) {
    out_ += std::string(static_cast<std::size_t>(heading.level), '#') + " " +
            MarkdownText(heading.text) + (simulated_ ? " (SIMULATED)" : "") +
            "\n\n";
  }
  void operator()(const Contents&) {
    for (const Heading& heading : ListHeadings(document_)) {
      out_ += "- " + MarkdownText(heading.text) + "\n";
    }
    out_ += "\n";
  }
  void operator()(const Paragraph& paragraph) {
    out_ += MarkdownText(paragraph.text) + "\n\n";
  }
  void operator()(const List& list) {
    for (const std::string& item : list.items) {
      out_ += "- " + MarkdownText(item) + "\n";
    }
    out_ += "\n";
  }
  void operator()(const Terms& terms) {
    for (const auto& [term, text] : terms.items) {
      out_ += "- **" + MarkdownText(term) + "**: " + MarkdownText(text) + "\n";
    }
    out_ += "\n";
  }
  void operator()(const Callout& callout) {
    out_ += "> **" + MarkdownText(callout.title) + "** " +
            MarkdownText(callout.text) + "\n\n";
  }
  void operator()(const Table& table) {
    if (!table.caption.empty()) {
      out_ += "**" + MarkdownText(table.caption) +
              (simulated_ ? " (SIMULATED)" : "") + "**\n\n";
    }
    // Heading, rule with the alignment ("---:" is flush right), rows.
    for (const Column& column : table.columns) {
      out_ += "| " + MarkdownText(column.heading) + " ";
    }
    out_ += "|\n";
    for (const Column& column : table.columns) {
      out_ += column.numeric ? "|---:" : "|---";
    }
    out_ += "|\n";
    for (const auto& row : table.rows) {
      for (const Cell& cell : row) {
        out_ += "| " + Linked(cell.link, cell.text) + " ";
      }
      out_ += "|\n";
    }
    out_ += "\n";
  }
  void operator()(const Figure& figure) {
    out_ += "*Figure" + std::string(simulated_ ? " (SIMULATED)" : "") + ": " +
            MarkdownText(figure.caption) + "* " + MarkdownText(figure.alt) +
            "\n\n";
  }
  void operator()(const Picture& picture) {
    out_ += "*" + MarkdownText(picture.caption) + "* " +
            MarkdownText(picture.alt) + "\n\n";
  }
  void operator()(const Strip& strip) {
    out_ += "*" + MarkdownText(strip.caption) + "* " + MarkdownText(strip.alt) +
            "\n\n";
  }
  void operator()(const Link& link) {
    out_ += Linked(link.to, link.text) + "\n\n";
  }
  void operator()(const PageBreak&) { out_ += "---\n\n"; }

  const std::string& text() const { return out_; }

 private:
  // Targets are relative paths of our own, which need no escaping.
  static std::string Linked(const std::string& to, const std::string& text) {
    if (to.empty()) return MarkdownText(text);
    return "[" + MarkdownEscape(text) + "](" + to + ")";
  }

  const Document& document_;
  bool simulated_;
  std::string out_;
};

}  // namespace

std::string ToMarkdown(const Document& document) {
  std::string out = "# " + MarkdownText(document.title) + "\n\n";
  for (const Section& section : document.sections) {
    if (section.simulated) out += fmt::format("> **{}**\n\n", kWatermark);
    MarkdownWriter writer(document, section.simulated);
    for (const Block& block : section.blocks) std::visit(writer, block);
    out += writer.text();
  }
  // The last block leaves an empty line behind; a text file ends with one line
  // break.
  while (out.size() > 1 && out[out.size() - 2] == '\n') out.pop_back();
  return out;
}

}  // namespace touchdown::report
