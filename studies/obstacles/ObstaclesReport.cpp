#include "studies/obstacles/ObstaclesReport.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace perception {
namespace {

constexpr std::size_t kClearAllowed = 0;  // silent scenes before a call
constexpr std::size_t kWeatherAllowed = 2;
constexpr std::size_t kMostSilentRows = 60;  // of the report; all of them are in drives.csv
constexpr auto kAdvice = StopCaller::kAdvice, kClusters = StopCaller::kClusters;

/// Sums over drives.
struct DriveSums {
  std::size_t drives = 0, shown = 0, scenes = 0, silent = 0;
  std::size_t missed[kStopCallers] = {}, late[kStopCallers] = {};
  std::size_t false_stops[kStopCallers] = {}, false_scenes[kStopCallers] = {};
  std::size_t causes[kSilenceCauses] = {};
  double share[kStopCallers] = {};  // of the stopping distance at which is called, summed
  std::size_t called[kStopCallers] = {};

  void add(const ObstacleVerdict& verdict, std::size_t allowed) {
    ++drives, shown += verdict.shownWithin(), scenes += verdict.scenes;
    silent += verdict.of(kAdvice).silent;
    for (std::size_t k = 0; k < kSilenceCauses; ++k) causes[k] += verdict.silent_by_cause[k];
    for (std::size_t k = 0; k < kStopCallers; ++k) {
      const auto caller = static_cast<StopCaller>(k);
      const ObstacleVerdict::Calls& calls = verdict.of(caller);
      missed[k] += verdict.missed(caller), late[k] += verdict.late(caller, allowed);
      false_stops[k] += calls.stops.falsely.stops, false_scenes[k] += calls.stops.falsely.scans;
      if (!std::isfinite(calls.called_at)) continue;
      ++called[k];
      share[k] += calls.called_at / verdict.needed;
    }
  }
};

std::size_t allowedIn(const std::string& weather) {
  return weather == "clear" ? kClearAllowed : kWeatherAllowed;
}

/// Calls use(case, intensity, verdict) for every drive.
using DriveUse = std::function<void(const DriveCase&, const std::string&, const ObstacleVerdict&)>;
void forAll(const std::vector<DriveCase>& cases, const ObstaclesOptions& options,
            const DriveUse& use) {
  for (const DriveCase& one : cases)
    for (std::size_t i = 0; i < one.verdicts.size(); ++i)
      use(one, options.intensity[i], one.verdicts[i]);
}

std::string metersOrNone(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value) : "";
}

std::string demandName(ShapeDemand demand) {
  return demand == ShapeDemand::kStop ? "stop" : demand == ShapeDemand::kLow ? "low" : "pass";
}

std::string calledShare(const DriveSums& sums, std::size_t k) {
  if (sums.called[k] == 0) return "";
  return fmt::format("{:.2f}", sums.share[k] / static_cast<double>(sums.called[k]));
}

const std::vector<std::string>& sumColumns() {
  static const std::vector<std::string> columns = {
      "drives",          "shown in time", "missed",      "late",       "silent scenes",
      "clusters missed", "clusters late", "false stops", "in scenes",  "clusters' false stops",
      "in scenes",       "of scenes",     "called at",   "clusters at"};
  return columns;
}

std::vector<std::string> sumCells(const DriveSums& s) {
  std::vector<std::string> cells;
  for (const std::size_t count :
       {s.drives, s.shown, s.missed[0], s.late[0], s.silent, s.missed[1], s.late[1],
        s.false_stops[0], s.false_scenes[0], s.false_stops[1], s.false_scenes[1], s.scenes})
    cells.push_back(fmt::format("{}", count));
  cells.push_back(calledShare(s, 0)), cells.push_back(calledShare(s, 1));
  return cells;
}

