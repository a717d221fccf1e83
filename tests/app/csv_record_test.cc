#include "app/text/csv_record.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

using Cells = std::vector<std::string>;

TEST(CsvRecord, CommasQuotesAndLineBreaksStayInsideQuotes) {
  std::istringstream in("a,\"b,\"\"c\"\"\nd\",e\r\n1,2\"x,\n");
  EXPECT_EQ(ReadCsvRecord(in, "f.csv", 1), (Cells{"a", "b,\"c\"\nd", "e"}));
  EXPECT_EQ(ReadCsvRecord(in, "f.csv", 2), (Cells{"1", "2\"x", ""}));
  EXPECT_EQ(ReadCsvRecord(in, "f.csv", 3), std::nullopt);
}

TEST(CsvRecord, AQuoteThatIsNeverClosedIsNamed) {
  std::istringstream in("\"a,b\n");
  EXPECT_THROW(ReadCsvRecord(in, "f.csv", 7), core::InputError);
}

TEST(CsvRecord, OnlyAWholeByteOrderMarkIsPassedOver) {
  std::istringstream marked(
      "\xef\xbb\xbf"
      "angle");
  SkipByteOrderMark(marked);
  EXPECT_EQ(ReadCsvRecord(marked, "f.csv", 1), Cells{"angle"});
  // A letter of another script begins with the same first byte.
  for (const char* text : {"\xef\xbc\xa1"
                           "x",
                           "\xef", "angle", ""}) {
    std::istringstream in(text);
    SkipByteOrderMark(in);
    const std::string left{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(left, text);
  }
}

}  // namespace
}  // namespace touchdown::report
