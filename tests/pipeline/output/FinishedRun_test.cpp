#include "libperception/pipeline/output/FinishedRun.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/scene/files/RunMark.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

void write(const std::string& path, const std::string& text) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << text;
}

TEST(FinishedRun, ProductsAreFoundByTheRunsIdUnderWhateverName) {
  const test::TemporaryFolder folder;
  RunRecord record;
  record.hash = std::string(64, 'a');
  writeRunRecord(folder / "done.json", record);
  const std::string own = runMark({idOfRun(record)}), other = runMark({std::string(64, 'b')});
  write(folder / "tracks.csv", "x");
  write(folder / "scene.png", "without an id");
  write(folder / "frame50.png", own);
  write(folder / "films/far.mp4", own + other);
  write(folder / "of-another-run.png", other);
  write(folder / "notes.txt", "of the user");
  write(folder / "near/report.json", own);
  write(folder / "near/instants.csv", "belongs to the report");
  write(folder / "next/done.json", "{}");
  write(folder / "next/picture.png", own);
  auto found = productsIn(folder.path());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<std::string>{"films/far.mp4", "frame50.png", "near", "scene.png",
                                             "tracks.csv"}));
}

TEST(FinishedRun, TheHashOfAFileThatIsReadAnywayIsThatOfTheFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "log", text = "the bytes of a log";
  write(file, text);
  const std::string whole = sha256OfFile(file);
  for (const std::size_t read : {std::size_t{0}, std::size_t{5}, text.size()}) {
    FileHash hash;
    for (std::size_t i = 0; i < read; ++i)
      hash.add(reinterpret_cast<const unsigned char*>(&text[i]), 1);
    EXPECT_EQ(hash.finish(file), whole) << read;
  }
}

TEST(FinishedRun, ALiveRunsIdIsThatOfItsRecord) {
  RunRecord live;
  live.tracks = 3;
  const std::string id = idOfRun(live);
  EXPECT_EQ(id.size(), 64u);
  live.tracks = 4;
  EXPECT_NE(idOfRun(live), id);
  live.hash = std::string(64, 'c');
  EXPECT_EQ(idOfRun(live), live.hash);
}

TEST(FinishedRun, AFolderThatDidNotFinishHasNoMark) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(markOfRuns({folder.path()}), "");
  write(folder / "done.json", "{");
  EXPECT_THROW(markOfRuns({folder.path()}), DataError);
}

}  // namespace
}  // namespace perception
