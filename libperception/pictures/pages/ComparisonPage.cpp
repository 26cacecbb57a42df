#include "libperception/pictures/pages/ComparisonPage.h"

#include <fmt/format.h>

#include <set>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/PageBundle.h"
#include "gui-offscreen/html/ReportStyle.h"
#include "libperception/pictures/pages/ComparisonTimeline.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

constexpr char kStyle[] = R"css(
td { vertical-align: top; }
.sides td { max-width: 460px; overflow-wrap: anywhere; }
.sides td:first-child { overflow-wrap: normal; }
.time { white-space: nowrap; }
td.n, th.n { text-align: right; }
td small, .gone { color: var(--pale); }
)css";

/// A figure of perception-evaluate.
struct EvaluatedFigure {
  const char* pointer;
  const char* name;
  double factor;  ///< to the unit of the name
  int places;
};
constexpr EvaluatedFigure kEvaluated[] = {
    {"/closest/all/object_tracked_a", "true objects' time tracked [%]", 100, 1},
    {"/closest/all/correct", "of it right and sure [%]", 100, 1},
    {"/closest/all/mis", "of it wrong and sure [%]", 100, 1},
    {"/one_to_one/all/position_rms_m", "error of position, rms [m]", 1, 2},
    {"/one_to_one/all/id_switches", "id switches against the truth", 1, 0},
    {"/false_objects/all/per_instant", "false objects an instant", 1, 2},
    {"/false_objects/all/classified_per_instant", "of them of a sure class", 1, 2},
    {"/identities/mota", "MOTA", 1, 3},
    {"/identities/hota", "HOTA", 1, 3},
    {"/identities/idf1", "IDF1", 1, 3},
    {"/set_distance/gospa_mean_m", "GOSPA, mean [m]", 1, 2}};

std::string evaluated(const ComparedRun& run, const EvaluatedFigure& figure) {
  const auto value =
      run.evaluation.value(nlohmann::json::json_pointer(figure.pointer), nlohmann::json());
  return value.is_number()
             ? fmt::format("{:.{}f}", figure.factor * value.get<double>(), figure.places)
             : "n/a";
}

/// A table "what | A | B"; escapes all text, bold where the values differ.
class SideBySide {
 public:
  explicit SideBySide(const std::string& what)
      : out_(fmt::format("<table class=\"sides\">\n<tr><th>{}</th><th>A</th><th>B</th></tr>\n",
                         escaped(what))) {}
  void row(const std::string& what, const std::string& a, const std::string& b) {
    const char* tag = a == b ? "span" : "b";
    out_ += fmt::format("<tr><td>{0}</td><td><{3}>{1}</{3}></td><td><{3}>{2}</{3}></td></tr>\n",
                        escaped(what), escaped(a), escaped(b), tag);
  }
  void row(const std::string& what, std::size_t a, std::size_t b) {
    row(what, fmt::format("{}", a), fmt::format("{}", b));
  }
  std::string html() const { return out_ + "</table>\n"; }

 private:
  std::string out_;
};

std::string runsTable(const ComparedRun& a, const ComparedRun& b) {
  SideBySide table("run");
  const RunRecord &r = a.record, &s = b.record;
  table.row("folder", a.dir, b.dir);
  table.row("configuration", r.config, s.config);
  table.row("sensors", r.sensors_used, s.sensors_used);
  table.row("seed", r.seed, s.seed);
  table.row("program", r.program + " " + r.version, s.program + " " + s.version);
  table.row("log, bytes", r.input_bytes, s.input_bytes);
  table.row("hash", r.hash, s.hash);
  return table.html();
}

std::string keysTable(const RunComparison& comparison) {
  std::string out = "<h2>Configuration</h2>\n";
  for (const std::string& dir : comparison.without_ini)
    out += fmt::format("<p>Not compared: {} has no effective.ini.</p>\n", escaped(dir));
  if (!comparison.without_ini.empty()) return out;
  if (comparison.keys.empty()) return out + "<p>All keys have the same values.</p>\n";
  SideBySide table("key");
  for (const KeyDifference& key : comparison.keys) table.row(key.key, key.a, key.b);
  return out + table.html();
}

