// A report as data, written once and rendered as HTML and as Markdown.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace touchdown::report {

// What a cell or a callout says at a glance; HTML gives it a colour.
enum class Tone { kPlain, kSlide, kBounce, kUndecided, kGood, kBad, kMuted };

struct Cell {
  std::string text;
  Tone tone = Tone::kPlain;
  std::string link = {};  // relative; empty: none
};

struct Column {
  std::string heading;  // with the unit
  bool numeric = false;
};

struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;  // each as long as `columns`
  // The first cell of each row says what the row is, as a heading does.
  bool row_headings = false;
};

struct Heading {
  int level = 2;  // 1..3; those of level 2 are in the contents
  std::string text;
};

// The headings of level 2 of the whole document, with links to them.
struct Contents {};

struct Paragraph {
  std::string text;
  bool muted = false;
};

struct List {
  std::vector<std::string> items;
};

// Terms, each with what is said of it: a cover, a glossary.
struct Terms {
  std::vector<std::pair<std::string, std::string>> items;
  bool lead = false;  // what is read first: larger
};

// A boxed sentence: the verdict, a warning.
struct Callout {
  std::string title;
  std::string text;
  Tone tone = Tone::kPlain;
};

// A plot. `svg` is trusted markup (it comes from our own plotter); everything
// else in a document is text and is escaped.
struct Figure {
  std::string svg;
  std::string alt;  // what a reader who cannot see the plot must know
  std::string caption;
  Table data;  // the numbers behind it
};

// A photograph, inside the page.
struct Picture {
  std::string png_base64;
  std::string alt;
  std::string caption;
};

// Pictures side by side, each with a few words below. `svg` is trusted markup
// as in a Figure.
struct Strip {
  struct Panel {
    std::string svg;
    std::string label;
  };
  std::string caption;
  std::string alt;  // what a reader who cannot see them must know
  std::vector<Panel> panels;
};

// A way to another file of the report.
struct Link {
  std::string to;  // relative
  std::string text;
};

struct PageBreak {};

using Block = std::variant<Heading, Contents, Paragraph, List, Terms, Callout,
                           Table, Figure, Picture, Strip, Link, PageBreak>;

// Blocks about one subject. `simulated` puts the watermark on all of them.
struct Section {
  bool simulated = false;
  std::vector<Block> blocks;
};

struct Document {
  std::string title;
  std::string footer;  // of every printed page, beside its number
  std::vector<Section> sections;
};

// Those of level 2, in their order.
std::vector<Heading> ListHeadings(const Document& document);

// One self-contained page: no request leaves it, and it prints on A4.
std::string ToHtml(const Document& document);

// Plain Markdown (GitHub tables). Plots and pictures appear as their
// alternative text.
std::string ToMarkdown(const Document& document);

// The words of the watermark.
inline constexpr const char* kWatermark =
    "SIMULATED: rendered clips, not an experiment; no verdict on a theory";

}  // namespace touchdown::report
