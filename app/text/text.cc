#include "app/text/text.h"

#include <cstdlib>

namespace touchdown::report {
namespace {

// Whether a spreadsheet reads the whole cell as a number: "-0.5" is safe where
// "-A1" is a formula.
bool IsPlainNumber(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size();
}

bool Contains(std::string_view characters, char c) {
  return characters.find(c) != std::string_view::npos;
}

// ASCII only: std::isdigit would depend on the locale.
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Digits with at most one point, then the end of a word: not "3.mraw". Decides
// whether a hyphen before `text` is a minus.
bool BeginsWithNumber(std::string_view text) {
  std::size_t at = 0;
  const auto skip_digits = [&] {
    while (at < text.size() && IsDigit(text[at])) ++at;
  };
  skip_digits();
  if (at == 0) return false;
  // A point belongs to the number only where digits follow it.
  if (at + 1 < text.size() && text[at] == '.' && IsDigit(text[at + 1])) {
    ++at;
    skip_digits();
  }
  if (at < text.size() && text[at] == '.') ++at;  // of the sentence
  return at == text.size() || Contains(" )],;:%", text[at]);
}

}  // namespace

// Both kinds of quotes are escaped, so that the text can stand in an attribute
// whichever quotes enclose it.
std::string HtmlEscape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string Typeset(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    // Signs are set only at the beginning of a word; "pan-5" and dates keep
    // their hyphens.
    const bool begins = i == 0 || Contains(" ([,;", text[i - 1]);
    // The blank behind it is copied in the next round.
    if (begins && text.substr(i, 3) == "+- ") {
      out += "\u00b1";
      ++i;
    } else if (begins && text[i] == '-' &&
               BeginsWithNumber(text.substr(i + 1))) {
      out += "\u2212";
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string CsvCell(std::string_view text) {
  // The guard comes before the quotes: it belongs to the content of the cell,
  // and CsvCellText() takes it away again after reading.
  std::string cell(text);
  constexpr std::string_view kFormulaStart = "=+-@\t\r";
  if (!cell.empty() && kFormulaStart.find(cell[0]) != std::string_view::npos &&
      !IsPlainNumber(cell)) {
    cell.insert(cell.begin(), '\'');
  }
  // Quotes only where RFC 4180 asks for them: the file stays readable.
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

std::string MarkdownEscape(std::string_view text) {
  // Everything that begins markup in GitHub's Markdown, where "|" ends a cell
  // and "$" begins a formula.
  constexpr std::string_view kMarkup = "\\`*_[]|#~$";
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    // A line break would end the row of a table.
    if (static_cast<unsigned char>(c) < 0x20) {
      out += ' ';
      continue;
    }
    // Markdown passes HTML through: tags are escaped as in a page.
    if (c == '<' || c == '>' || c == '&') {
      out += HtmlEscape(std::string_view(&c, 1));
      continue;
    }
    if (kMarkup.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string LatexEscape(std::string_view text) {
  std::string out;
  // Copies byte by byte. Bytes of other UTF-8 characters pass unchanged, as
  // LaTeX reads UTF-8.
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    // The two signs beyond ASCII that our tables use.
    if (text.substr(i).starts_with("\u00b1")) {
      out += "$\\pm$";
      // The loop itself steps over the first of the sign's two bytes.
      i += 1;
    } else if (text.substr(i).starts_with("\u2013")) {
      out += "--";
      // The dash has three bytes.
      i += 2;
    } else if (c == '\\') {
      out += "\\textbackslash{}";
    } else if (c == '~') {
      out += "\\textasciitilde{}";
    } else if (c == '^') {
      out += "\\textasciicircum{}";
    } else if (std::string_view("#$%&_{}").find(c) != std::string_view::npos) {
      out += '\\';
      out += c;
    } else {
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

// Three bytes are four digits of six bits each. A last group of one or two
// bytes is filled with zero bits and padded with "=" to four digits.
std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group <<= 8;
      if (i + k < bytes.size()) {
        group |= static_cast<unsigned char>(bytes[i + k]);
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      // n bytes of a group need n + 1 digits.
      out +=
          i + k > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * k)) & 63u];
    }
  }
  return out;
}

std::uint64_t Digest(std::string_view text) {
  // Offset basis and prime of the 64-bit variant.
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace touchdown::report
