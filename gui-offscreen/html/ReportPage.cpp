#include "gui-offscreen/html/ReportPage.h"

#include <fmt/format.h>

#include <algorithm>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/ObjectLives.h"
#include "gui-offscreen/html/PageBundle.h"
#include "gui-offscreen/html/ReportStyle.h"
#include "gui-offscreen/html/ReportTimeline.h"
#include "libperception/scene/ClassColors.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

constexpr double kShortest = 0.5;      // [s] objects seen for less have no row
constexpr std::size_t kMostRows = 80;  // of the timeline; objects of longest lifetime are kept

/// Writes the page part by part.
class Page {
 public:
  Page(const ReportContent& content, const TextSink& sink)
      : content_(content), run_(content.run), sink_(sink) {
    for (const ObjectLife& life : content.lives) {
      if (isMuted(nameOfClass(run_, life.last_class))) {
        ++still_;
      } else if (life.to() - life.from() < kShortest) {
        ++brief_;
      } else {
        lives_.push_back(life);
      }
    }
    std::stable_sort(lives_.begin(), lives_.end(), [](const ObjectLife& a, const ObjectLife& b) {
      return a.to() - a.from() > b.to() - b.from();
    });
    if (lives_.size() > kMostRows) {
      left_out_ = lives_.size() - kMostRows;
      lives_.resize(kMostRows);
    }
    std::stable_sort(lives_.begin(), lives_.end(),
                     [](const ObjectLife& a, const ObjectLife& b) { return a.from() < b.from(); });
    end_ = run_.stamps.empty() ? 1 : run_.stamps.back() - run_.first_stamp + 0.1;
  }

  void write() {
    out_ = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"perception-run\" content=\"{}\">\n"
        "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n",
        runMark({content_.id}), escaped(title()), kReportStyle, pageStyle());
    head();
    if (content_.parts) out_ += "<div id=\"viewer\" data-run=\"run\"></div>\n";
    timeline();
    out_ += "<div id=\"weather\"></div>\n";
    video();
    pictures();
    evaluation();
    objects();
    out_ += "<div id=\"events\"></div>\n";
    provenance();
    flush();
    if (content_.parts) content_.parts->write(sink_);
    out_ += fmt::format("<script>{}</script>\n</body>\n</html>\n", pageScript());
    flush();
  }

 private:
  std::string title() const {
    return fmt::format("{}{}", content_.record.input,
                       content_.record.simulated ? " (simulated)" : "");
  }
  void tile(const std::string& value, const std::string& meaning) {
    out_ += fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", value, meaning);
  }
  void flush() {
    sink_(out_);
    out_.clear();
  }
  void head();
  void video();
  void timeline();
  void pictures();
  void evaluation();
  void objects();
  void provenance();
  void figure(const ReportContent::Figure& f);
  const nlohmann::json* judged() const;

  const ReportContent& content_;
  const RunOutline& run_;
  const TextSink& sink_;
  std::vector<ObjectLife> lives_;  // rows of the timeline, by first sight
  std::size_t still_ = 0, brief_ = 0, left_out_ = 0;
  double end_ = 1;  // [s] of the time axis
  std::string out_;
};

// The run's figures in the report of perception-evaluate, or null.
const nlohmann::json* Page::judged() const {
  const auto runs = content_.evaluation.find("runs");
  if (runs == content_.evaluation.end() || runs->empty()) return nullptr;
  return &(*runs)[0];
}

std::string percent(const nlohmann::json& value) {
  return value.is_number() ? fmt::format("{:.1f} %", 100 * value.get<double>()) : "n/a";
}

std::string number(const nlohmann::json& value, int places) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), places) : "n/a";
}

nlohmann::json at(const nlohmann::json& from, const std::string& pointer) {
  return from.value(nlohmann::json::json_pointer(pointer), nlohmann::json());
}

