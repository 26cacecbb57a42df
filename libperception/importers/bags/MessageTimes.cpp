#include "libperception/importers/bags/MessageTimes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "libperception/core/math/Median.h"

namespace perception {
namespace {

// All assumed.
constexpr double kLate = 1;                // [s] that a message may be recorded behind later ones
constexpr double kFitsGap = 0.75;          // [periods] to the messages beside it
constexpr double kStrayAhead = 1;          // [s] least step of stamps that jump ahead and come back
constexpr std::size_t kMostStray = 10;     // messages
constexpr double kSteadyLead = 1;          // [s]
constexpr double kAhead = 1, kBehind = 2;  // [s] of a clock that is set by the recording's
constexpr double kResent = 0.02;           // [s]
constexpr double kMostInARow = 0.1;        // [-] of close messages, behind another close one
constexpr double kSlowestTurn = 0.25;      // [s] of a lidar: 5 Hz, and some slack

/// [s] Median of the steps ahead; 0 without.
double periodOf(const std::vector<Stamp>& stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) steps.push_back(stamps[i] - stamps[i - 1]);
  }
  return steps.empty() ? 0 : medianOf(std::move(steps));
}

/// How many stamps from `at` on jump ahead, and come back to where the time went on.
std::size_t strayFrom(const std::vector<Stamp>& stamps, std::size_t at, Stamp newest,
                      double period) {
  if (stamps[at] - newest < std::max(kStrayAhead, 3 * period)) return 0;
  for (std::size_t k = 1; k <= kMostStray && at + k < stamps.size(); ++k) {
    const Stamp next = stamps[at + k];
    if (next >= newest && stamps[at] - next > kStrayAhead && next - newest < kStrayAhead) return k;
  }
  return 0;
}

bool fitsGap(const std::set<Stamp>& used, Stamp stamp, double period) {
  const auto after = used.lower_bound(stamp);
  const double least = kFitsGap * period;
  if (after != used.end() && *after - stamp < least) return false;
  return after == used.begin() || stamp - *std::prev(after) >= least;
}

class Selection {
 public:
  explicit Selection(const std::vector<Stamp>& stamps)
      : stamps_(stamps), period_(periodOf(stamps)), uses_(stamps.size(), true) {
    for (std::size_t i = 0; i < stamps_.size(); ++i) look(i);
  }
  const std::vector<bool>& uses() const { return uses_; }
  double farthest() const { return farthest_; }

 private:
  void look(std::size_t i) {
    if (!newest_) return use(i);
    if (i < stray_until_) return leaveOut(i);
    if (const std::size_t stray = strayFrom(stamps_, i, *newest_, period_); stray > 0) {
      stray_until_ = i + stray;
      return leaveOut(i);
    }
    const double back = *newest_ - stamps_[i];
    // Doubles come one behind the other; others of the same stamp are of a time that went back.
    const bool follows = back < 0 || (back == 0 && i > 0 && uses_[i - 1]);
    const bool late = back > 0 && back <= kLate && fitsGap(recent_, stamps_[i], period_);
    follows || late ? use(i) : leaveOut(i);
  }
  void use(std::size_t i) {
    if (!newest_ || stamps_[i] > *newest_) newest_ = stamps_[i];
    recent_.insert(stamps_[i]);
    while (*newest_ - *recent_.begin() > 2 * kLate) recent_.erase(recent_.begin());
  }
  void leaveOut(std::size_t i) {
    uses_[i] = false;
    farthest_ = std::max(farthest_, std::abs(*newest_ - stamps_[i]));
  }

  const std::vector<Stamp>& stamps_;
  double period_;
  std::vector<bool> uses_;
  std::optional<Stamp> newest_;
  std::set<Stamp> recent_;
  std::size_t stray_until_ = 0;
  double farthest_ = 0;
};

}  // namespace

double resentWithin(std::vector<Stamp> stamps) {
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  std::size_t close = 0, in_a_row = 0;
  std::vector<double> others;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] - stamps[i - 1] > kResent) {
      others.push_back(stamps[i] - stamps[i - 1]);
      continue;
    }
    ++close;
    in_a_row += i > 1 && stamps[i - 1] - stamps[i - 2] <= kResent;
  }
  const bool alone = static_cast<double>(in_a_row) <= kMostInARow * static_cast<double>(close);
  const bool turns = others.empty() || medianOf(std::move(others)) <= kSlowestTurn;
  return alone && turns ? kResent : 0;
}

MessageClock clockOf(const std::vector<MessageTimes>& times) {
  MessageClock clock;
  clock.used.assign(times.size(), true);
  std::vector<Stamp> stamps, recorded;
  std::vector<double> leads;
  for (const MessageTimes& t : times) {
    if (!t.says()) {
      recorded.push_back(t.recorded);
      continue;
    }
    stamps.push_back(t.measured);
    leads.push_back(t.measured - t.recorded);
  }
  clock.unstamped = times.size() - stamps.size();
  clock.resent = resentWithin(stamps.empty() ? std::move(recorded) : stamps);
  if (stamps.empty()) return clock;
  const Selection selection(stamps);
  for (std::size_t i = 0, k = 0; i < times.size(); ++i) {
    if (!times[i].says()) continue;
    clock.used[i] = selection.uses()[k++];
    clock.left_out += !clock.used[i];
  }
  clock.farthest = selection.farthest();
  const auto [least, most] = std::minmax_element(leads.begin(), leads.end());
  if (*most - *least <= kSteadyLead) clock.lead = medianOf(std::move(leads));
  return clock;
}

void alignClocks(std::map<std::string, MessageClock>& clocks) {
  std::optional<double> least, most;
  for (const auto& row : clocks) {
    if (!row.second.lead) continue;
    least = std::min(least.value_or(*row.second.lead), *row.second.lead);
    most = std::max(most.value_or(*row.second.lead), *row.second.lead);
  }
  if (!least || *most - *least <= kSteadyLead) return;
  for (auto& row : clocks) {
    MessageClock& clock = row.second;
    if (clock.lead && (*clock.lead > kAhead || *clock.lead < -kBehind)) clock.shift = -*clock.lead;
  }
}

std::vector<std::string> faultsOf(const std::string& source, const MessageClock& clock) {
  std::vector<std::string> faults;
  if (clock.left_out > 0)
    faults.push_back(
        fmt::format("{}: the time of its messages jumps, by up to {:.3f} s: {} of {} left out",
                    source, clock.farthest, clock.left_out, clock.used.size()));
  if (clock.shift != 0)
    faults.push_back(fmt::format(
        "{}: its clock is {:.3f} s {} the recording's, and other clocks are not: its stamps are "
        "moved to the recording's time",
        source, std::abs(clock.shift), clock.shift < 0 ? "ahead of" : "behind"));
  return faults;
}

}  // namespace perception
