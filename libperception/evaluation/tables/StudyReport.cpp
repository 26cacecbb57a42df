#include "libperception/evaluation/tables/StudyReport.h"

#include <fmt/format.h>

namespace perception {
namespace {

std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

template <class Cell>
std::string line(const std::vector<std::string>& cells, const char* between, Cell cell) {
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) out += (i ? between : "") + cell(cells[i]);
  return out;
}

}  // namespace

std::string csvOf(const StudyTable& table) {
  std::string out = line(table.columns, ",", csvCell) + '\n';
  for (const auto& row : table.rows) out += line(row, ",", csvCell) + '\n';
  return out;
}

std::string markdownOf(const StudyTable& table) {
  const auto same = [](const std::string& s) { return s; };
  std::string out =
      fmt::format("**{}**\n\n| {} |\n|", table.title, line(table.columns, " | ", same));
  for (std::size_t i = 0; i < table.columns.size(); ++i) out += "---|";
  out += '\n';
  for (const auto& row : table.rows) out += fmt::format("| {} |\n", line(row, " | ", same));
  return out;
}

std::string markdownOf(const StudyReport& report) {
  std::string out = fmt::format("# {}\n\nData: {}.\n", report.title, report.data);
  for (const auto& table : report.tables) out += '\n' + markdownOf(table);
  for (const auto& plot : report.plots)
    out += fmt::format("\n![{}]({}.png)\n\n{}\n", plot.name, plot.name, plot.caption);
  if (!report.remarks.empty()) out += '\n';
  for (const auto& remark : report.remarks) out += fmt::format("- {}\n", remark);
  return out;
}

}  // namespace perception
