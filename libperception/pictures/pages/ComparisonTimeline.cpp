#include "libperception/pictures/pages/ComparisonTimeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/ReportTimeline.h"
#include "libperception/scene/ClassColors.h"

namespace perception {
namespace {

constexpr TimelineSpan kSpan{130, 900};                               // [px]
constexpr double kRow = 18, kBar = 6, kGap = 2, kTop = kTimelineTop;  // [px]
constexpr double kMargin = 20;  // [px] right of the axis, for half of its last figure

// White stripes over the color of the class.
constexpr char kHatch[] =
    "<defs><pattern id=\"hatch\" width=\"5\" height=\"5\" patternUnits=\"userSpaceOnUse\" "
    "patternTransform=\"rotate(45)\"><rect width=\"2.5\" height=\"5\" fill=\"#fff\"/></pattern>"
    "</defs>\n";

std::string meaningOf(ComparedIdentity::Other other) {
  switch (other) {
    case ComparedIdentity::Other::kMatched:
      return "";
    case ComparedIdentity::Other::kNone:
      return ", only in this run";
    case ComparedIdentity::Other::kNoInstant:
      break;
  }
  return ", not compared: the other run has no scene";
}

std::string bars(const RunDifference& d, const ComparedIdentity& identity, const char* run,
                 double y) {
  std::string out;
  const auto x = [&](double t) { return kSpan.left + kSpan.width * t / std::max(d.end, 1e-3); };
  for (const ComparedIdentity::Stretch& s : identity.stretches) {
    const std::string place =
        fmt::format("x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.0f}\"", x(s.from), y,
                    std::max(1.0, x(std::min(s.to, d.end)) - x(s.from)), kBar);
    const bool pale = s.other == ComparedIdentity::Other::kNoInstant;
    out += fmt::format(
        "<g><title>{} {}: {}, {:.1f} to {:.1f} s{}</title><rect {} data-id=\"{}\" "
        "data-of=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>",
        run, identity.id, spaced(d.classes[s.class_index]), s.from, s.to, meaningOf(s.other), place,
        identity.id, run[0] == 'A' ? "a" : "b", hexOfClass(d, s.class_index), pale ? "0.35" : "1");
    if (s.other == ComparedIdentity::Other::kNone)
      out += fmt::format("<rect {} fill=\"url(#hatch)\" pointer-events=\"none\"/>", place);
    out += "</g>\n";
  }
  return out;
}

std::string label(const std::optional<ComparedIdentity>& identity) {
  return identity ? fmt::format("{}", identity->id) : "-";
}

}  // namespace

std::string hexOfClass(const RunDifference& difference, std::size_t class_index) {
  return hexOf(colorOfClass(difference.classes[class_index], static_cast<int>(class_index)));
}

std::string comparisonTimeline(const RunDifference& d) {
  const std::size_t rows = std::min(d.rows.size(), kMostComparedRows);
  const double height = kTop + kRow * static_cast<double>(rows) + 4;
  std::string out = fmt::format(
      "<svg id=\"timeline\" viewBox=\"0 0 {:.0f} {:.0f}\" data-left=\"{:.0f}\" "
      "data-width=\"{:.0f}\" data-end=\"{:.3f}\">\n{}{}",
      kSpan.left + kSpan.width + kMargin, height, kSpan.left, kSpan.width, std::max(d.end, 1e-3),
      kHatch, timeAxis(std::max(d.end, 1e-3), kSpan, height));
  double y = kTop;
  for (std::size_t r = 0; r < rows; ++r, y += kRow) {
    const IdentityDifference& row = d.rows[r];
    out +=
        fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">A {} &#183; B {}</text>\n",
                    kSpan.left - 8, y + 12, label(row.a), label(row.b));
    if (row.a) out += bars(d, *row.a, "A", y + kGap);
    if (row.b) out += bars(d, *row.b, "B", y + kGap + kBar + 1);
  }
  return out +
         fmt::format("<line id=\"now\" y1=\"{:.0f}\" y2=\"{:.0f}\" x1=\"-9\" x2=\"-9\"/>\n</svg>\n",
                     kTop - 6, height);
}

}  // namespace perception
