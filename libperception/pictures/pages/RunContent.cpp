#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/pictures/pages/ReportData.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using FileListener = std::function<void(const std::string&)>;

/// Files of a run's folder shown on the page if they exist.
struct FigureRow {
  const char* file;
  const char* media_type;
  const char* title;
  const char* caption;
};
constexpr FigureRow kVideos[] = {
    {"scene.mp4", "video/mp4", "Video",
     "Left from above, right from behind the vehicle. Boxes: tracked objects; thin black "
     "outlines: truth; points: lidar returns; legend at the right."}};
constexpr FigureRow kPictures[] = {{"scene.png", "image/png", "One instant, large",
                                    "The same view as in the video. Arrow: predicted path of one "
                                    "second; line: path of the last two."},
                                   {"contact.png", "image/png", "Overview of the run",
                                    "Instants at equal intervals, from above."}};
constexpr FigureRow kPlots[] = {
    {"plots/timelines.png", "image/png", "Truth objects over time",
     "One row per truth object: estimated class, missed instants, id switches."},
    {"plots/overview.png", "image/png", "Over time",
     "Above: each truth object, tracked or not, class correct or not. Below: number of true, "
     "missed and false objects at each instant."},
    {"plots/reliability.png", "image/png", "Calibration of the class probability",
     "Observed frequency of the correct class over its stated probability; ideal: the diagonal."}};

/// Those of the run among `rows` of names.
template <class Rows>
std::vector<ReportContent::Figure> figuresIn(const fs::path& dir, const Rows& rows,
                                             const std::string& id,
                                             const FileListener& without_origin) {
  std::vector<ReportContent::Figure> figures;
  for (const auto& row : rows) {
    const fs::path file = dir / row.file;
    if (!fs::exists(file)) continue;
    if (isOfRuns(file, {id})) {
      figures.push_back({row.title, row.caption, row.media_type, file.string()});
    } else {
      without_origin(file.string());
    }
  }
  return figures;
}

// Pictures of other names in the folder that say that they are of the run.
void addOtherPictures(const std::string& run_dir, ReportContent& content) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(run_dir)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const bool png = file.extension() == ".png", jpeg = file.extension() == ".jpg";
    const bool known =
        std::any_of(std::begin(kPictures), std::end(kPictures),
                    [&](const FigureRow& row) { return file.filename() == row.file; });
    if ((!png && !jpeg) || known || !fs::is_regular_file(file)) continue;
    const auto ids = markedRunsOf(file.string());
    if (std::find(ids.begin(), ids.end(), content.id) == ids.end()) continue;
    content.pictures.push_back({file.filename().string(), "From the run's folder.",
                                png ? "image/png" : "image/jpeg", file.string()});
  }
}

void addEvaluation(const std::string& run_dir, const std::string& evaluation_dir,
                   const FileListener& without_origin, ReportContent& content) {
  const fs::path dir =
      evaluation_dir.empty() ? fs::path(run_dir) / "evaluation" : fs::path(evaluation_dir);
  const fs::path report = dir / "report.json";
  if (!fs::exists(report)) {
    if (evaluation_dir.empty()) return;
    throw DataError(report.string() + ": there is no such file", ExitCode::kNoInput);
  }
  const nlohmann::json figures = figuresOf(report, content.id);
  if (figures.is_null()) return without_origin(report.string());
  content.evaluation = jsonOf(report);
  content.evaluation["runs"] = nlohmann::json::array({figures});
  content.plots = figuresIn(dir, kPlots, content.id, without_origin);
}

}  // namespace

ReportContent contentOf(const std::string& run_dir, const std::string& evaluation_dir,
                        const FileListener& without_origin) {
  ReportContent content;
  content.run = readRunOutline(run_dir);
  content.record = readRunRecord((fs::path(run_dir) / "done.json").string());
  const fs::path timing = fs::path(run_dir) / "timing.json";
  if (fs::exists(timing)) content.real_time_factor = jsonOf(timing).value("real_time_factor", 0.0);
  content.id = idOfRun(content.record);
  content.video = figuresIn(run_dir, kVideos, content.id, without_origin);
  content.pictures = figuresIn(run_dir, kPictures, content.id, without_origin);
  addOtherPictures(run_dir, content);
  addEvaluation(run_dir, evaluation_dir, without_origin, content);
  return content;
}

}  // namespace perception
