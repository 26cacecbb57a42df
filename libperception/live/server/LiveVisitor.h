#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>
#include <string>

#include "libperception/live/server/LiveSession.h"

namespace perception {

/// Reads one HTTP request of a new connection and answers it: with the live page, with a refusal,
/// or with a LiveSession where the request is for a WebSocket and `has_room` says that one more
/// client fits. `counted` is held as long as the connection lives.
void admitVisitor(LiveHost& host, boost::asio::ip::tcp::socket socket, RequestRate& rate,
                  std::function<bool()> has_room, std::shared_ptr<void> counted);

/// 32 random hexadecimal digits.
std::string liveNonce();

}  // namespace perception
