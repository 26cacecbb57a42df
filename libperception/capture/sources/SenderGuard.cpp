#include "libperception/capture/sources/SenderGuard.h"

#include <utility>

#include "libperception/capture/sources/PacketSource.h"

namespace perception {

bool SenderGuard::passes(std::uint64_t sender, Stamp at) {
  if (sender_ && sender != *sender_) {
    if (at - last_ <= kSilence) {
      ++refused_;
      if (refused_sender_ != sender)
        event_ = "a second sender, " + senderName(sender) + ", is refused: packets come from " +
                 senderName(*sender_);
      refused_sender_ = sender;
      return false;
    }
    event_ =
        "packets come from " + senderName(sender) + " now, no longer from " + senderName(*sender_);
    refused_sender_.reset();
  }
  sender_ = sender;
  last_ = at;
  return true;
}

std::optional<std::string> SenderGuard::takeEvent() { return std::exchange(event_, {}); }

}  // namespace perception
