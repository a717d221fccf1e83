#include "app/text/text.h"

#include <gtest/gtest.h>

namespace touchdown::report {
namespace {

TEST(HtmlEscape, FiveCharacters) {
  EXPECT_EQ(HtmlEscape("<a b=\"c\" d='e'>&"),
            "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;");
}

TEST(CsvCell, QuotesAndDisarmsFormulas) {
  EXPECT_EQ(CsvCell("plain"), "plain");
  EXPECT_EQ(CsvCell("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvCell("say \"hi\""), "\"say \"\"hi\"\"\"");
  EXPECT_EQ(CsvCell("=1+1"), "'=1+1");
  EXPECT_EQ(CsvCell("-0.5"), "-0.5");
}

TEST(MarkdownEscape, TablesAndHtmlStayText) {
  EXPECT_EQ(MarkdownEscape("a|b"), "a\\|b");
  EXPECT_EQ(MarkdownEscape("<b>"), "&lt;b&gt;");
  EXPECT_EQ(MarkdownEscape("x_y*z"), "x\\_y\\*z");
  EXPECT_EQ(MarkdownEscape("two\nlines"), "two lines");
}

TEST(Typeset, SignsOfNumbersOnly) {
  EXPECT_EQ(Typeset("-0.5"), "\u22120.5");
  EXPECT_EQ(Typeset("from -3 to -2."), "from \u22123 to \u22122.");
  EXPECT_EQ(Typeset("(-1.25 deg)"), "(\u22121.25 deg)");
  EXPECT_EQ(Typeset("is 1.00 +- 0.02"), "is 1.00 \u00b1 0.02");
  for (const char* same : {"a-5", "2026-08-01", "-3.mraw", "roll-slide", "-",
                           "--rig", "- 5", "40+-0.02"}) {
    EXPECT_EQ(Typeset(same), same);
  }
}

TEST(LatexEscape, SpecialCharacters) {
  EXPECT_EQ(LatexEscape("50% of a_b & {c}"), "50\\% of a\\_b \\& \\{c\\}");
  EXPECT_EQ(LatexEscape("1 \u00b1 2"), "1 $\\pm$ 2");
  EXPECT_EQ(LatexEscape("\\input"), "\\textbackslash{}input");
}

}  // namespace
}  // namespace touchdown::report
