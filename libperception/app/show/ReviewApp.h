#pragma once
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/evaluation/without_truth/Review.h"

namespace perception {

/// perception-review: a page on which a person says of outputs of a run whether they are right, and
/// the precision of the run by these answers.
class ReviewApp : public App {
 public:
  ReviewApp()
      : App("perception-review",
            "Lets a person say whether outputs of a run are right, where there is no truth: a page "
            "of questions, and the precision by the answers.") {}

  std::string run_dir;       ///< -r: folder of perception-track
  std::string truth_file;    ///< -t
  std::string answers_file;  ///< score ANSWERS.csv
  ReviewOptions options;
  EvaluationOptions evaluation;  ///< tolerance and complete field of view of the truth
  double fov_deg = 180, complete_fov_deg = 360;

  std::vector<ReviewItem> out_items;           ///< that are asked about, or answered
  std::vector<ReviewPrecision> out_precision;  ///< by the answers
  std::vector<ReviewPrecision> out_by_truth;   ///< of the same outputs by the truth
  std::string out_page;

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void makePage();
  void score();

  bool scoring_ = false;
};

}  // namespace perception
