#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace perception {

/// A table of a study, numbers formatted as text. Written as NAME.csv and into the Markdown report.
struct StudyTable {
  std::string name;   ///< of the CSV file, without extension
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

/// Results of a study.
struct StudyReport {
  std::string title;
  std::string data;  ///< description of the data; begins with "simulated" if they are
  std::vector<StudyTable> tables;
  std::vector<StudyPlot> plots;
  std::vector<std::pair<std::string, std::string>> files;  ///< further files: name, content
  std::vector<std::string> remarks;                        ///< sentences below the tables
};

/// The report as one Markdown text, plots linked as NAME.png.
std::string markdownOf(const StudyReport& report);
/// A table as CSV with a header line.
std::string csvOf(const StudyTable& table);
/// The table as Markdown.
std::string markdownOf(const StudyTable& table);

}  // namespace perception
