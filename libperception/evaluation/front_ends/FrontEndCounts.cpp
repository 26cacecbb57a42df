#include "libperception/evaluation/front_ends/FrontEndCounts.h"

namespace perception {

RecallCounts& RecallCounts::operator+=(const RecallCounts& other) {
  in_view += other.in_view;
  found += other.found;
  named += other.named;
  named_primary += other.named_primary;
  measurements += other.measurements;
  return *this;
}

PrecisionCounts& PrecisionCounts::operator+=(const PrecisionCounts& other) {
  measurements += other.measurements;
  right_class += other.right_class;
  right_size += other.right_size;
  for (const auto& [kind, count] : other.on) on[kind] += count;
  return *this;
}

}  // namespace perception
