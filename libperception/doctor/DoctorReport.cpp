#include "libperception/doctor/DoctorReport.h"

#include <fmt/format.h>

#include <utility>

#include "libperception/doctor/DoctorPicture.h"

namespace perception {
namespace {

const char* wordOf(Finding::Weight weight) {
  using Weight = Finding::Weight;
  return weight == Weight::kFine ? "ok" : weight == Weight::kNote ? "note" : "FAULT";
}

}  // namespace

std::string reportText(const std::vector<Finding>& findings) {
  std::string out;
  for (const auto& f : findings)
    out += fmt::format("{:5} {:16} {}\n", wordOf(f.weight), f.about, f.text);
  return out;
}

StudyReport doctorReport(const LogSurvey& survey, const std::vector<Finding>& findings,
                         const std::string& log) {
  StudyReport report;
  report.title = "What " + log + " holds";
  report.data = log;
  report.tables.push_back(
      {"contents", "Observations", LogContents::columns(), survey.contents().rows()});
  StudyTable table{"findings", "Findings", {"", "about", "finding"}, {}};
  for (const auto& f : findings) table.rows.push_back({wordOf(f.weight), f.about, f.text});
  report.tables.push_back(std::move(table));
  report.plots.push_back(doctorPicture(survey));
  report.remarks.push_back("Next: perception-track -c site.ini -i LOG -o DIR");
  return report;
}

}  // namespace perception