void Page::head() {
  const RunRecord& r = content_.record;
  const double seconds = r.last_stamp - r.first_stamp;
  std::string sensors;
  for (const SensorRecord& s : r.sensors) {
    if (s.frames == 0) continue;
    sensors += (sensors.empty() ? "" : ", ") + escaped(s.label);
  }
  out_ +=
      fmt::format("<h1>What was around the vehicle: {}</h1>\n<p class=\"lead\">", escaped(title()));
  if (r.simulated) {
    out_ += "These are <b>simulated</b> recordings: every figure below is a simulated result. ";
  }
  out_ += fmt::format(
      "In {:.1f} s of log the tracker took {} objects for road users for half a second or longer, "
      "with {}; wrong ones among them are counted below where there is truth. {} more are things "
      "that stand: poles, walls, bushes; {} were seen for a moment only.</p>\n"
      "<div class=\"tiles\">\n",
      seconds, lives_.size() + left_out_, sensors.empty() ? "its sensors" : sensors, still_,
      brief_);
  if (const auto* figures = judged()) {
    const auto& e = *figures;
    tile(percent(at(e, "/closest/all/object_tracked_a")), "of the true objects' time tracked");
    tile(percent(at(e, "/closest/all/correct")), "of that time named with the right class");
    tile(percent(at(e, "/closest/all/mis")), "named with a wrong class");
    tile(number(at(e, "/closest/all/position_rms_m"), 2) + " m", "error of position (rms)");
    tile(number(at(e, "/closest/all/id_switches"), 0), "times an object changed its number");
    tile(number(at(e, "/false_objects/all/classified_per_instant"), 2),
         "false road users per instant, named for sure");
  }
  if (content_.real_time_factor > 0) {
    const double factor = content_.real_time_factor;
    tile(fmt::format("{:.{}f} x", factor, factor < 10 ? 1 : 0), "as fast as real time");
  }
  out_ += "</div>\n";
}

void Page::figure(const ReportContent::Figure& f) {
  const bool is_video = f.media_type.rfind("video/", 0) == 0;
  out_ += is_video ? "<figure>\n<video id=\"film\" controls muted loop preload=\"auto\" src=\""
                   : fmt::format("<figure>\n<img alt=\"{}\" src=\"", escaped(f.title));
  out_ += "data:" + f.media_type + ";base64,";
  flush();
  putBase64(f.file, sink_);
  out_ += is_video ? "\"></video>\n" : "\">\n";
  out_ += fmt::format("<figcaption>{}</figcaption>\n</figure>\n", escaped(f.caption));
}

void Page::video() {
  if (content_.video.empty()) return;
  out_ += fmt::format("<h2>{}</h2>\n", escaped(content_.video[0].title));
  figure(content_.video[0]);
}

// One row per object over time; pale where not classified.
void Page::timeline() {
  if (lives_.empty()) return;
  out_ +=
      "<h2>Who was there, and when</h2>\n<p>One row for each road user that was tracked, from "
      "when it was first seen until it was lost; color: its class at that time, pale while "
      "that was less than 95 % sure.";
  const TimelineNote phantoms = phantomNote(content_.phantoms, end_);
  if (!phantoms.stretches.empty())
    out_ += " First row: many clusters of returns were phantoms (spray, snow, rain).";
  out_ += " A click goes to that time.";
  if (left_out_ > 0)
    out_ += fmt::format(" The {} seen longest; {} more are not shown.", kMostRows, left_out_);
  out_ += "</p>\n<p class=\"legend\">";
  for (std::size_t c = 0; c < run_.class_names.size(); ++c) {
    if (isMuted(run_.class_names[c])) continue;
    out_ += fmt::format("<span><i style=\"background:{}\"></i>{}</span>",
                        hexOf(colorOfClass(run_.class_names[c], static_cast<int>(c))),
                        spaced(run_.class_names[c]));
  }
  out_ += fmt::format("<span><i style=\"background:{}\"></i>something that stands</span>",
                      hexOf(colorOfClass("static-other", 0)));
  out_ += "</p>\n<div class=\"wide\">" + timelineChart(run_, lives_, end_, phantoms) + "</div>\n";
}

void Page::pictures() {
  for (const auto& f : content_.pictures) {
    out_ += fmt::format("<h2>{}</h2>\n", escaped(f.title));
    figure(f);
  }
}

