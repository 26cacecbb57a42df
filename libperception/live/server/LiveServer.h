#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "libperception/core/Time.h"
#include "libperception/live/FoxgloveProtocol.h"
#include "libperception/live/server/Access.h"
#include "libperception/live/server/Outbox.h"

namespace perception {

/// Bounds of what clients can ask for.
struct LiveLimits {
  std::size_t clients = 16;             ///< WebSockets at once
  std::size_t connections = 48;         ///< of any kind at once
  std::size_t requests = 64;            ///< requests and messages of clients a second
  std::size_t message_bytes = 1 << 16;  ///< of a message of a client
  std::size_t header_bytes = 1 << 13;   ///< of a request
  std::size_t subscriptions = 256;      ///< of a client
  Outbox::Bounds outbox;
  double handshake = 10;  ///< [s] within which a request must be whole
  double silence = 60;    ///< [s] after which a client that neither answers nor takes data is gone
};

/// What a server did.
struct LiveTotals {
  std::uint64_t pages = 0, others = 0;  ///< clients by our own page, by Foxglove's protocol
  std::uint64_t refused = 0;            ///< requests and connections
  std::uint64_t sent = 0, dropped = 0;  ///< messages
  std::uint64_t faults = 0;             ///< that were caught: bugs
};

/// HTTP and WebSocket on one port, on a thread of its own of low priority: GET / is the live page,
/// a WebSocket there is the page's or one of Foxglove's protocol. Nothing can be changed through
/// it. A client that reads slowly gets the newest of each slot (Outbox).
class LiveServer {
 public:
  struct Params {
    AccessRules access;
    std::uint16_t port = 0;  ///< 0: the system chooses
    std::string name;        ///< of the run, for clients
    std::string page;        ///< HTML; "{NONCE}" in it becomes that of its scripts
    LiveLimits limits;
  };
  /// Listens from now on. Throws Error: kUsage for the rules, kUnavailable for the port.
  explicit LiveServer(Params params);
  ~LiveServer();  ///< finish()
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  std::uint16_t port() const;
  std::string url() const;  ///< of the page, without token
  /// Whether there is a viewer: a page or a subscriber. Any thread may call; the call does not
  /// wait.
  bool hasPages() const;
  bool hasSubscribers() const;
  /// Runs `work` on the server's thread. The next four may be called only there.
  void post(std::function<void()> work);

  /// Sent to each page that connects from now on.
  void setGreeting(std::string text);
  void sendToPages(const std::string& slot, std::shared_ptr<const std::string> payload,
                   bool binary);
  void addChannel(const foxglove::Channel& channel);
  bool isSubscribed(std::uint32_t channel) const;
  void send(std::uint32_t channel, const std::string& slot, Stamp stamp,
            std::shared_ptr<const std::string> payload);

  /// Sends what waits, for half a second at most, and closes. A second call has no effect.
  void finish();
  LiveTotals totals() const;  ///< after finish()

 private:
  class Hub;
  std::unique_ptr<Hub> hub_;
};

/// Subprotocol of the live page's WebSocket.
inline constexpr char kPageProtocol[] = "perception.live.v1";

}  // namespace perception
