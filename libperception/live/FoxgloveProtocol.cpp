#include "libperception/live/FoxgloveProtocol.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace perception::foxglove {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kSpoken[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr char kMessageData = 1;  // opcode

std::string textOf(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void putLittle(std::string& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>(value >> (8 * i) & 255);
}

std::uint32_t idOf(const Json& value, const char* name) {
  if (!value.is_number_unsigned() ||
      value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument(std::string(name) + ": expected a number of 32 bits");
  return value.get<std::uint32_t>();
}

const Json& listOf(const Json& message, const char* name) {
  const auto list = message.find(name);
  if (list == message.end() || !list->is_array())
    throw std::invalid_argument(std::string(name) + ": expected a list");
  return *list;
}

}  // namespace

std::optional<std::string> chosenProtocol(std::string_view offered) {
  while (!offered.empty()) {
    std::string_view name = offered.substr(0, offered.find(','));
    offered.remove_prefix(std::min(name.size() + 1, offered.size()));
    while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
    while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
    if (std::find(std::begin(kSpoken), std::end(kSpoken), name) != std::end(kSpoken))
      return std::string(name);
  }
  return std::nullopt;
}

std::string serverInfo(const std::string& name, const std::string& session) {
  return textOf({{"op", "serverInfo"},
                 {"name", name},
                 {"capabilities", Json::array()},
                 {"supportedEncodings", Json::array()},
                 {"metadata", Json::object()},
                 {"sessionId", session}});
}

std::string advertisement(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "json"},
                    {"schemaName", channel.schema.name},
                    {"schemaEncoding", channel.schema.encoding},
                    {"schema", channel.schema.text}});
  }
  return textOf({{"op", "advertise"}, {"channels", list}});
}

std::string statusText(Level level, const std::string& message) {
  return textOf({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string messageHead(std::uint32_t subscription, Stamp stamp) {
  std::string head(1, kMessageData);
  putLittle(head, subscription, 4);
  putLittle(head, static_cast<std::uint64_t>(stamp.ns), 8);
  return head;
}

Request requestOf(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) throw std::invalid_argument("expected a JSON object");
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string()) throw std::invalid_argument("op: expected a text");
  Request request;
  if (*op == "subscribe") {
    for (const Json& s : listOf(message, "subscriptions")) {
      if (!s.is_object() || !s.contains("id") || !s.contains("channelId"))
        throw std::invalid_argument("subscriptions: expected id and channelId");
      request.subscribe.emplace_back(idOf(s["id"], "id"), idOf(s["channelId"], "channelId"));
    }
  } else if (*op == "unsubscribe") {
    for (const Json& id : listOf(message, "subscriptionIds"))
      request.unsubscribe.push_back(idOf(id, "subscriptionIds"));
  } else {
    throw std::invalid_argument("op: only subscribe and unsubscribe; nothing can be changed here");
  }
  return request;
}

}  // namespace perception::foxglove
