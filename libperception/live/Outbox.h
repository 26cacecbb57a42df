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

/// What waits for a client: of each slot the newest message, in the place of the one that it
/// replaces, so that each slot has its turn; of those without a slot
/// all, as far as the bounds allow; beyond them the oldest is dropped. So a client that reads
/// slowly gets the newest scene and costs no more memory.
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
