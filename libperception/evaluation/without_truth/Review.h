#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// What a person says of one output: "is this a car?"
enum class ReviewAnswer { kYes, kNo, kUnsure };

/// One output of a run that a person is asked about.
struct ReviewItem {
  std::size_t scene = 0;    ///< index in TrackedRun::scenes
  std::size_t object = 0;   ///< index in its objects
  double t = 0;             ///< [s] since the log's first stamp
  std::uint64_t id = 0;     ///< of the object
  std::string class_name;   ///< as output
  double probability = 0;   ///< of that class
  std::size_t outputs = 0;  ///< of the class in the run that could have been drawn
  ReviewAnswer answer = ReviewAnswer::kUnsure;
};

struct ReviewOptions {
  std::size_t number = 200;  ///< of outputs that are asked about, at most
  std::uint64_t seed = 1;
  double range = 40;           ///< [m] outputs up to this distance of the center
  double fov = kPi;            ///< [rad] whole angle ahead
  double min_existence = 0.5;  ///< outputs below are not asked about
  bool sure = false;           ///< only outputs of a class probability of at least .95
};

/// Draws outputs of named classes at random, the same number of each class as far as there are so
/// many, in order of time. A function of run and options.
std::vector<ReviewItem> drawReview(const TrackedRun& run, const ReviewOptions& options,
                                   const std::vector<std::string>& unnamed);

/// The answers that the truth gives: yes if a truth object of the class is within the tolerance;
/// unsure where the truth knows nothing (no truth of the scene, an unlabeled area or an ignored
/// object there, outside of the angle in which it is complete).
void answerByTruth(const TrackedRun& run, const GroundTruth& truth,
                   const EvaluationOptions& options, std::vector<ReviewItem>& items);

/// ANSWERS.csv: `run,t,id,class,probability,outputs,answer`; answer: yes, no, unsure or empty
/// (not asked yet). `run`: RunRecord::hash.
std::string reviewText(const std::string& run, const std::vector<ReviewItem>& items);
struct ReviewAnswers {
  std::string run;
  std::vector<ReviewItem> items;  ///< without scene and object
  std::size_t open = 0;           ///< not answered, not among them
};
/// Throws DataError naming file, line and column.
ReviewAnswers readReview(const std::string& path);

/// Share of right outputs of a class with its 95 % interval (method.md 11.1).
struct ReviewPrecision {
  std::string class_name;   ///< "all": every class, weighted by its number of outputs
  std::size_t outputs = 0;  ///< of the run
  std::size_t asked = 0, unsure = 0, right = 0;
  std::size_t objects = 0;                  ///< different ids among the answers that count
  double precision = 0, low = 0, high = 1;  ///< unknown without an answer that counts: 0 to 1
};
/// By class in order of the name, "all" last; unsure answers do not count.
std::vector<ReviewPrecision> reviewPrecision(const std::vector<ReviewItem>& items);
std::string reviewTable(const std::vector<ReviewPrecision>& rows);

/// Finds outputs that were asked about in the run of this folder, by id and time. `file`: of the
/// answers. Throws DataError naming both.
void placeItems(const TrackedRun& run, const std::string& run_dir, const std::string& file,
                std::vector<ReviewItem>& items);
/// Number of equal answers, and number of items that both are sure of.
std::pair<std::size_t, std::size_t> sameAnswers(const std::vector<ReviewItem>& a,
                                                const std::vector<ReviewItem>& b);

}  // namespace perception
