#include "libperception/live/server/LiveSession.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace perception {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Clock = std::chrono::steady_clock;

bool RequestRate::allows() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  const std::int64_t second = std::chrono::duration_cast<std::chrono::seconds>(now).count();
  if (second != second_) count_ = 0;
  second_ = second;
  return ++count_ <= most_;
}

LiveSession::LiveSession(LiveHost& host, beast::tcp_stream stream, bool page,
                         std::shared_ptr<void> counted)
    : host_(host),
      stream_(std::move(stream)),
      page_(page),
      counted_(std::move(counted)),
      outbox_(host.params.limits.outbox),
      watch_(stream_.get_executor()),
      rate_(host.params.limits.requests) {}

void LiveSession::start(const Request& request, const std::string& protocol) {
  host_.admitted(shared_from_this());
  const LiveLimits& limits = host_.params.limits;
  const auto duration = [](double seconds) {
    return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
  };
  beast::get_lowest_layer(stream_).expires_never();  // the WebSocket has its own times
  websocket::stream_base::timeout times{};
  times.handshake_timeout = duration(limits.handshake);
  // Ours, see watch(): Beast's ends a client whose answer waits behind data that it reads slowly.
  times.idle_timeout = websocket::stream_base::none();
  stream_.set_option(times);
  stream_.set_option(
      websocket::stream_base::decorator([protocol](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, protocol);
      }));
  stream_.read_message_max(limits.message_bytes);
  stream_.auto_fragment(false);
  stream_.control_callback(
      [this](websocket::frame_type, beast::string_view) { sign_ = Clock::now(); });
  stream_.async_accept(request, [self = shared_from_this()](beast::error_code fault) {
    if (fault) return self->end();
    self->open_ = true;
    self->host_.opened(*self);
    if (self->page_) {
      if (!self->host_.greeting.empty()) self->putText(self->host_.greeting);
    } else {
      self->putText(foxglove::serverInfo(self->host_.params.name, self->host_.session));
      self->putText(foxglove::advertisement(self->host_.channels));
    }
    self->sign_ = Clock::now();
    self->watch();
    self->write();
    self->read();
  });
}

// A client is gone that has neither answered nor taken data for `silence`.
void LiveSession::watch() {
  const std::chrono::duration<double> most(host_.params.limits.silence);
  watch_.expires_after(std::chrono::duration_cast<Clock::duration>(most / 4));
  watch_.async_wait([self = shared_from_this(), most](beast::error_code fault) {
    if (fault || self->ended_) return;
    const auto silent = Clock::now() - self->sign_;
    if (silent > most) return self->end();
    if (silent > most / 4 && !self->pinging_ && !self->closing_) {
      self->pinging_ = true;
      self->stream_.async_ping({}, [self](beast::error_code) { self->pinging_ = false; });
    }
    self->watch();
  });
}

void LiveSession::read() {
  stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code fault, std::size_t) {
    if (fault) return self->end();
    self->sign_ = Clock::now();
    if (!self->rate_.allows())
      return self->close(websocket::close_code::policy_error, "too many messages");
    if (!self->stream_.got_text())
      return self->close(websocket::close_code::unknown_data, "nothing can be sent here");
    const std::string text = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    self->take(text);
    if (!self->closing_) self->read();
  });
}

void LiveSession::take(const std::string& text) {
  if (page_) return close(websocket::close_code::policy_error, "nothing can be sent here");
  try {
    obey(foxglove::requestOf(text));
  } catch (const std::invalid_argument& fault) {
    putText(foxglove::statusText(foxglove::Level::kError, fault.what()));
  }
}

void LiveSession::obey(const foxglove::Request& request) {
  for (const auto& [subscription, channel] : request.subscribe) {
    const std::size_t known = host_.channels.size();
    if (channel == 0 || channel > known || isSubscribed(channel) ||
        subscriptions_.size() >= host_.params.limits.subscriptions) {
      putText(foxglove::statusText(
          foxglove::Level::kError,
          "channel " + std::to_string(channel) + ": unknown, subscribed already, or too many"));
      continue;
    }
    subscriptions_[channel] = subscription;
    host_.subscribed(1);
  }
  for (const std::uint32_t subscription : request.unsubscribe) {
    for (auto s = subscriptions_.begin(); s != subscriptions_.end();) {
      if (s->second != subscription) {
        ++s;
        continue;
      }
      s = subscriptions_.erase(s);
      host_.subscribed(-1);
    }
  }
}

void LiveSession::putText(const std::string& text) {
  put({"", "", std::make_shared<const std::string>(text), false});
}

void LiveSession::putChannel(std::uint32_t channel, const std::string& slot, Stamp stamp,
                             const std::shared_ptr<const std::string>& payload) {
  const auto known = subscriptions_.find(channel);
  if (known != subscriptions_.end())
    put({slot, foxglove::messageHead(known->second, stamp), payload, true});
}

void LiveSession::put(LiveMessage message) {
  if (!open_ || closing_) return;
  outbox_.put(std::move(message));
  write();
}

void LiveSession::write() {
  if (writing_ || closing_ || !open_) return;
  auto next = outbox_.take();
  if (!next) {
    if (finishing_) close(websocket::close_code::going_away, "the run has ended");
    return;
  }
  current_ = std::move(*next);
  writing_ = true;
  stream_.binary(current_.binary);
  const std::array<asio::const_buffer, 2> parts{asio::buffer(current_.head),
                                                asio::buffer(*current_.payload)};
  stream_.async_write(parts, [self = shared_from_this()](beast::error_code fault, std::size_t) {
    self->writing_ = false;
    if (fault) return self->end();
    self->sign_ = Clock::now();
    ++self->host_.totals.sent;
    self->write();
  });
}

void LiveSession::finish() {
  finishing_ = true;
  if (open_ && !writing_) write();
}

void LiveSession::close(websocket::close_code code, const std::string& reason) {
  if (closing_) return;
  closing_ = true;
  stream_.async_close({code, reason},
                      [self = shared_from_this()](beast::error_code) { self->end(); });
}

void LiveSession::end() {
  if (ended_) return;
  ended_ = closing_ = true;
  watch_.cancel();
  beast::get_lowest_layer(stream_).close();
  host_.totals.dropped += outbox_.dropped();
  host_.subscribed(-static_cast<int>(subscriptions_.size()));
  subscriptions_.clear();
  host_.closed(shared_from_this());
}

}  // namespace perception
