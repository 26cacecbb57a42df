#include "libperception/core/CsvStream.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using test::TemporaryFolder;

std::string fileOf(const TemporaryFolder& folder, const std::string& text) {
  const std::string path = folder / "table.csv";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// The message of the DataError that reading all rows throws; "" when it throws none.
std::string faultOf(const std::string& path) {
  try {
    for (CsvStream rows(path); rows.next();) {
    }
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(CsvStream, RowsAreThoseOfTheWholeTable) {
  const TemporaryFolder folder;
  const std::string path = fileOf(
      folder, "\xEF\xBB\xBF" + std::string("a,b\r\n1,\r\n") + std::string(9000, '7') + ",4\n");
  const CsvTable whole = CsvTable::fromFile(path);
  CsvStream rows(path);
  EXPECT_EQ(rows.row().header(), whole.header());
  for (std::size_t i = 0; i < whole.rows(); ++i) {
    ASSERT_TRUE(rows.next());
    ASSERT_EQ(rows.row().rows(), 1u);
    EXPECT_EQ(rows.row().lineOf(0), whole.lineOf(i));
    for (std::size_t c = 0; c < 2; ++c) EXPECT_EQ(rows.row().text(0, c), whole.text(i, c));
  }
  EXPECT_FALSE(rows.next());
  EXPECT_FALSE(rows.next());
}

TEST(CsvStream, FaultsNameTheLineOfTheFile) {
  const TemporaryFolder folder;
  const std::string path = fileOf(folder, "t,x\n1,2\n3,abc\n");
  CsvStream rows(path);
  rows.next();
  rows.next();
  try {
    rows.row().real(0, rows.row().column("x"));
    FAIL() << "abc was read as a number";
  } catch (const DataError& error) {
    EXPECT_EQ(error.what(), path + ":3: column 'x': found 'abc', expected a number");
  }
}

TEST(CsvStream, FindsTheFaultsOfAWholeTable) {
  const TemporaryFolder folder;
  for (const char* text : {"", "\n", "a,a\n", "a,b\n1\n", "a,b\n1,2\n3,4", "a,b"}) {
    const std::string path = fileOf(folder, text);
    std::string whole;
    try {
      CsvTable::fromFile(path);
    } catch (const DataError& error) {
      whole = error.what();
    }
    EXPECT_EQ(faultOf(path), whole) << text;
    EXPECT_NE(whole, "") << text;
  }
  EXPECT_NE(faultOf(fileOf(folder, std::string("a,b\n1,2") + '\0' + "\n3,4\n3\n")).find(":4:"),
            std::string::npos)
      << "a NUL is a character like others";
}

TEST(CsvStream, SaysThatThereIsNoFile) {
  const TemporaryFolder folder;
  try {
    CsvStream rows(folder / "nothing.csv");
    FAIL() << "read a file that is not there";
  } catch (const DataError& error) {
    EXPECT_EQ(error.code(), ExitCode::kNoInput);
  }
}

}  // namespace
}  // namespace perception