std::string figuresTable(const RunComparison& comparison) {
  const RunFigures &a = comparison.difference.a, &b = comparison.difference.b;
  SideBySide table("figure");
  table.row("scenes", a.scenes, b.scenes);
  table.row("objects in all scenes", a.objects, b.objects);
  table.row("of them of a sure class", a.sure, b.sure);
  table.row("objects an instant, mean", fmt::format("{:.2f}", a.objectsPerInstant()),
            fmt::format("{:.2f}", b.objectsPerInstant()));
  table.row("ids", a.identities, b.identities);
  const auto &events_a = comparison.a.record.events, &events_b = comparison.b.record.events;
  std::set<std::string> kinds;
  for (const auto* events : {&events_a, &events_b})
    for (const auto& [kind, count] : *events) kinds.insert(kind);
  const auto count = [](const auto& events, const std::string& kind) {
    const auto found = events.find(kind);
    return static_cast<std::size_t>(found == events.end() ? 0 : found->second);
  };
  for (const std::string& kind : kinds)
    table.row("events: " + kind, count(events_a, kind), count(events_b, kind));
  if (comparison.a.evaluation.is_object() && comparison.b.evaluation.is_object()) {
    for (const EvaluatedFigure& figure : kEvaluated) {
      table.row(figure.name, evaluated(comparison.a, figure), evaluated(comparison.b, figure));
    }
  }
  return "<h2>Figures</h2>\n" + table.html();
}

std::string lead(const RunDifference& d) {
  if (d.none()) {
    return fmt::format(
        "<p class=\"lead\"><b>no difference</b>: the same objects with the same values at all {} "
        "instants.</p>\n",
        d.common);
  }
  std::size_t only_a = 0, only_b = 0, apart = 0;
  for (const IdentityDifference& row : d.rows) {
    only_a += row.b ? 0 : 1;
    only_b += row.a ? 0 : 1;
    apart += row.a && row.b && row.apart > 0 ? 1 : 0;
  }
  std::string out = fmt::format(
      "<p class=\"lead\">{} instants are common to both runs. Of {} pairs of objects {} differ in "
      "when they are there or in class, {} more in other values only. {} objects of A and {} of B "
      "have no pair.</p>\n",
      d.common, d.pairs, apart, d.rows.size() - only_a - only_b - apart, only_a, only_b);
  const auto also = [&](std::size_t count, const char* what) {
    if (count > 0) out += fmt::format("<p>{} {}.</p>\n", count, what);
  };
  also(d.only_a, "instants are only in A");
  also(d.only_b, "instants are only in B");
  also(d.shifted, "common instants have different stamps; places of B are moved to those of A");
  also(d.ego_apart, "common instants have another pose or motion of the vehicle");
  also(d.path_apart, "common instants have another free path ahead of the vehicle");
  return out;
}

// Its number, and those of the other run that it was matched with beside its pair.
std::string identityCell(const std::optional<ComparedIdentity>& identity,
                         const std::optional<ComparedIdentity>& other, const char* run,
                         const char* other_run) {
  if (!identity) {
    return fmt::format("<td class=\"gone\">{}</td>",
                       other->matched.empty() ? fmt::format("only in {}", other_run) : "no pair");
  }
  std::string rest;
  for (const auto& [id, instants] : identity->matched) {
    if (other && id == other->id) continue;
    rest += fmt::format("{}{} {} ({})", rest.empty() ? "" : ", ", other_run, id, instants);
  }
  return fmt::format("<td>{} {}{}</td>", run, identity->id,
                     rest.empty() ? "" : "<br><small>also " + rest + "</small>");
}

// Most probable class at the end with its probability, and instants of each.
std::string classCell(const RunDifference& d, const std::optional<ComparedIdentity>& identity) {
  if (!identity) return "<td></td>";
  std::string counts;
  for (std::size_t c = 0; c < d.classes.size(); ++c) {
    if (identity->class_instants[c] == 0) continue;
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", spaced(d.classes[c]),
                          identity->class_instants[c]);
  }
  return fmt::format("<td><span style=\"color:{}\">{}</span> {:.2f}<br><small>{}</small></td>",
                     hexOfClass(d, identity->last_class), spaced(d.classes[identity->last_class]),
                     identity->last_probability, counts);
}

std::string timeCell(const std::optional<ComparedIdentity>& identity) {
  return identity ? fmt::format("<td class=\"time\">{:.1f} to {:.1f}</td>", identity->first,
                                identity->last)
                  : "<td></td>";
}

