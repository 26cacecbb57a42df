#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/evaluation/without_truth/Review.h"

namespace perception {

std::string reviewTable(const std::vector<ReviewPrecision>& rows) {
  std::string out = fmt::format("{:<14}{:>9}{:>7}{:>9}{:>7}{:>8}  {}\n", "class", "outputs",
                                "asked", "objects", "right", "unsure", "precision, 95 % limits");
  for (const ReviewPrecision& r : rows) {
    out += fmt::format("{:<14}{:>9}{:>7}{:>9}{:>7}{:>8}", r.class_name, r.outputs, r.asked,
                       r.objects, r.right, r.unsure);
    out += r.asked > r.unsure
               ? fmt::format("  {:.3f} ({:.3f} to {:.3f})\n", r.precision, r.low, r.high)
               : "  not known\n";
  }
  return out;
}

void placeItems(const TrackedRun& run, const std::string& run_dir, const std::string& file,
                std::vector<ReviewItem>& items) {
  std::map<std::pair<std::int64_t, std::uint64_t>, std::pair<std::size_t, std::size_t>> places;
  const auto nanoseconds = [](double t) {
    return static_cast<std::int64_t>(std::llround(t * 1e9));
  };
  for (std::size_t s = 0; s < run.scenes.size(); ++s) {
    const Scene& scene = run.scenes[s];
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
      places[{nanoseconds(scene.stamp - run.first_stamp), scene.objects[o].id}] = {s, o};
  }
  for (ReviewItem& item : items) {
    const auto found = places.find({nanoseconds(item.t), item.id});
    if (found == places.end())
      throw DataError(
          fmt::format("{}: object {} at t = {} s is not in {}", file, item.id, item.t, run_dir));
    std::tie(item.scene, item.object) = found->second;
  }
}

std::pair<std::size_t, std::size_t> sameAnswers(const std::vector<ReviewItem>& a,
                                                const std::vector<ReviewItem>& b) {
  std::size_t both = 0, same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].answer == ReviewAnswer::kUnsure || b[i].answer == ReviewAnswer::kUnsure) continue;
    ++both;
    same += a[i].answer == b[i].answer ? 1 : 0;
  }
  return {same, both};
}

}  // namespace perception
