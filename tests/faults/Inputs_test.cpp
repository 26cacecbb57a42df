// Damaged logs through a whole program: what a library does on them shows in a process of its own
// only.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/faults/Workshop.h"

namespace perception::test {
namespace {

/// The images of rawlogs/camera.rawlog, the sizes in one JPEG's header made zero.
void writeDamagedImages(const std::string& path) {
  const std::string command =
      "gzip -dc '" PERCEPTION_SOURCE_DIR "/rawlogs/camera.rawlog' >'" + path + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::size_t image = 0;
  for (int i = 0; i < 5; ++i) image = bytes.find("\xff\xd8\xff", image + 1);
  const std::size_t frame = bytes.find("\xff\xc0", image);
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, 4, '\0');
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(DamagedLog, AJpegThatCannotBeDecodedEndsTheLogThereWithAWord) {
  const TemporaryFolder folder;
  writeDamagedImages(folder / "log.rawlog");
  Workshop workshop;
  const Job job{
      "camera",
      {"perception-track", "-c", PERCEPTION_SOURCE_DIR "/ini/skynet.ini", "--sensors", "C", "--set",
       "sensor.CAMERA_PANO.resolution=4k", "-i", folder / "log.rawlog", "-o", "{out}/run"},
      3,
      {}};
  const Ending ending = workshop.run(job, folder.path());
  EXPECT_EQ(ending.code, 3) << ending.said;
  EXPECT_NE(ending.said.find("'mrpt::obs::CObservationImage' cannot be read"), std::string::npos)
      << ending.said;
  EXPECT_TRUE(std::filesystem::exists(folder / "run/done.json"));
}

}  // namespace
}  // namespace perception::test