std::string objectsTable(const RunDifference& d) {
  std::string out = fmt::format(
      "<h2>The objects one by one</h2>\n<p>Those that differ at most instants first. Objects are "
      "the same at an instant when their centers are at most {} m apart and no other assignment is "
      "nearer; two ids are a pair when no other assignment has more instants in common. Class: "
      "most "
      "probable at the end with its probability, and instants at which each was. Small print below "
      "an id: ids of the other run at its place, with instants.</p>\n"
      "<table id=\"differences\">\n<tr><th>A</th><th>B</th><th class=\"n\">differ [instants]</th>"
      "<th>class in A</th><th>class in B</th><th>in A [s]</th><th>in B [s]</th>"
      "<th class=\"n\">in common [instants]</th><th class=\"n\">distance, rms [m]</th>"
      "<th class=\"n\">other class [instants]</th><th class=\"n\">id switches of A</th>"
      "<th class=\"n\">of B</th><th class=\"n\">any value [instants]</th></tr>\n",
      DifferenceOptions().reach);
  for (const IdentityDifference& row : d.rows) {
    const auto cell = [](const auto& value) {
      return fmt::format("<td class=\"n\">{}</td>", value);
    };
    out += fmt::format("<tr data-id=\"{}\" data-of=\"{}\">", row.a ? row.a->id : row.b->id,
                       row.a ? "a" : "b") +
           identityCell(row.a, row.b, "A", "B") + identityCell(row.b, row.a, "B", "A") +
           cell(row.apart) + classCell(d, row.a) + classCell(d, row.b) + timeCell(row.a) +
           timeCell(row.b) + cell(row.together) +
           cell(row.together > 0 ? fmt::format("{:.2f}", row.distance_rms) : "") +
           cell(row.classes_apart) + cell(row.a ? fmt::format("{}", row.a->switches) : "") +
           cell(row.b ? fmt::format("{}", row.b->switches) : "") + cell(row.values_apart) +
           "</tr>\n";
  }
  return out + "</table>\n";
}

// The film, or how it is made.
void putFilm(const RunComparison& comparison, const TextSink& sink) {
  sink("<h2>Side by side</h2>\n");
  if (comparison.film.empty()) {
    return sink(fmt::format(
        "<p>A film of both is made by <code>perception-snapshot -r {} -r {} -i LOG --video "
        "both.mp4</code> and comes into this page by <code>--film both.mp4</code>.</p>\n",
        escaped(comparison.a.dir), escaped(comparison.b.dir)));
  }
  sink(
      "<figure>\n<video id=\"film\" controls muted loop preload=\"auto\" "
      "src=\"data:video/mp4;base64,");
  putBase64(comparison.film, sink);
  sink(
      "\"></video>\n<figcaption>A on the left, B on the right.</figcaption>\n"
      "</figure>\n");
}

std::string timelineSection(const RunDifference& d) {
  if (d.rows.empty()) return "";
  std::string out =
      "<h2>When they differ</h2>\n<p>Two bars a row: A above, B below; color: class; striped: only "
      "this run has the object there; pale: the other run has no scene.";
  if (d.rows.size() > kMostComparedRows) {
    out += fmt::format(" The {} rows that differ most; {} more are in the table only.",
                       kMostComparedRows, d.rows.size() - kMostComparedRows);
  }
  out += "</p>\n<p class=\"legend\">";
  for (std::size_t c = 0; c < d.classes.size(); ++c) {
    out += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", hexOfClass(d, c),
                       spaced(d.classes[c]));
  }
  return out + "</p>\n" + comparisonTimeline(d);
}

}  // namespace

void writeComparisonPage(const RunComparison& comparison, const TextSink& sink) {
  const RunDifference& d = comparison.difference;
  const std::string mark = runMark({idOfRun(comparison.a.record), idOfRun(comparison.b.record)});
  const std::string title =
      fmt::format("What differs between two runs of {}{}", comparison.a.record.input,
                  comparison.a.record.simulated ? " (simulated)" : "");
  sink(
      fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                  "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
                  "<meta name=\"perception-run\" content=\"{3}\">\n"
                  "<title>{0}</title>\n<style>{1}{4}{2}</style>\n</head>\n<body>\n"
                  "<h1>{0}</h1>\n",
                  escaped(title), kReportStyle, kStyle, mark, pageStyle()));
  sink(lead(d));
  if (!comparison.parts.empty())
    sink("<div id=\"viewer\" data-run=\"a\" data-other=\"b\"></div>\n");
  putFilm(comparison, sink);
  sink("<h2>The runs</h2>\n" + runsTable(comparison.a, comparison.b) + keysTable(comparison) +
       figuresTable(comparison) + timelineSection(d) + objectsTable(d));
  for (const auto& parts : comparison.parts) parts->write(sink);
  sink(fmt::format("<script>{}</script>\n</body>\n</html>\n", pageScript()));
}

}  // namespace perception
