#include "libperception/core/TruthStream.h"

#include <limits>
#include <utility>

namespace perception {
namespace {

constexpr double kAround = 1;  // [s] no truth belongs to a scene so far away

bool isInOrder(const std::string& path) {
  CsvStream rows(path);
  requireTruthColumns(rows.row());
  const CsvTable::Column t = rows.row().column("t");
  double last = -std::numeric_limits<double>::infinity();
  while (rows.next()) {
    const double now = rows.row().real(0, t);
    if (now < last) return false;
    last = now;
  }
  return true;
}

}  // namespace

TruthStream::TruthStream(const std::string& path) {
  if (!isInOrder(path)) {
    sorted_ = readGroundTruth(path).instants;
  } else {
    rows_ = std::make_unique<CsvStream>(path);
  }
  nextInstant();
}

const GroundTruth& TruthStream::around(const TruthSpan& span) {
  auto& instants = window_.instants;
  auto kept = instants.begin();
  while (kept != instants.end() && kept->t < span.from - kAround &&
         !(kept->frame >= 0 && span.first_frame >= 0 && kept->frame >= span.first_frame))
    ++kept;
  instants.erase(instants.begin(), kept);
  while (next_ && (next_->t <= span.to + kAround ||
                   (next_->frame >= 0 && next_->frame <= span.last_frame))) {
    instants.push_back(std::move(*next_));
    nextInstant();
  }
  return window_;
}

void TruthStream::nextSorted() {
  if (given_ < sorted_.size()) next_ = std::move(sorted_[given_++]);
}

void TruthStream::nextInstant() {
  next_.reset();
  if (!rows_) {
    nextSorted();
    return;
  }
  if (pending_) {
    next_.emplace(GroundTruth::Instant{pending_->frame, pending_->t, {}});
    next_->objects.push_back(std::move(*pending_));
    pending_.reset();
  }
  while (rows_->next()) {
    TruthObject object = readTruthRow(rows_->row(), 0);
    order_.add(object, rows_->row(), 0);
    if (next_ && next_->t != object.t) {
      pending_ = std::move(object);
      return;
    }
    if (!next_) next_.emplace(GroundTruth::Instant{object.frame, object.t, {}});
    next_->objects.push_back(std::move(object));
  }
}

}  // namespace perception
