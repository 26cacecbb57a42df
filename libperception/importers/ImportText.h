#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"

namespace perception {

/// The fields of one line of a text file; errors are DataErrors that name file, line and field.
/// Numbers are parsed independent of the locale. Valid while path and text exist.
class TextRow {
 public:
  TextRow(const std::string& path, std::size_t line, std::string_view text, const char* separators);

  std::size_t size() const { return fields_.size(); }
  std::size_t line() const { return line_; }
  std::string text(std::size_t i) const { return std::string(at(i)); }
  bool isNumber(std::size_t i) const;
  double real(std::size_t i) const;  ///< finite
  std::int64_t integer(std::size_t i) const;
  std::int64_t frame(std::size_t i) const;  ///< an integer of at least 0

  // Numbers in a row, from field `first` to the end of the line.
  /// A pose of 12 numbers, 3x4 row-major, or of 16 whose last row is 0 0 0 1; rounding errors are
  /// corrected, other matrices that are not rotations fail.
  Pose3 pose34(std::size_t first) const;
  /// A rotation of 9 numbers, row-major.
  Pose3 rotation33(std::size_t first) const;
  /// The 3x4 numbers of the same, unchanged.
  Eigen::Matrix<double, 3, 4> matrix34(std::size_t first) const;

  void expect(bool holds, const std::string& expected) const;
  [[noreturn]] void fail(std::size_t i, const std::string& expected) const;
  [[noreturn]] void failLine(const std::string& message) const;

 private:
  static bool parse(std::string_view s, double& value);
  std::string_view at(std::size_t i) const;
  Pose3 rigid(const Eigen::Matrix<double, 3, 4>& m) const;

  const std::string& path_;
  std::size_t line_;
  std::vector<std::string_view> fields_;
};

inline constexpr const char* kSpaces = " \t\r";
inline constexpr const char* kCommas = ", \t\r";

/// Calls use(row) for each line of a file, plain or gzip, that is not blank. Throws DataError
/// (kNoInput if the file does not exist).
void forEachRow(const std::string& path, const char* separators,
                const std::function<void(const TextRow&)>& use);

/// All bytes of a file, plain or gzip. Throws DataError: missing (kNoInput), truncated or damaged
/// gzip data, more than `most` bytes.
std::string readBytes(const std::string& path, std::size_t most = std::size_t{1} << 28);

/// Throws DataError unless it is a folder (kNoInput if it does not exist).
void requireFolder(const std::string& path);

/// A file in a folder with one file per frame.
struct FrameFile {
  std::int64_t number = 0;  ///< the file name if all names are numbers, else the index
  std::string stem;         ///< name without folder and extensions
  std::string path;
};
/// The files in `dir` with one of the extensions (".bin", ".bin.gz"), sorted by number; of names
/// that `wants` holds of. Throws DataError (kNoInput) if there is no such folder or file.
std::vector<FrameFile> frameFiles(const std::string& dir, const std::vector<std::string>& endings,
                                  const std::function<bool(const std::string&)>& wants = {});
/// DIR/STEM + the first of the extensions for which a file exists; empty: none.
std::string fileOfStem(const std::string& dir, const std::string& stem,
                       const std::vector<std::string>& endings);

/// The pose of a position [m] and an attitude; empty unless the quaternion has unit length within
/// the hundredth by which files round it.
std::optional<Pose3> poseFrom(const Vector3& position, const Eigen::Quaterniond& attitude);

/// A pose with its stamp. TUM format: t x y z qx qy qz qw; lines with # are skipped.
struct StampedPose {
  Stamp stamp;
  Pose3 pose = Pose3::Identity();
};
std::vector<StampedPose> readTumPoses(const std::string& path);

}  // namespace perception
