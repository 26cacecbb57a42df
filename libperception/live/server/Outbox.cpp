#include "libperception/live/server/Outbox.h"

#include <algorithm>
#include <utility>

namespace perception {

void Outbox::put(LiveMessage message) {
  if (!message.slot.empty()) {
    const auto older = std::find_if(waiting_.begin(), waiting_.end(),
                                    [&](const LiveMessage& m) { return m.slot == message.slot; });
    if (older != waiting_.end()) {
      // In its place: what comes often would else never have its turn.
      bytes_ = bytes_ - older->payload->size() + message.payload->size();
      *older = std::move(message);
      ++dropped_;
      return keepBounds();
    }
  }
  bytes_ += message.payload->size();
  waiting_.push_back(std::move(message));
  keepBounds();
}

void Outbox::keepBounds() {
  while (waiting_.size() > bounds_.messages || (bytes_ > bounds_.bytes && waiting_.size() > 1)) {
    bytes_ -= waiting_.front().payload->size();
    waiting_.pop_front();
    ++dropped_;
  }
}

std::optional<LiveMessage> Outbox::take() {
  if (waiting_.empty()) return std::nullopt;
  LiveMessage message = std::move(waiting_.front());
  waiting_.pop_front();
  bytes_ -= message.payload->size();
  return message;
}

}  // namespace perception
