#include "libperception/detection/DetectLabels.h"

#include <fmt/format.h>

#include <filesystem>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/importers/kitti/KittiLabels.h"

namespace perception {
namespace {

/// [rad] KITTI's mark of a label without a heading.
constexpr double kUnknownAlpha = -10;

namespace fs = std::filesystem;

// Truth types that KITTI's benchmark ignores for a class.
std::string kindredOf(const std::string& type) {
  if (type == "Van") return "Car";
  if (type == "Person_sitting" || type == "Person") return "Pedestrian";
  return "";
}

LabeledBox labeled(const std::string& type, const ObjectDetection::ImageBox& box, bool ignore,
                   const LabelRules& rules) {
  LabeledBox out;
  const std::string kindred = kindredOf(type);
  out.label = kindred.empty() ? type : kindred;
  out.box = box;
  out.area = type == "DontCare";
  out.ignore = ignore || !kindred.empty() || box.y2 - box.y1 < rules.min_height;
  return out;
}

}  // namespace

ImageLabels::ImageLabels(const std::string& path, LabelRules rules)
    : path_(path), rules_(rules), folder_(fs::is_directory(path)) {
  if (!fs::exists(path))
    throw DataError(fmt::format("{}: no such folder or file of labels", path), ExitCode::kNoInput);
  if (folder_) return;
  const CsvTable table = CsvTable::fromFile(path);
  const auto image = table.column("image"), type = table.column("class");
  const auto x1 = table.column("x1"), y1 = table.column("y1"), x2 = table.column("x2"),
             y2 = table.column("y2");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    bool ignore = table.has("ignore") && table.flag(row, table.column("ignore"));
    if (table.has("occluded"))
      ignore = ignore || table.integer(row, table.column("occluded")) > rules.max_occlusion;
    LabeledBox box = labeled(
        std::string(table.text(row, type)),
        {table.real(row, x1), table.real(row, y1), table.real(row, x2), table.real(row, y2)},
        ignore, rules);
    if (table.has("heading_deg") && !table.text(row, table.column("heading_deg")).empty())
      box.heading = radians(table.real(row, table.column("heading_deg")));
    by_image_[std::string(table.text(row, image))].push_back(box);
  }
}

std::vector<LabeledBox> ImageLabels::of(const std::string& file_name) const {
  if (!folder_) {
    const auto found = by_image_.find(file_name);
    return found == by_image_.end() ? std::vector<LabeledBox>{} : found->second;
  }
  const std::string path =
      (fs::path(path_) / (fs::path(file_name).stem().string() + ".txt")).string();
  std::vector<LabeledBox> out;
  for (const KittiLabel& l : readKittiObjectLabels(path, 0)) {
    const bool hidden = l.truncated > rules_.max_truncation || l.occluded > rules_.max_occlusion;
    LabeledBox box = labeled(l.type, l.image_box, hidden, rules_);
    if (!box.area && l.alpha > kUnknownAlpha) box.heading = wrapAngle(l.alpha);
    out.push_back(box);
  }
  return out;
}

}  // namespace perception
