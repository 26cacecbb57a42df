#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/live/server/LiveServer.h"

namespace perception {

class LiveSession;

/// Requests within this second, bounded.
class RequestRate {
 public:
  explicit RequestRate(std::size_t most) : most_(most) {}
  bool allows();

 private:
  std::size_t most_, count_ = 0;
  std::int64_t second_ = 0;
};

/// What sessions need of their server.
struct LiveHost {
  virtual ~LiveHost() = default;
  virtual void admitted(const std::shared_ptr<LiveSession>& session) = 0;
  virtual void opened(const LiveSession& session) = 0;
  virtual void closed(const std::shared_ptr<LiveSession>& session) = 0;
  virtual void subscribed(int change) = 0;
  LiveServer::Params params;
  std::string greeting;  ///< of pages
  std::string session;   ///< by which clients tell this run from the next one
  std::vector<foxglove::Channel> channels;
  LiveTotals totals;
};

/// The WebSocket of one client.
class LiveSession : public std::enable_shared_from_this<LiveSession> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  /// `counted` is held as long as the session lives.
  LiveSession(LiveHost& host, boost::beast::tcp_stream stream, bool page,
              std::shared_ptr<void> counted);
  /// Answers the request for a WebSocket of `protocol`.
  void start(const Request& request, const std::string& protocol);

  bool isPage() const { return page_; }
  bool isOpen() const { return open_; }  ///< the handshake is done
  void put(LiveMessage message);
  void putText(const std::string& text);
  bool isSubscribed(std::uint32_t channel) const { return subscriptions_.count(channel) > 0; }
  /// To the client's subscription of the channel.
  void putChannel(std::uint32_t channel, const std::string& slot, Stamp stamp,
                  const std::shared_ptr<const std::string>& payload);
  void finish();  ///< closes when nothing waits any more
  void end();     ///< closes at once

 private:
  void read();
  void take(const std::string& text);
  void obey(const foxglove::Request& request);
  void write();
  void watch();
  void close(boost::beast::websocket::close_code code, const std::string& reason);

  LiveHost& host_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  boost::beast::flat_buffer buffer_;
  const bool page_;
  const std::shared_ptr<void> counted_;
  bool open_ = false, writing_ = false, closing_ = false, finishing_ = false, ended_ = false;
  bool pinging_ = false;
  Outbox outbox_;
  LiveMessage current_;  ///< that is being written
  boost::asio::steady_timer watch_;
  std::chrono::steady_clock::time_point sign_;  ///< of life, the last one: it answered or took data
  RequestRate rate_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  ///< by channel
};

}  // namespace perception
