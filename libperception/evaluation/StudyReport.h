#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace perception {

/// A table of a study, numbers already as text. Becomes NAME.csv and a part of the Markdown report.
struct StudyTable {
  std::string name;   ///< of the CSV file, without ending
  std::string title;  ///< one line
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// A picture: a gnuplot script that writes NAME.png in the folder of its data files.
struct StudyPlot {
  std::string name;
  std::string caption;
  std::string script;  ///< without terminal and output
  int width = 900, height = 600;
  std::vector<std::pair<std::string, std::string>> data;  ///< file name, content
};

/// What a study found.
struct StudyReport {
  std::string title;
  std::string data;  ///< what it was measured on: begins with "simulated" where it was
  std::vector<StudyTable> tables;
  std::vector<StudyPlot> plots;
  std::vector<std::pair<std::string, std::string>> files;  ///< further ones: name, content
  std::vector<std::string> remarks;                        ///< sentences that belong to the figures
};

/// The report as one Markdown text, plots linked as NAME.png.
std::string markdownOf(const StudyReport& report);
/// A table as CSV with a header line.
std::string csvOf(const StudyTable& table);
/// The table as Markdown.
std::string markdownOf(const StudyTable& table);

}  // namespace perception