/// Sums by a key of each drive, in the order of their first use.
StudyTable sumTable(
    const std::string& name, const std::string& title, const std::vector<std::string>& key_columns,
    const std::vector<DriveCase>& cases, const ObstaclesOptions& options,
    const std::function<std::vector<std::string>(const DriveCase&, const std::string&)>& key_of) {
  std::vector<std::vector<std::string>> order;
  std::map<std::vector<std::string>, DriveSums> sums;
  forAll(cases, options,
         [&](const DriveCase& one, const std::string& intensity, const ObstacleVerdict& verdict) {
           const auto key = key_of(one, intensity);
           if (sums.find(key) == sums.end()) order.push_back(key);
           sums[key].add(verdict, allowedIn(one.weather));
         });
  StudyTable table = {name, title, key_columns, {}};
  table.columns.insert(table.columns.end(), sumColumns().begin(), sumColumns().end());
  for (const auto& key : order) {
    table.rows.push_back(key);
    const auto cells = sumCells(sums[key]);
    table.rows.back().insert(table.rows.back().end(), cells.begin(), cells.end());
  }
  return table;
}

std::vector<std::string> driveCells(const DriveCase& one, const std::string& intensity) {
  const ObstacleDriveParams& p = one.params;
  return {p.shape->name,
          fmt::format("{}", p.beams),
          fmt::format("{:g}", p.speed),
          driveWayNames()[static_cast<std::size_t>(p.way)],
          one.weather,
          intensity};
}

std::vector<std::string> verdictCells(const ObstacleVerdict& v) {
  std::vector<std::string> cells = {
      metersOrNone(v.needed), metersOrNone(v.shown_at), metersOrNone(v.of(kAdvice).called_at),
      metersOrNone(v.of(kClusters).called_at), fmt::format("{}", v.of(kAdvice).silent)};
  for (const std::size_t count : v.silent_by_cause) cells.push_back(fmt::format("{}", count));
  return cells;
}

StudyTable driveTable(const std::string& name, const std::string& title) {
  return {name,
          title,
          {"shape", "beams", "speed [m/s]", "way", "weather", "intensity", "stopping distance [m]",
           "ten returns at [m]", "called at [m]", "clusters at [m]", "silent scenes", "by height",
           "by ground", "by doubt"},
          {}};
}

StudyTable everyDrive(const std::vector<DriveCase>& cases, const ObstaclesOptions& options) {
  StudyTable table = driveTable("drives", "");
  for (const char* more : {"demand", "shown in time", "missed", "clusters missed", "false scenes",
                           "clusters' false scenes", "scenes"})
    table.columns.emplace_back(more);
  forAll(cases, options,
         [&](const DriveCase& one, const std::string& intensity, const ObstacleVerdict& v) {
           auto row = driveCells(one, intensity);
           for (const std::string& cell : verdictCells(v)) row.push_back(cell);
           row.push_back(demandName(one.params.shape->demand));
           for (const std::size_t count :
                {std::size_t{v.shownWithin()}, std::size_t{v.missed(kAdvice)},
                 std::size_t{v.missed(kClusters)}, v.of(kAdvice).stops.falsely.scans,
                 v.of(kClusters).stops.falsely.scans, v.scenes})
             row.push_back(fmt::format("{}", count));
           table.rows.push_back(std::move(row));
         });
  return table;
}

StudyTable silentDrives(const std::vector<DriveCase>& cases, const ObstaclesOptions& options) {
  StudyTable table = driveTable("silent", "Drives in which the advice came late or never");
  std::size_t count = 0;
  forAll(cases, options,
         [&](const DriveCase& one, const std::string& intensity, const ObstacleVerdict& v) {
           if (!v.missed(kAdvice) && !v.late(kAdvice, allowedIn(one.weather))) return;
           if (++count > kMostSilentRows) return;
           auto row = driveCells(one, intensity);
           for (const std::string& cell : verdictCells(v)) row.push_back(cell);
           table.rows.push_back(std::move(row));
         });
  if (count > kMostSilentRows)
    table.title += fmt::format(" (the first {} of {}; all: drives.csv)", kMostSilentRows, count);
  return table;
}

