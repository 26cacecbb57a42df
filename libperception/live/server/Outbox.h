#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace perception {

/// A message that waits for one client.
struct LiveMessage {
  std::string slot;                            ///< a newer one of the same slot replaces it
  std::string head;                            ///< bytes before the payload, of this client alone
  std::shared_ptr<const std::string> payload;  ///< shared by all clients
  bool binary = false;
};

/// Messages that wait for a client. Of each slot only the newest one waits, at the place of the one
/// that it replaces, so that each slot has its turn. Messages without a slot all wait, up to the
/// bounds; beyond them the oldest is dropped. A slow client thus gets the newest scene, and its
/// memory is bounded.
class Outbox {
 public:
  struct Bounds {
    std::size_t messages = 256;
    std::size_t bytes = 64 << 20;  ///< of payloads
  };
  Outbox() : Outbox(Bounds()) {}
  explicit Outbox(Bounds bounds) : bounds_(bounds) {}

  void put(LiveMessage message);
  std::optional<LiveMessage> take();
  bool isEmpty() const { return waiting_.empty(); }
  std::uint64_t dropped() const { return dropped_; }  ///< replaced or beyond the bounds

 private:
  void keepBounds();

  Bounds bounds_;
  std::deque<LiveMessage> waiting_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace perception
