#include "libperception/evaluation/tables/Report.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "libperception/scene/files/NumberFormat.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

// Width on the screen: UTF-8 continuation bytes take no place.
std::size_t widthOf(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;
  }));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, widthOf(text)), ' ');
  return left ? text + space : space + text;
}

std::string textTable(const ReportTable& table) {
  std::vector<std::size_t> widths;
  for (const std::string& cell : table.header) widths.push_back(widthOf(cell));
  for (const auto& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], widthOf(row[c]));
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text = " ";
    for (std::size_t c = 0; c < cells.size(); ++c)
      text += " " + padded(cells[c], widths[c], c < table.labels) + " ";
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  };
  std::size_t total = 0;
  for (const std::size_t width : widths) total += width + 2;
  std::string text =
      table.title + "\n" + line(table.header) + "  " + std::string(total - 2, '-') + "\n";
  for (const auto& row : table.rows) text += line(row);
  for (const std::string& note : table.notes) text += "  * " + note + "\n";
  return text;
}

// Markdown takes a bar for the end of a cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

std::string markdownTable(const ReportTable& table) {
  std::string text = "## " + table.title + "\n\n|";
  for (const std::string& name : table.header) text += " " + cell(name) + " |";
  text += "\n|";
  for (std::size_t c = 0; c < table.header.size(); ++c) text += c < table.labels ? "---|" : "---:|";
  text += "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const std::string& value : row) text += " " + cell(value) + " |";
    text += "\n";
  }
  text += "\n";
  for (const std::string& note : table.notes) text += "- " + note + "\n";
  return text + "\n";
}

std::string scope(const EvaluationOptions& o) {
  return fmt::format(
      "Truth counts when its center is within {:g} m of the vehicle and {:g} deg ahead (whole "
      "angle), occluded <= "
      "{}, lidar points >= {} (where counted), and it is not marked as to be ignored.",
      o.selection.range, degrees(o.selection.fov), o.selection.max_occluded,
      o.selection.min_points);
}

// Of a run and its trials.
bool mayBeOfWeather(const EvaluatedRun& run,
                    const std::function<bool(const std::string& weather)>& has) {
  if (run.trials.empty()) return !run.weather || has(*run.weather);
  return std::any_of(run.trials.begin(), run.trials.end(),
                     [&](const EvaluatedRun& trial) { return mayBeOfWeather(trial, has); });
}

}  // namespace

bool anyRunOfWeather(const EvaluationReport& report,
                     const std::function<bool(const std::string& weather)>& has) {
  return std::any_of(report.runs.begin(), report.runs.end(),
                     [&](const EvaluatedRun& run) { return mayBeOfWeather(run, has); });
}

std::vector<std::string> dropRowsOfOtherWeathers(EvaluationReport& report) {
  std::vector<std::string> dropped;
  std::vector<PaperTrackingRow> kept;
  for (const PaperTrackingRow& row : report.paper) {
    if (anyRunOfWeather(report, [&](auto& w) { return paperTableHasWeather(row.table, w); })) {
      kept.push_back(row);
    } else if (std::find(dropped.begin(), dropped.end(), row.table) == dropped.end()) {
      dropped.emplace_back(row.table);
    }
  }
  report.paper = std::move(kept);
  return dropped;
}

EvaluatedRun pooledRun(std::string name, std::vector<EvaluatedRun> trials) {
  EvaluatedRun run;
  std::vector<const Evaluation*> parts;
  for (const EvaluatedRun& trial : trials) parts.push_back(&trial.evaluation);
  run.evaluation = pooled(parts);
  run.front_ends = trials.empty() ? std::vector<FrontEndEvaluation>() : trials.front().front_ends;
  for (std::size_t t = 1; t < trials.size(); ++t) {
    for (std::size_t f = 0; f < run.front_ends.size(); ++f)
      run.front_ends[f] += trials[t].front_ends.at(f);
  }
  run.name = std::move(name);
  run.trials = std::move(trials);
  return run;
}

std::vector<EvaluatedRun> pooledByCondition(const std::vector<std::string>& conditions,
                                            std::vector<EvaluatedRun> runs) {
  std::vector<std::pair<std::string, std::vector<EvaluatedRun>>> groups;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const std::string& condition = conditions[i];
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
      return !condition.empty() && g.first == condition;
    });
    if (group == groups.end()) group = groups.insert(groups.end(), {condition, {}});
    group->second.push_back(std::move(runs[i]));
  }
  std::vector<EvaluatedRun> pooled_runs;
  for (auto& [condition, members] : groups) {
    pooled_runs.push_back(condition.empty() ? std::move(members.front())
                                            : pooledRun(condition, std::move(members)));
  }
  return pooled_runs;
}

namespace {

/// Of which runs it is.
std::string marks(const EvaluationReport& report) {
  std::string text;
  const auto add = [&](const EvaluatedRun& run) {
    if (!run.id.empty()) text += fmt::format("{}: {}\n", run.name, runMark({run.id}));
  };
  for (const EvaluatedRun& run : report.runs) {
    add(run);
    for (const EvaluatedRun& trial : run.trials) add(trial);
  }
  return text;
}

}  // namespace

std::string textReport(const EvaluationReport& report) {
  std::string text = report.command + "\n" + scope(report.options) + "\n" + marks(report) + "\n";
  for (const ReportTable& table : reportTables(report)) text += textTable(table) + "\n";
  return text;
}

std::string instantsCsv(const EvaluatedRun& run) {
  std::string text =
      "frame,t,truth,estimates,gospa,localization,missed,false,ospa,outputs,false_outputs\n";
  for (const InstantFigures& i : run.evaluation.instants) {
    const OutputCounts outputs = i.allOutputs();
    const auto number = [](double value) { return fixedPlaces(value, kMeterPlaces); };
    text +=
        fmt::format("{},{:.3f},{},{},{},{},{},{},{},{},{}\n", i.frame, i.t, i.truth, i.estimates,
                    number(i.gospa.value()), number(i.gospa.localization), number(i.gospa.missed),
                    number(i.gospa.false_), number(i.ospa), outputs.named, outputs.false_);
  }
  return text;
}

std::string markdownReport(const EvaluationReport& report) {
  std::string text = "# Evaluation\n\n```\n" + report.command + "\n```\n\n" +
                     scope(report.options) + "\n\n" + marks(report) + "\n";
  for (const ReportTable& table : reportTables(report)) text += markdownTable(table);
  if (!report.plots.empty()) text += "## Plots\n\n";
  for (const std::string& plot : report.plots) text += fmt::format("![{0}](<{0}>)\n\n", plot);
  return text;
}

}  // namespace perception