void Page::evaluation() {
  const auto* figures = judged();
  if (!figures) return;
  const auto& e = *figures;
  out_ += fmt::format(
      "<h2>Against the truth</h2>\n<p>Truth counts within {} m of the vehicle and {} degrees "
      "ahead, "
      "where the lidar has at least {} returns on the object. An object is tracked at an instant "
      "when an estimate "
      "lies within {} m of it.</p>\n<table>\n<tr><th>class</th><th>tracked</th><th>right class</th>"
      "<th>wrong class</th><th>range error</th><th>position error</th><th>changes of number</th>"
      "<th>instants</th></tr>\n",
      number(at(content_.evaluation, "/options/range_m"), 0),
      number(at(content_.evaluation, "/options/fov_deg"), 0),
      number(at(content_.evaluation, "/options/min_points"), 0),
      number(at(content_.evaluation, "/options/tolerance_m"), 0));
  const auto row = [&](const std::string& name, const nlohmann::json& f) {
    if (!f.is_object() || f.value("active", 0) == 0) return;
    out_ += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{} m</td><td>{} m</td>"
        "<td>{}</td><td>{}</td></tr>\n",
        spaced(name), percent(at(f, "/object_tracked_a")), percent(at(f, "/correct")),
        percent(at(f, "/mis")), number(at(f, "/range_rms_m"), 2),
        number(at(f, "/position_rms_m"), 2), number(at(f, "/id_switches"), 0),
        number(at(f, "/active"), 0));
  };
  row("all", at(e, "/closest/all"));
  const nlohmann::json classes = at(e, "/closest/classes");
  for (const auto& [name, f] : classes.items()) row(name, f);
  out_ += "</table>\n";
  for (const auto& f : content_.plots) {
    out_ += fmt::format("<h3>{}</h3>\n", escaped(f.title));
    figure(f);
  }
}

void Page::objects() {
  if (lives_.empty()) return;
  out_ +=
      "<h2>The road users one by one</h2>\n<table>\n<tr><th>number</th><th>class at the end</th>"
      "<th>its probability</th><th>seen from</th><th>to</th><th>top speed</th><th>nearest</th>"
      "</tr>\n";
  for (const ObjectLife& life : lives_) {
    out_ += fmt::format(
        "<tr data-id=\"{}\"><td>{}</td><td style=\"color:{}\">{}</td><td>{:.2f}</td>"
        "<td>{:.1f} s</td><td>{:.1f} s</td><td>{:.0f} km/h</td><td>{:.1f} m</td></tr>\n",
        life.id, life.id, hexOf(colorOfClass(nameOfClass(run_, life.last_class), life.last_class)),
        spaced(nameOfClass(run_, life.last_class)), life.probability, life.from(), life.last_seen,
        life.top_speed * 3.6, life.nearest);
  }
  out_ += "</table>\n";
}

void Page::provenance() {
  const RunRecord& r = content_.record;
  out_ += "<h2>How this was made</h2>\n<table>\n";
  const auto row = [&](const std::string& what, const std::string& value) {
    out_ += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", what, escaped(value));
  };
  row("log", fmt::format("{}, {} entries, {}", r.input, r.input_entries, r.input_end));
  row("configuration", fmt::format("{}, seed {}, sensors {}, {} particles, {} association",
                                   r.config, r.seed, r.sensors_used, r.particles, r.association));
  row("program", r.program + " " + r.version);
  row("run", content_.id);
  for (const SensorRecord& s : r.sensors) {
    row("sensor " + escaped(s.label), fmt::format("{} frames, {} measurements, {} points dropped",
                                                  s.frames, s.measurements, s.dropped_points));
  }
  for (const auto& [kind, count] : r.events) row(spaced(kind), fmt::format("{} times", count));
  for (const std::string& warning : r.warnings) row("<b>warning</b>", warning);
  out_ += "</table>\n";
}

}  // namespace

void writeHtmlPage(const ReportContent& content, const TextSink& sink) {
  Page(content, sink).write();
}

}  // namespace perception
