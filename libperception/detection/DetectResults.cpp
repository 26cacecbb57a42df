#include "libperception/detection/DetectResults.h"

#include <fmt/format.h>

#include <algorithm>

#include "libperception/core/math/Angle.h"

namespace perception {

std::string kittiBoxLine(const ObjectDetection& o) {
  const auto& b = *o.image_box;
  return fmt::format(
      "{} -1 -1 {:.4f} {:.2f} {:.2f} {:.2f} {:.2f} -1 -1 -1 -1000 -1000 -1000 -10 {:.4f}\n",
      o.label, o.heading.value_or(-10), b.x1, b.y1, b.x2, b.y2, o.score);
}

std::string qualityText(const std::vector<LabelQuality>& quality) {
  std::string text;
  for (const LabelQuality& q : quality) {
    if (q.labeled == 0) continue;
    text += fmt::format("{:12} AP {:.3f}  recall {:.3f}  ({} labeled, {} right, {} wrong)", q.label,
                        q.average_precision, q.recall, q.labeled, q.right, q.wrong);
    if (q.headings > 0)
      text += fmt::format("; heading: median {:.1f} deg, rms {:.1f} deg, {} flips of {}",
                          degrees(q.heading_median), degrees(q.heading_rms), q.flips, q.headings);
    text += "\n";
  }
  return text;
}

std::string qualityCsv(const std::vector<LabelQuality>& quality) {
  std::string table =
      "label,labeled,right,wrong,average_precision,recall,headings,heading_median_deg,"
      "heading_rms_deg,flips,orientation_similarity\n";
  for (const LabelQuality& q : quality) {
    table += fmt::format("{},{},{},{},{:.4f},{:.4f},{},{:.2f},{:.2f},{},{:.4f}\n", q.label,
                         q.labeled, q.right, q.wrong, q.average_precision, q.recall, q.headings,
                         degrees(q.heading_median), degrees(q.heading_rms), q.flips,
                         q.orientation_similarity);
  }
  return table;
}

std::string precisionCsv(const std::vector<LabelQuality>& quality) {
  std::string curve = "label,score,recall,precision\n";
  for (const LabelQuality& q : quality) {
    for (const auto& p : q.curve)
      curve += fmt::format("{},{:.4f},{:.4f},{:.4f}\n", q.label, p.score, p.recall, p.precision);
  }
  return curve;
}

std::string calibrationIni(const DetectorSetup& setup, const DetectionQuality& quality,
                           std::int64_t images, double overlap) {
  std::string text = fmt::format(
      "; P(right | score) of boxes, fitted by perception-detect --calibrate to {} images, overlap "
      "{}.\n; To be included by the INI of the detector.\n",
      images, overlap);
  for (const auto& [name, model] : setup.models) {
    std::string lines;
    for (const std::string& label : quality.labels()) {
      if (!model.label.empty() && model.label != label) continue;
      const auto fit = fitLogistic(quality.judged(label));
      const auto& boxes = quality.judged(label);
      const auto right = std::count_if(boxes.begin(), boxes.end(), [](auto& b) { return b.right; });
      if (!fit) continue;
      const std::string suffix = model.label.empty() ? "." + label : "";
      lines += fmt::format("slope{} = {:.4f}  ; {} right boxes, {} wrong ones\n", suffix,
                           fit->slope, right, static_cast<std::ptrdiff_t>(boxes.size()) - right);
      lines += fmt::format("even_score{} = {:.4f}\n", suffix, fit->even_score);
    }
    if (!lines.empty()) text += fmt::format("\n[model.{}]\n{}", name, lines);
  }
  return text;
}

}  // namespace perception
