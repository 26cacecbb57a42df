#include "libperception/core/Csv.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <functional>

#include "libperception/core/Error.h"

namespace perception {
namespace {

// The message of the DataError that `action` throws; "" when it throws none.
std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(Csv, FindsColumnsByNameInAnyOrder) {
  const auto csv = CsvTable::fromText("b,a\n2,1\n4,3\n");
  ASSERT_EQ(csv.rows(), 2u);
  EXPECT_EQ(csv.integer(0, csv.column("a")), 1);
  EXPECT_EQ(csv.integer(1, csv.column("b")), 4);
  EXPECT_TRUE(csv.has("a"));
  EXPECT_FALSE(csv.has("c"));
}

TEST(Csv, NamesFileLineColumnAndWhatItFound) {
  const auto csv = CsvTable::fromText("t,x\n1,2\n3,abc\n", "truth.csv");
  EXPECT_EQ(messageOf([&] { csv.real(1, csv.column("x")); }),
            "truth.csv:3: column 'x': found 'abc', expected a number");
}

TEST(Csv, ANumberIsTheWholeFieldAndFinite) {
  for (const char* field : {"1,5", "1.5m", " 1", "nan", "inf", "", "+1", "0x10", "1e999"}) {
    const std::string text =
        std::string("x") + (std::string(field) == "1,5" ? ",y" : "") + "\n" + field + "\n";
    const auto csv = CsvTable::fromText(text);
    if (std::string(field) == "1,5") {
      EXPECT_EQ(csv.real(0, 0), 1);  // the comma parts fields, never a decimal
    } else {
      EXPECT_NE(messageOf([&] { csv.real(0, 0); }), "") << field;
    }
  }
  const auto csv = CsvTable::fromText("x\n-1.5e-3\n");
  EXPECT_EQ(csv.real(0, 0), -1.5e-3);
}

TEST(Csv, AnEmptyFieldIsNanOnlyWhereAllowed) {
  const auto csv = CsvTable::fromText("x,y\n,1\n");
  EXPECT_TRUE(std::isnan(csv.realOrNan(0, 0)));
  EXPECT_NE(messageOf([&] { csv.real(0, 0); }), "");
  EXPECT_EQ(csv.integerOr(0, 0, -1), -1);
}

TEST(Csv, IntegersFlagsAndNaturalsAreStrict) {
  const auto csv = CsvTable::fromText("n,f,u\n1.0,2,-1\n-7,1,18446744073709551615\n");
  EXPECT_NE(messageOf([&] { csv.integer(0, 0); }), "");
  EXPECT_NE(messageOf([&] { csv.flag(0, 1); }), "");
  EXPECT_NE(messageOf([&] { csv.natural(0, 2); }), "");
  EXPECT_EQ(csv.integer(1, 0), -7);
  EXPECT_TRUE(csv.flag(1, 1));
  EXPECT_EQ(csv.natural(1, 2), 18446744073709551615u);
}

TEST(Csv, AFileCutWithinALineIsFound) {
  EXPECT_NE(messageOf([] { CsvTable::fromText("a,b\n1,2\n3,4", "f"); }).find("f:3:"),
            std::string::npos);
  EXPECT_NE(messageOf([] {
              CsvTable::fromText("a,b\n1\n", "f");
            }).find("f:2: found 1 fields, expected 2"),
            std::string::npos);
  EXPECT_NE(messageOf([] { CsvTable::fromText("", "f"); }).find("f:1: empty"), std::string::npos);
  EXPECT_NE(messageOf([] { CsvTable::fromText("a,a\n", "f"); }).find("there twice"),
            std::string::npos);
  EXPECT_NE(messageOf([] { CsvTable::fromText("a\n", "f").column("b"); }).find("no column 'b'"),
            std::string::npos);
}

TEST(Csv, TakesByteOrderMarkAndDosLineEnds) {
  const auto csv = CsvTable::fromText("\xEF\xBB\xBFx,y\r\n1,2\r\n");
  EXPECT_EQ(csv.real(0, csv.column("x")), 1);
  EXPECT_EQ(csv.real(0, csv.column("y")), 2);
}

TEST(Csv, AMissingFileHasItsOwnExitCode) {
  try {
    CsvTable::fromFile("/nowhere/at/all.csv");
    FAIL() << "read a file that is not there";
  } catch (const DataError& error) {
    EXPECT_EQ(error.code(), ExitCode::kNoInput);
  }
  EXPECT_NE(messageOf([] { CsvTable::fromFile("/"); }), "");
}

TEST(Csv, ViewsSurviveACopyOfTheTable) {
  auto copy = [] { return CsvTable::fromText("x\nword\n"); }();
  const CsvTable other = copy;
  copy = CsvTable::fromText("x\nelse\n");
  EXPECT_EQ(other.text(0, 0), "word");
}

}  // namespace
}  // namespace perception
