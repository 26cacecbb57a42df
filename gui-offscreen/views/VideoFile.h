#pragma once
#include <sys/types.h>

#include <string>

#include "gui-offscreen/drawing/Picture.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {

/// A video (H.264 in MP4) from pictures of equal size, encoded by an ffmpeg process. `path` exists
/// only after close().
class VideoFile {
 public:
  /// `rate` [1/s] of the pictures; `mark`: runMark(). Throws Error(kUnavailable) if ffmpeg is not
  /// installed, OutputError if the file cannot be created.
  VideoFile(const std::string& path, double rate, std::string mark = "");
  /// Removes the file if it was not closed.
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// The first picture determines the size; width and height must be even. Throws OutputError.
  void add(const Picture& picture);
  /// Waits for ffmpeg. Throws OutputError with its messages.
  void close();

  std::size_t frames() const { return frames_; }

 private:
  void start(const Picture& first);
  [[noreturn]] void fail(const std::string& what);
  int finish();  ///< ffmpeg's exit status

  std::string path_;
  PartialFile partial_, said_;  ///< the video, ffmpeg's messages
  double rate_;
  std::string mark_;
  int width_ = 0, height_ = 0;  ///< [px]
  int pipe_ = -1;
  pid_t process_ = -1;
  std::size_t frames_ = 0;
};

}  // namespace perception
