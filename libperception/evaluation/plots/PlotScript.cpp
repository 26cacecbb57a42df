#include "libperception/evaluation/plots/PlotScript.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPicture = R"(
reset
set encoding utf8
set datafile missing 'nan'
set terminal pngcairo size {width},{height} font 'sans,10' background rgb 'white'
set output '{file}'
set grid xtics ytics lt 1 lw 1 lc rgb '#DDDDDD'
set key noenhanced outside right top vertical Left reverse
)";

constexpr const char* kOurs[] = {"timelines.png",   "overview.png",  "set_distance.png",
                                 "reliability.png", "existence.png", "comparison.png"};

void removeOldPictures(const std::string& dir) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(dir, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool ours = std::find(std::begin(kOurs), std::end(kOurs), name) != std::end(kOurs) ||
                      name.rfind("object_", 0) == 0;
    if (ours) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

PlotScript::PlotScript(const std::string& dir) : dir_(dir + "/plots") {
  createFolder(dir_);
  removeOldPictures(dir_);
}

void PlotScript::data(const std::string& name, const std::string& text) const {
  writeFile(dir_ + "/" + name, text);
}

void PlotScript::begin(const std::string& file, std::size_t width, std::size_t height) {
  files_.push_back(file);
  script_ += fmt::format(kPicture, fmt::arg("width", width), fmt::arg("height", height),
                         fmt::arg("file", file));
}

PlotResult PlotScript::draw() const {
  PlotResult result;
  data("plots.gp", script_);
  if (files_.empty()) return result;
  result.fault = runGnuplot(dir_, "plots.gp");
  for (const std::string& file : files_) {
    std::error_code ignored;
    if (fs::exists(dir_ + "/" + file, ignored)) result.files.push_back("plots/" + file);
  }
  return result;
}

}  // namespace perception
