// A report as data, written once and rendered as HTML and as Markdown.
#pragma once

#include <string>
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
};

struct Heading {
  int level = 2;  // 1..3
  std::string text;
};

struct Paragraph {
  std::string text;
  bool muted = false;
};

struct List {
  std::vector<std::string> items;
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

// A way to another file of the report.
struct Link {
  std::string to;  // relative
  std::string text;
};

struct PageBreak {};

using Block = std::variant<Heading, Paragraph, List, Callout, Table, Figure,
                           Picture, Link, PageBreak>;

// Blocks about one subject. `simulated` puts the watermark on all of them.
struct Section {
  bool simulated = false;
  std::vector<Block> blocks;
};

struct Document {
  std::string title;
  std::vector<Section> sections;
};

// One self-contained page: no request leaves it, and it prints on A4.
std::string ToHtml(const Document& document);

// Plain Markdown (GitHub tables). Plots appear as their alternative text.
std::string ToMarkdown(const Document& document);

// The words of the watermark.
inline constexpr const char* kWatermark =
    "SIMULATED: rendered clips, not an experiment; no verdict on a theory";

}  // namespace touchdown::report
