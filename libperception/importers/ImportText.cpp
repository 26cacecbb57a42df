#include "libperception/importers/ImportText.h"

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/LU>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/CsvText.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

template <class Number>
bool parseWhole(std::string_view s, Number& value) {
  const auto result = std::from_chars(s.data(), s.data() + s.size(), value);
  return result.ec == std::errc() && result.ptr == s.data() + s.size();
}

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() > ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

TextRow::TextRow(const std::string& path, std::size_t line, std::string_view text,
                 const char* separators)
    : path_(path), line_(line) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    if (end > begin) fields_.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

bool TextRow::isNumber(std::size_t i) const {
  double value = 0;
  return parse(at(i), value);
}

double TextRow::real(std::size_t i) const {
  double value = 0;
  if (!parse(at(i), value) || !std::isfinite(value)) fail(i, "a number");
  return value;
}

std::int64_t TextRow::integer(std::size_t i) const {
  const double value = real(i);
  if (value != std::floor(value) || std::abs(value) > 1e9) fail(i, "a whole number");
  return static_cast<std::int64_t>(value);
}

std::int64_t TextRow::frame(std::size_t i) const {
  const std::int64_t value = integer(i);
  if (value < 0) fail(i, "a frame number of at least 0");
  return value;
}

Eigen::Matrix<double, 3, 4> TextRow::matrix34(std::size_t first) const {
  const bool whole = size() == first + 16 && real(first + 12) == 0 && real(first + 13) == 0 &&
                     real(first + 14) == 0 && real(first + 15) == 1;
  expect(size() == first + 12 || whole, fmt::format("{}", first + 12));
  Eigen::Matrix<double, 3, 4> m;
  for (std::size_t i = 0; i < 12; ++i) {
    m(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = real(first + i);
  }
  return m;
}

Pose3 TextRow::pose34(std::size_t first) const { return rigid(matrix34(first)); }

Pose3 TextRow::rotation33(std::size_t first) const {
  expect(size() == first + 9, fmt::format("{}", first + 9));
  Eigen::Matrix<double, 3, 4> m = Eigen::Matrix<double, 3, 4>::Zero();
  for (std::size_t i = 0; i < 9; ++i) {
    m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = real(first + i);
  }
  return rigid(m);
}

/// A rigid motion from numbers of limited precision; their rotation is made exactly orthonormal.
Pose3 TextRow::rigid(const Eigen::Matrix<double, 3, 4>& m) const {
  const Eigen::Matrix3d r = m.leftCols<3>();
  if (!(r * r.transpose()).isIdentity(1e-2) || r.determinant() < 0)
    failLine("the 3x3 part is no rotation");
  Pose3 pose = Pose3::Identity();
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  pose.translation() = m.col(3);
  return pose;
}

void TextRow::expect(bool holds, const std::string& expected) const {
  if (!holds)
    throw DataError(fmt::format("{}:{}: {} fields, expected {}", path_, line_, size(), expected));
}

void TextRow::fail(std::size_t i, const std::string& expected) const {
  throw DataError(fmt::format("{}:{}: field {}: found '{}', expected {}", path_, line_, i + 1,
                              at(i), expected));
}

void TextRow::failLine(const std::string& message) const {
  throw DataError(fmt::format("{}:{}: {}", path_, line_, message));
}

bool TextRow::parse(std::string_view s, double& value) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  return parseWhole(s, value);
}

std::string_view TextRow::at(std::size_t i) const {
  if (i >= fields_.size()) failLine(fmt::format("field {} is missing", i + 1));
  return fields_[i];
}

