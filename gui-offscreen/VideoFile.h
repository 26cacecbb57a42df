#pragma once
#include <sys/types.h>

#include <string>

#include "gui-offscreen/Picture.h"

namespace perception {

/// A film (H.264 in MP4, plays in browsers) from pictures of one size, written by ffmpeg as a
/// process of its own: `path` is there once close() has returned, and not before.
class VideoFile {
 public:
  /// `rate` [1/s] of the pictures. Throws Error(kUnavailable) when ffmpeg is not installed,
  /// OutputError when the file cannot be created.
  VideoFile(const std::string& path, double rate);
  /// A film that was not closed leaves no file.
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// The first picture gives the size; width and height are even. Throws OutputError.
  void add(const Picture& picture);
  /// Waits for ffmpeg. Throws OutputError with what it said.
  void close();

  std::size_t frames() const { return frames_; }

 private:
  void start(const Picture& first);
  [[noreturn]] void fail(const std::string& what);
  int finish();  ///< ffmpeg's exit status

  std::string path_, partial_, said_;  ///< final, while growing, ffmpeg's messages
  double rate_;
  int width_ = 0, height_ = 0;  ///< [px]
  int pipe_ = -1;
  pid_t process_ = -1;
  std::size_t frames_ = 0;
};

}  // namespace perception
