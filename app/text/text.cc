#include "app/text/text.h"

#include <cstdlib>

namespace touchdown::report {
namespace {

bool IsPlainNumber(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size();
}

bool Contains(std::string_view characters, char c) {
  return characters.find(c) != std::string_view::npos;
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Digits with at most one point, then the end of a word: not "3.mraw".
bool BeginsWithNumber(std::string_view text) {
  std::size_t at = 0;
  const auto skip_digits = [&] {
    while (at < text.size() && IsDigit(text[at])) ++at;
  };
  skip_digits();
  if (at == 0) return false;
  if (at + 1 < text.size() && text[at] == '.' && IsDigit(text[at + 1])) {
    ++at;
    skip_digits();
  }
  if (at < text.size() && text[at] == '.') ++at;  // of the sentence
  return at == text.size() || Contains(" )],;:%", text[at]);
}

}  // namespace

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
    const bool begins = i == 0 || Contains(" ([,;", text[i - 1]);
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
  std::string cell(text);
  constexpr std::string_view kFormulaStart = "=+-@\t\r";
  if (!cell.empty() && kFormulaStart.find(cell[0]) != std::string_view::npos &&
      !IsPlainNumber(cell)) {
    cell.insert(cell.begin(), '\'');
  }
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
  constexpr std::string_view kMarkup = "\\`*_[]|#~$";
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20) {
      out += ' ';
      continue;
    }
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
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    // The two signs beyond ASCII that our tables use.
    if (text.substr(i).starts_with("\u00b1")) {
      out += "$\\pm$";
      i += 1;
    } else if (text.substr(i).starts_with("\u2013")) {
      out += "--";
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
      out +=
          i + k > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * k)) & 63u];
    }
  }
  return out;
}

std::uint64_t Digest(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace touchdown::report
