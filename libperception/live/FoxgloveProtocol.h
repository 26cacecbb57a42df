#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/interop/bags/McapWriter.h"

/// Foxglove's WebSocket protocol, subprotocols foxglove.sdk.v1 and foxglove.websocket.v1
/// (https://github.com/foxglove/ws-protocol): what a server that only sends needs of it.
namespace perception::foxglove {

/// A topic whose messages are JSON.
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  McapWriter::Schema schema;
};

/// The first of the offered names (header Sec-WebSocket-Protocol) that is spoken here.
std::optional<std::string> chosenProtocol(std::string_view offered);

enum class Level { kInfo = 0, kWarning = 1, kError = 2 };

// Texts of the server.
std::string serverInfo(const std::string& name, const std::string& session);
std::string advertisement(const std::vector<Channel>& channels);
std::string statusText(Level level, const std::string& message);

/// What comes before the payload of a binary message: opcode 1, subscription, time [ns].
std::string messageHead(std::uint32_t subscription, Stamp stamp);

/// What a client asks for.
struct Request {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscribe;  ///< subscription, channel
  std::vector<std::uint32_t> unsubscribe;                          ///< subscriptions
};
/// Throws std::invalid_argument that says what is wrong, also for what a server that only sends
/// does not do.
Request requestOf(std::string_view text);

}  // namespace perception::foxglove
