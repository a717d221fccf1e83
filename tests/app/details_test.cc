#include "app/report/details.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

using ::testing::HasSubstr;

class ReadsDetails : public ::testing::Test {
 protected:
  Details Read(const std::string& text) {
    folder_.Write("report.toml", text);
    return ReadDetails(folder_.path() / "report.toml");
  }
  std::string Refusal(const std::string& text) {
    try {
      Read(text);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  }
  testing::TemporaryFolder folder_;
};

TEST_F(ReadsDetails, EveryKeyOfTheExample) {
  std::string text = DetailsExample();
  // Each entry says its own key.
  for (const DetailField& field : DetailFields()) {
    const std::string key(field.key.substr(field.key.find('.') + 1));
    const std::size_t section =
        text.find("[" + std::string(field.key.substr(0, field.key.find('.'))));
    const std::size_t at = text.find("\n" + key + " = \"\"", section);
    ASSERT_NE(at, std::string::npos) << field.key;
    text.insert(at + key.size() + 5, field.key);
  }
  const Details read = Read(text);
  for (const DetailField& field : DetailFields()) {
    EXPECT_EQ(read.*field.member, field.key);
  }
  EXPECT_EQ(read.file, "report.toml");
  ASSERT_EQ(read.equipment.size(), 1u);
  EXPECT_EQ(read.equipment[0].name, "camera south");
  EXPECT_EQ(read.equipment[0].due_on, "2027-08-01");
  ASSERT_EQ(read.signatures.size(), 2u);
  EXPECT_EQ(read.signatures[1].role, "authorised by");
}

TEST_F(ReadsDetails, WhatIsLeftOutIsEmpty) {
  const Details read = Read("[customer]\nname = \"Ada & Sons\"\n");
  EXPECT_EQ(read.customer, "Ada & Sons");
  EXPECT_EQ(read.laboratory, "");
}

TEST_F(ReadsDetails, AMistakeIsOneLineWithItsPlace) {
  EXPECT_THAT(Refusal("[customer]\nnaem = \"x\"\n"),
              HasSubstr("report.toml:2: unknown key customer.naem; expected "
                        "one of name, contact"));
  EXPECT_THAT(Refusal("[costumer]\nname = \"x\"\n"),
              HasSubstr("unknown section [costumer]"));
  EXPECT_THAT(Refusal("[order]\nnumber = 17\n"),
              HasSubstr("order.number must be a text in quotes"));
  EXPECT_THAT(Refusal("[[equipment]]\nnumber = \"1\"\n"),
              HasSubstr("equipment.name is missing"));
  EXPECT_THAT(Refusal("[[equipment]]\nname = \"a\"\ndue_on = \"next year\"\n"),
              HasSubstr("must be a date as in 2026-08-31"));
  EXPECT_THAT(Refusal("[equipment]\nname = \"a\"\n"),
              HasSubstr("must be written as [[equipment]]"));
  EXPECT_THAT(Refusal("[customer\n"), HasSubstr("report.toml:1"));
}

TEST(ReadDetails, NoFileIsSaidWithWhatToDo) {
  try {
    ReadDetails("/nowhere/report.toml");
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--details-example"));
  }
}

}  // namespace
}  // namespace touchdown::report
