#include "gui-offscreen/html/ReportTimeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "gui-offscreen/html/HtmlText.h"
#include "libperception/scene/ClassColors.h"

namespace perception {
namespace {

constexpr double kLabelWidth = 130, kChartWidth = 900, kTrackRow = 16,
                 kAxis = kTimelineTop;  // [px]

/// The row of a note at `y` [px].
std::string noteRow(const TimelineNote& note, double y, double end) {
  const double scale = kChartWidth / end;  // [px/s]
  std::string out = fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                                kLabelWidth - 8, y + 12, escaped(note.name));
  for (const TimelineNote::Stretch& s : note.stretches) {
    out += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.0f}\" "
        "fill=\"#c040c0\"><title>{}, {:.1f} to {:.1f} s</title></rect>\n",
        kLabelWidth + scale * s.from, y + 2, std::max(1.0, scale * (s.to - s.from)), kTrackRow - 4,
        escaped(s.title), s.from, s.to);
  }
  return out;
}

}  // namespace

TimelineNote phantomNote(const nlohmann::json& events, double end) {
  TimelineNote note;
  note.name = "phantoms";
  std::map<std::string, std::size_t> open;  // stretches by sensor
  for (const auto& event : events) {
    const std::string kind = event.value("kind", "");
    const bool begins = kind == "phantoms_begin";
    if ((!begins && kind != "phantoms_end") || !event.contains("t") || !event["t"].is_number())
      continue;
    const std::string sensor = event.value("fields", nlohmann::json::object()).value("sensor", "");
    const double t = std::min(event["t"].get<double>(), end);
    if (const auto known = open.find(sensor); known != open.end()) {
      note.stretches[known->second].to = t;
      open.erase(known);
    }
    if (!begins) continue;
    open[sensor] = note.stretches.size();
    note.stretches.push_back({t, end, event.value("message", "")});
  }
  return note;
}

std::string nameOfClass(const RunOutline& run, ClassId c) {
  const auto i = static_cast<std::size_t>(c);
  return c >= 0 && i < run.class_names.size() ? run.class_names[i] : "?";
}

std::string timeAxis(double end, const TimelineSpan& span, double bottom) {
  const double step = end > 120 ? 20 : end > 40 ? 5 : end > 15 ? 2 : 1;  // [s]
  std::string out;
  for (double t = 0; t <= end; t += step) {
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.0f}\" "
        "y2=\"{2:.0f}\"/><text x=\"{0:.1f}\" y=\"14\" "
        "text-anchor=\"middle\">{3:g} s</text>\n",
        span.left + span.width * t / end, kTimelineTop - 4, bottom, t);
  }
  return out;
}

std::string timelineChart(const RunOutline& run, const std::vector<ObjectLife>& lives, double end,
                          const TimelineNote& note) {
  const double notes = note.stretches.empty() ? 0 : kTrackRow;  // [px]
  const double height = kAxis + notes + kTrackRow * static_cast<double>(lives.size()) + 4;
  const auto x = [&](double t) { return kLabelWidth + kChartWidth * t / end; };
  std::string out = fmt::format(
      "<svg id=\"timeline\" viewBox=\"0 0 {:.0f} {:.0f}\" data-left=\"{:.0f}\" "
      "data-width=\"{:.0f}\" data-end=\"{:.3f}\" data-start=\"{:.3f}\">\n",
      kLabelWidth + kChartWidth + 10, height, kLabelWidth, kChartWidth, end,
      run.stamps.empty() ? 0 : run.stamps.front() - run.first_stamp);
  out += timeAxis(end, {kLabelWidth, kChartWidth}, height);
  if (notes > 0) out += noteRow(note, kAxis, end);
  double y = kAxis + notes;
  for (const ObjectLife& life : lives) {
    const std::string name = spaced(nameOfClass(run, life.last_class));
    out += fmt::format(
        "<text data-id=\"{2}\" x=\"{0:.0f}\" y=\"{1:.1f}\" text-anchor=\"end\">{2} {3}</text>\n",
        kLabelWidth - 8, y + 12, life.id, name);
    for (const ObjectLife::Stretch& s : life.stretches) {
      out += fmt::format(
          "<rect data-id=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.0f}\" "
          "fill=\"{}\" "
          "fill-opacity=\"{}\"><title>{}: {}{}, {:.1f} to {:.1f} s</title></rect>\n",
          life.id, x(s.from), y + 2, std::max(1.0, x(s.to) - x(s.from)), kTrackRow - 4,
          hexOf(colorOfClass(nameOfClass(run, s.class_id), s.class_id)), s.sure ? "1" : "0.4",
          life.id, s.sure ? "" : "probably ", spaced(nameOfClass(run, s.class_id)), s.from, s.to);
    }
    y += kTrackRow;
  }
  out += fmt::format("<line id=\"now\" y1=\"{:.0f}\" y2=\"{:.0f}\" x1=\"-9\" x2=\"-9\"/>\n</svg>\n",
                     kAxis - 6, height);
  return out;
}

}  // namespace perception
