#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/drawing/Picture.h"

namespace perception {

/// One question of the review page.
struct ReviewQuestion {
  double t = 0;  ///< [s] since the log's first stamp
  std::string id, class_name;
  std::string row;  ///< line of the answers without the answer: run,t,id,class,probability,outputs
  std::vector<Picture> pictures;
};

/// A page that asks "is this a CLASS?" of one object after the other, by keys or buttons, keeps the
/// answers in the browser and saves them as `header` and one line each. One HTML file without a
/// network.
std::string reviewPage(const std::string& title, const std::string& header,
                       const std::vector<ReviewQuestion>& questions);

}  // namespace perception
