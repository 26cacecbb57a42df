#pragma once
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/app/ImportApp.h"
#include "libperception/app/track/TrackApp.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

/// A file or folder of the recordings as they were published.
inline std::string sharedData(const std::string& path) {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/" + path;
}
/// Skips a test whose recording is not there.
#define NEEDS_SHARED_DATA(path)                                       \
  if (!std::filesystem::exists(::perception::test::sharedData(path))) \
  GTEST_SKIP() << "no recording at " << ::perception::test::sharedData(path)

/// Runs perception-import in a folder of its own, on files that the test writes.
class ImportRun : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ / name; }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(std::filesystem::path(file(name)).parent_path());
    std::ofstream(file(name), std::ios::binary) << content;
  }
  void writeGz(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(std::filesystem::path(file(name)).parent_path());
    const gzFile gz = gzopen(file(name).c_str(), "wb");
    gzwrite(gz, content.data(), static_cast<unsigned>(content.size()));
    gzclose(gz);
  }
  /// Numbers as a file stores them.
  template <class Number>
  static std::string bytesOf(const std::vector<Number>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)};
  }

  /// `perception-import FORMAT MORE... -o out.rawlog`; gives the exit code.
  int import(const std::string& format, std::vector<std::string> more) {
    std::vector<std::string> words = {"perception-import", format, "-o", file("out.rawlog")};
    words.insert(words.end(), more.begin(), more.end());
    ImportApp app;
    const int code = runQuietly(app, words);
    result_ = app.out_result;
    return code;
  }
  /// Tracks out.rawlog with a site of ini/; the scenes.
  std::vector<Scene> track(const std::string& ini, const std::string& sensors) {
    TrackApp app;
    app.keep_scenes = true;
    const int code = runQuietly(
        app, {"perception-track", "-c", std::string(PERCEPTION_SOURCE_DIR) + "/ini/" + ini, "-i",
              file("out.rawlog"), "-o", file("run"), "--overwrite", "--sensors", sensors,
              "--threads", "2"});
    EXPECT_TRUE(code == 0 || code == 3) << error_;
    return app.out_scenes;
  }
  /// The import ends with `code`, a message that holds `text`, and without any output.
  void expectFault(int code, const std::string& text, const std::string& format,
                   const std::vector<std::string>& more) {
    EXPECT_EQ(import(format, more), code) << error_;
    EXPECT_NE(error_.find(text), std::string::npos) << "'" << text << "' is not in " << error_;
    EXPECT_FALSE(std::filesystem::exists(file("out.rawlog")));
    EXPECT_FALSE(std::filesystem::exists(file("out.truth.csv")));
  }

  std::vector<mrpt::obs::CObservation::Ptr> readLog() const {
    RawlogReader reader(file("out.rawlog"));
    std::vector<mrpt::obs::CObservation::Ptr> all;
    while (auto o = reader.next()) all.push_back(o);
    EXPECT_EQ(reader.end(), RawlogReader::End::kClean);
    return all;
  }
  /// The frames of one sensor, each with the vehicle's pose.
  std::vector<SensorFrame> framesOf(const std::string& sensor) const {
    EgoPoseParams params;
    params.minimum = {0, 0, 0};
    params.history = 600;
    EgoPose ego(params);
    const auto log = readLog();
    for (const auto& o : log) ego.add(*o);
    std::vector<SensorFrame> frames;
    for (const auto& o : log) {
      if (o->sensorLabel != sensor) continue;
      auto frame = frameFromObservation(*o);
      if (!frame) continue;
      if (const auto state = ego.at(frame->stamp)) frame->ego = *state;
      frames.push_back(std::move(*frame));
    }
    return frames;
  }
  std::vector<std::int64_t> frameNumbers() const {
    std::vector<std::int64_t> numbers;
    for (const auto& o : readLog()) {
      if (const auto n = frameNumber(*o)) numbers.push_back(*n);
    }
    return numbers;
  }

  int runQuietly(App& app, const std::vector<std::string>& words) {
    std::vector<const char*> argv;
    for (const auto& word : words) argv.push_back(word.c_str());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = runApp(app, static_cast<int>(argv.size()), argv.data());
    ::testing::internal::GetCapturedStdout();
    error_ = ::testing::internal::GetCapturedStderr();
    return code;
  }

  TemporaryFolder folder_;
  ImportResult result_;
  std::string error_;
};

}  // namespace perception::test