std::string readBytes(const std::string& path, std::size_t most) {
  if (const auto what = irregularity(path); !what.empty())
    throw DataError(fmt::format("{}: {}, expected a file", path, what));
  const gzFile file = gzopen(path.c_str(), "rb");  // reads plain files, too
  if (file == nullptr)
    throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
  std::string bytes;
  int got = 0;
  do {
    const std::size_t begin = bytes.size();
    const auto block = std::clamp<std::size_t>(begin, 1U << 16, 1U << 20);
    bytes.resize(begin + block);
    got = gzread(file, bytes.data() + begin, static_cast<unsigned>(block));
    bytes.resize(begin + static_cast<std::size_t>(std::max(got, 0)));
  } while (got > 0 && bytes.size() <= most);
  // A truncated gzip file is detected only on close.
  const int closed = gzclose(file);
  if (got < 0 || closed != Z_OK) throw DataError(fmt::format("{}: bad or cut gzip data", path));
  if (bytes.size() > most)
    throw DataError(fmt::format("{}: more than {} bytes, expected one frame", path, most));
  return bytes;
}

void forEachRow(const std::string& path, const char* separators,
                const std::function<void(const TextRow&)>& use) {
  const std::string bytes = readBytes(path, std::size_t{1} << 30);
  const std::string_view text = withoutMark(bytes);
  for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const TextRow row(path, number, text.substr(begin, end - begin), separators);
    if (row.size() > 0) use(row);
    begin = end + 1;
  }
}

void requireFolder(const std::string& path) {
  if (!fs::exists(path))
    throw DataError(fmt::format("{}: no such folder", path), ExitCode::kNoInput);
  if (!fs::is_directory(path)) throw DataError(fmt::format("{}: not a folder", path));
}

std::vector<FrameFile> frameFiles(const std::string& dir, const std::vector<std::string>& endings,
                                  const std::function<bool(const std::string&)>& wants) {
  requireFolder(dir);
  std::vector<FrameFile> files;
  bool numbers = true;
  for (const auto& entry : fs::directory_iterator(dir)) {
    const std::string name = entry.path().filename().string();
    for (const std::string& ending : endings) {
      if (!endsWith(name, ending) || (wants && !wants(name))) continue;
      FrameFile file{0, name.substr(0, name.size() - ending.size()), entry.path().string()};
      numbers = numbers && parseWhole(std::string_view(file.stem), file.number) &&
                file.number >= 0 && file.number <= 1'000'000'000;
      files.push_back(std::move(file));
      break;
    }
  }
  if (files.empty()) {
    throw DataError(fmt::format("{}: no file that ends in {}", dir, fmt::join(endings, ", ")),
                    ExitCode::kNoInput);
  }
  std::sort(files.begin(), files.end(), [numbers](const FrameFile& a, const FrameFile& b) {
    return numbers && a.number != b.number ? a.number < b.number : a.path < b.path;
  });
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!numbers) files[i].number = static_cast<std::int64_t>(i);
    if (i > 0 && files[i].number == files[i - 1].number)
      throw DataError(fmt::format("{} and {}: two files of one frame", files[i - 1].path,
                                  fs::path(files[i].path).filename().string()));
  }
  return files;
}

std::string fileOfStem(const std::string& dir, const std::string& stem,
                       const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    const fs::path path = fs::path(dir) / (stem + ending);
    if (fs::exists(path)) return path.string();
  }
  return {};
}

std::optional<Pose3> poseFrom(const Vector3& position, const Eigen::Quaterniond& attitude) {
  if (!(std::abs(attitude.norm() - 1) < 1e-2)) return {};
  Pose3 pose = Pose3::Identity();
  pose.linear() = attitude.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

std::vector<StampedPose> readTumPoses(const std::string& path) {
  std::vector<StampedPose> poses;
  forEachRow(path, kSpaces, [&](const TextRow& row) {
    if (row.text(0).front() == '#') return;
    row.expect(row.size() == 8, "8: t x y z qx qy qz qw");
    const auto pose = poseFrom({row.real(1), row.real(2), row.real(3)},
                               {row.real(7), row.real(4), row.real(5), row.real(6)});
    if (!pose) row.failLine("qx qy qz qw is no unit quaternion");
    poses.push_back({stampOfSeconds(row.text(0)).value_or(Stamp::fromSeconds(row.real(0))), *pose});
  });
  if (poses.empty()) throw DataError(fmt::format("{}: no pose in it", path));
  return poses;
}

}  // namespace perception