StudyPlot shapesPlot(const std::vector<DriveCase>& cases, const ObstaclesOptions& options) {
  std::map<std::string, DriveSums> sums;
  forAll(cases, options,
         [&](const DriveCase& one, const std::string&, const ObstacleVerdict& verdict) {
           if (one.params.shape->demand == ShapeDemand::kStop)
             sums[one.params.shape->name].add(verdict, 0);
         });
  std::string data;
  for (const auto& [name, s] : sums) {
    const auto cell = [&, sum = &s](std::size_t k) {
      return sum->called[k] > 0 ? calledShare(*sum, k) : std::string("NaN");
    };
    data += fmt::format("\"{}\" {} {}\n", name, cell(0), cell(1));
  }
  StudyPlot plot;
  plot.name = "called";
  plot.caption =
      "Distance at the first call by the stopping distance, mean of the drives that had one";
  plot.script =
      "set ylabel 'first call / stopping distance'\nset yrange [0:1.15]\nset grid y\n"
      "set xtics rotate by 90 right font ',8'\nset key top left horizontal\n"
      "plot 1 lc rgb '#bbbbbb' notitle, 'called.dat' using 0:2:xtic(1) with points pt 7 "
      "lc rgb '#0072b2' title 'advice', 'called.dat' using 0:3 with points pt 6 "
      "lc rgb '#d55e00' title 'Euclidean clusters'\n";
  plot.width = 1500, plot.height = 600;
  plot.data = {{"called.dat", data}};
  return plot;
}

std::vector<std::string> remarks(const ObstaclesOptions& options) {
  return {
      "Everything here is simulated: boxes on a flat road, walls to both sides, at 10 Hz; lidars "
      "on a car's roof by the lidar equation, weather as perception-simulate has it.",
      fmt::format("The lidar sees {:g} deg about the direction of travel; a drive begins {:g} s "
                  "before the shape is within the stopping distance and ends when both have called "
                  "or the vehicle is there.",
                  options.sector, options.lead),
      "Shown in time: in one scene or more ten returns of the shape stood within half a meter "
      "along "
      "the driven corridor, lower than the vehicle with its clearance, and .3 m or more within the "
      "stopping distance. Missed: no stop was called in such a drive. Late: one was, but only "
      "after a scene (in weather: after more than two) that showed them. Silent scenes: those.",
      "Silent by height: fewer than ten of these returns are as high above the road as [points] "
      "height_min; by ground: fewer by the front end's ground; by doubt: the rest, as of cells "
      "seen once or returns taken for phantoms.",
      "False stops: nothing is in the way within the stopping distance and a meter more. Scenes "
      "apart by at most .5 s are one stop. A stop with the shape within that distance counts for "
      "the shape, whatever called for it, for both callers.",
      "Called at: distance at the first call by the stopping distance, mean of the drives with "
      "one.",
      "Shapes that demand nothing (low) are lower than height_min: hoses, pallets, someone lying "
      "on the back. Of these the safety grid calls for those that stand up by .22 m or more, where "
      "enough beams show it; they count neither as missed nor as false.",
      "Clusters: ten returns, linked at .7 m in space, every return trusted. Intensity none: 0 for "
      "every return."};
}

}  // namespace

StudyReport obstaclesReport(const std::vector<DriveCase>& cases, const ObstaclesOptions& options,
                            std::size_t shapes) {
  StudyReport report;
  report.title = "Obstacles that no detector was taught";
  report.data = fmt::format("simulated: {} shapes, {} drives, {}", shapes,
                            cases.size() * options.intensity.size(), options.config);
  report.tables = {
      sumTable("sensors", "By weather, lidar and intensity", {"weather", "beams", "intensity"},
               cases, options,
               [](const DriveCase& one, const std::string& intensity) {
                 return std::vector<std::string>{one.weather, fmt::format("{}", one.params.beams),
                                                 intensity};
               }),
      sumTable("speeds", "By speed and way", {"speed [m/s]", "way"}, cases, options,
               [](const DriveCase& one, const std::string&) {
                 return std::vector<std::string>{
                     fmt::format("{:g}", one.params.speed),
                     driveWayNames()[static_cast<std::size_t>(one.params.way)]};
               }),
      sumTable("shapes", "By shape", {"shape", "kind", "demand", "top [m]"}, cases, options,
               [](const DriveCase& one, const std::string&) {
                 const ObstacleShape& shape = *one.params.shape;
                 return std::vector<std::string>{shape.name, shape.kind, demandName(shape.demand),
                                                 fmt::format("{:.2f}", topOf(shape))};
               }),
      silentDrives(cases, options)};
  report.plots = {shapesPlot(cases, options)};
  report.files = {{"drives.csv", csvOf(everyDrive(cases, options))}};
  report.remarks = remarks(options);
  return report;
}

}  // namespace perception
