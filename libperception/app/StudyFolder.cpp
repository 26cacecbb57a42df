#include "libperception/app/StudyFolder.h"

#include <fmt/format.h>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

std::vector<std::string> writeStudyReport(const StudyReport& report, const std::string& output) {
  std::vector<std::string> faults;
  OutputFolder folder(output);
  for (const auto& table : report.tables)
    writeFile(folder.pathFor(table.name + ".csv"), csvOf(table));
  for (const auto& [file, content] : report.files) writeFile(folder.pathFor(file), content);
  std::string dir;
  for (const auto& plot : report.plots) {
    for (const auto& [file, content] : plot.data) writeFile(folder.pathFor(file), content);
    const std::string script = plot.name + ".gp", path = folder.pathFor(script);
    writeFile(path, fmt::format("set terminal pngcairo size {},{} font 'Sans,11'\n"
                                "set output '{}.png'\n{}",
                                plot.width, plot.height, plot.name, plot.script));
    dir = path.substr(0, path.size() - script.size());
    const std::string fault = runGnuplot(dir.empty() ? "." : dir, script);
    if (fault.empty()) {
      folder.pathFor(plot.name + ".png");
    } else {
      faults.push_back(fault);
    }
  }
  writeFile(folder.pathFor("report.md"), markdownOf(report));
  folder.commit("report.md");
  return faults;
}

}  // namespace perception
