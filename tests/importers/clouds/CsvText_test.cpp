#include "libperception/importers/clouds/CsvText.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

CsvText csvOf(const std::string& bytes) { return csvTextOf("a.csv", bytes); }

TEST(CsvText, CommasSeparateWhereNothingElseDoes) {
  const CsvText csv = csvOf("x,y,z\n1.5,2,3\n4,5,6\n");
  EXPECT_EQ(csv.names, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(csv.rows, 2u);
  EXPECT_EQ(csv.text, "\n1.5\t2\t3\n4\t5\t6\n");
}

TEST(CsvText, BehindSemicolonsACommaIsTheDecimalPoint) {
  const CsvText csv = csvOf("\xef\xbb\xbfx;y;z\r\n1,5;-2,25;3\r\n");
  EXPECT_EQ(csv.names, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(csv.rows, 1u);
  EXPECT_EQ(csv.text, "\n1.5\t-2.25\t3\n");
}

TEST(CsvText, QuotationMarksAreNoPartOfNamesAndNumbers) {
  const CsvText csv = csvOf("\"X\";\"Y\";\"Z\"\n\"1,5\";2;3\n");
  EXPECT_EQ(csv.names, (std::vector<std::string>{"X", "Y", "Z"}));
  EXPECT_EQ(csv.text, "\n1.5\t2\t3\n");
}

TEST(CsvText, BehindTabsTooIfNoSpacesAreThere) {
  EXPECT_EQ(csvOf("1,5\t2\t3\n").text, "1.5\t2\t3\n");
  const CsvText spaced = csvOf("1,\t2,\t3\n");
  EXPECT_EQ(spaced.text, "1\t2\t3\n") << "here they separate";
  EXPECT_EQ(spaced.columns, 3u);
}

TEST(CsvText, LinesWithoutNamesAreRows) {
  const CsvText csv = csvOf("\n1 2 3\n4 5 6\n\n");
  EXPECT_TRUE(csv.names.empty());
  EXPECT_EQ(csv.first_line, 2u);
  EXPECT_EQ(csv.columns, 3u);
  EXPECT_EQ(csv.rows, 2u);
  EXPECT_EQ(csvOf("").rows, 0u);
}

TEST(CsvText, UnitsAreToldFromNames) {
  const CsvText csv = csvOf("x [m], y (mm), z\n1,2,3\n");
  EXPECT_EQ(csv.names, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(csv.units, (std::vector<std::string>{"m", "mm", ""}));
}

TEST(CsvText, NamesMayBeInACommentAndOtherLinesAboveTheTableAreNone) {
  const CsvText csv = csvOf("roof lidar\n//X Y Z\n2\n1 2 3\n# broken\n4 5 6\n");
  EXPECT_EQ(csv.names, (std::vector<std::string>{"X", "Y", "Z"}));
  EXPECT_EQ(csv.first_line, 4u);
  EXPECT_EQ(csv.text, "\n\n\n1\t2\t3\n\n4\t5\t6\n");
  EXPECT_EQ(csv.rows, 2u);
}

TEST(CsvText, EmptyFieldsAreNoNumbers) {
  EXPECT_EQ(csvOf("x;y;z;a\n1;2;3;4\n1;;3\n").text, "\n1\t2\t3\t4\n1\tnan\t3\n");
}

TEST(CsvText, TwoBytesACharacterAreRefused) { EXPECT_THROW(csvOf("\xff\xfex\0"), DataError); }

}  // namespace
}  // namespace perception
