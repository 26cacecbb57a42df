#include "gui-offscreen/views/VideoFile.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/scene/files/OutputFile.h"

extern char** environ;

namespace perception {
namespace {

namespace fs = std::filesystem;

std::string onPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string file = folder + "/" + program;
    if (::access(file.c_str(), X_OK) == 0) return file;
  }
  return "";
}

// One thread and no metadata of version or time: reproducible output.
std::vector<std::string> arguments(const Picture& first, double rate, const std::string& mark,
                                   const std::string& file) {
  return {"ffmpeg",
          "-hide_banner",
          "-loglevel",
          "error",
          "-y",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgb24",
          "-video_size",
          fmt::format("{}x{}", first.width, first.height),
          "-framerate",
          fmt::format("{:.6f}", rate),
          "-i",
          "pipe:0",
          "-c:v",
          "libx264",
          "-threads",
          "1",
          "-preset",
          "fast",
          "-crf",
          "23",
          "-pix_fmt",
          "yuv420p",
          "-movflags",
          "+faststart",
          "-fflags",
          "+bitexact",
          "-flags:v",
          "+bitexact",
          "-metadata",
          "comment=" + mark,
          "-f",
          "mp4",
          file};
}

}  // namespace

VideoFile::VideoFile(const std::string& path, double rate, std::string mark)
    : path_(path), partial_(path), said_(path + ".log"), rate_(rate), mark_(std::move(mark)) {
  if (fs::path(path).extension() != ".mp4")
    throw Error(ExitCode::kUsage, path + ": expected a video, .mp4");
  if (onPath("ffmpeg").empty()) {
    throw Error(ExitCode::kUnavailable,
                path + ": ffmpeg, which writes videos, is not installed (Debian package ffmpeg)");
  }
  OutputFile probe(path);  // throws with the reason if the folder is missing or not writable
}

VideoFile::~VideoFile() {
  if (pipe_ >= 0) finish();
}

void VideoFile::start(const Picture& first) {
  width_ = first.width;
  height_ = first.height;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(std::strerror(errno));
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 2, said_.path().c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
  std::vector<std::string> words = arguments(first, rate_, mark_, partial_.path());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed =
      ::posix_spawn(&process_, onPath("ffmpeg").c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[0]);
  pipe_ = ends[1];
  if (failed) {
    process_ = -1;
    fail(std::strerror(failed));
  }
  std::signal(SIGPIPE, SIG_IGN);  // a terminated ffmpeg is then reported as a failed write
}

void VideoFile::add(const Picture& picture) {
  if (frames_ == 0) start(picture);
  if (picture.width != width_ || picture.height != height_) {
    throw std::logic_error("pictures of different sizes in one video");
  }
  const auto* bytes = reinterpret_cast<const char*>(picture.rgb.data());
  for (std::size_t done = 0; done < picture.rgb.size();) {
    const ssize_t n = ::write(pipe_, bytes + done, picture.rgb.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      finish();
      fail("it ended early");
    }
    done += static_cast<std::size_t>(n);
  }
  ++frames_;
}

int VideoFile::finish() {
  ::close(pipe_);
  pipe_ = -1;
  int status = -1;
  if (process_ > 0) {
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  process_ = -1;
  return status;
}

void VideoFile::fail(const std::string& what) {
  std::ifstream log(said_.path());
  const std::string said((std::istreambuf_iterator<char>(log)), {});
  // On a full disk its own messages find no room either.
  std::error_code error;
  const auto space = fs::space(fs::absolute(path_).parent_path(), error);
  throw OutputError(
      fmt::format("{}: ffmpeg: {}{}{}{}", path_, what, said.empty() ? "" : ": ",
                  said.substr(0, said.find('\n')),
                  error ? "" : fmt::format(" ({} bytes free in its folder)", space.available)),
      ExitCode::kIoError);
}

void VideoFile::close() {
  if (frames_ == 0) throw OutputError(path_ + ": a video without pictures");
  const int status = finish();
  if (status != 0) fail(fmt::format("ended with status {}", WEXITSTATUS(status)));
  partial_.commit();
}

}  // namespace perception
