#include "libperception/live/server/LiveVisitor.h"

#include <fmt/format.h>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <cstdint>
#include <random>
#include <utility>

#include "libperception/live/FoxgloveProtocol.h"
#include "libperception/live/server/Access.h"

namespace perception {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = boost::asio::ip::tcp;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

http::response<http::string_body> answerOf(int status, std::string body, const char* type) {
  http::response<http::string_body> answer{static_cast<http::status>(status), 11};
  answer.set(http::field::content_type, type);
  answer.set(http::field::cache_control, "no-store");
  answer.set("X-Content-Type-Options", "nosniff");
  answer.set("X-Frame-Options", "DENY");
  answer.set("Referrer-Policy", "no-referrer");
  answer.set("Cross-Origin-Resource-Policy", "same-origin");
  answer.keep_alive(false);
  answer.body() = std::move(body);
  answer.prepare_payload();
  return answer;
}

/// One connection until it has been answered or has become a WebSocket.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(LiveHost& host, Tcp::socket socket, RequestRate& rate, std::function<bool()> has_room,
          std::shared_ptr<void> counted)
      : host_(host),
        stream_(std::move(socket)),
        rate_(rate),
        has_room_(std::move(has_room)),
        counted_(std::move(counted)) {
    parser_.header_limit(static_cast<std::uint32_t>(host.params.limits.header_bytes));
    parser_.body_limit(0);
  }

  void start() {
    stream_.expires_after(
        std::chrono::milliseconds(static_cast<int>(host_.params.limits.handshake * 1e3)));
    http::async_read(
        stream_, buffer_, parser_,
        [self = shared_from_this()](beast::error_code fault, std::size_t) { self->take(fault); });
  }

 private:
  void take(beast::error_code fault) {
    static const beast::error_code gone = http::error::end_of_stream;
    if (fault && fault != gone && fault.category() == gone.category())
      return refuse(400, "this is no request");
    if (fault) return;  // gone, or too slow
    const auto& request = parser_.get();
    if (const auto why = refusalOf(host_.params.access, accessOf(request)))
      return refuse(why->status, why->reason);
    if (!rate_.allows()) return refuse(429, "too many requests");
    if (request.method() != http::verb::get) return refuse(405, "only GET");
    const auto target = request.target();
    if (pathOf({target.data(), target.size()}) != "/") return refuse(404, "only / is here");
    if (websocket::is_upgrade(request)) return connect(request);
    const std::string once = liveNonce();
    auto answer =
        answerOf(200, replaced(host_.params.page, "{NONCE}", once), "text/html; charset=utf-8");
    answer.set("Content-Security-Policy",
               fmt::format("default-src 'none'; script-src 'nonce-{}'; style-src 'unsafe-inline'; "
                           "img-src data: blob:; connect-src 'self'; base-uri 'none'; "
                           "form-action 'none'; frame-ancestors 'none'",
                           once));
    send(std::move(answer));
  }

  static AccessRequest accessOf(const LiveSession::Request& request) {
    AccessRequest access;
    access.host = std::string(request[http::field::host]);
    access.target = std::string(request.target());
    access.authorization = std::string(request[http::field::authorization]);
    if (request.count(http::field::host) != 1) access.host.clear();
    const auto origin = request.find(http::field::origin);
    if (origin != request.end()) access.origin = std::string(origin->value());
    return access;
  }

  void connect(const LiveSession::Request& request) {
    const std::string offered(request[http::field::sec_websocket_protocol]);
    const bool page = offered == kPageProtocol;
    const auto spoken = page ? offered : foxglove::chosenProtocol(offered);
    if (!spoken) return refuse(400, "subprotocol: foxglove.sdk.v1 or foxglove.websocket.v1");
    if (!has_room_()) return refuse(503, "too many clients");
    const auto session = std::make_shared<LiveSession>(host_, std::move(stream_), page, counted_);
    session->start(request, *spoken);
  }

  void refuse(int status, const std::string& reason) {
    ++host_.totals.refused;
    send(answerOf(status, reason + "\n", "text/plain; charset=utf-8"));
  }

  void send(http::response<http::string_body> answer) {
    answer_ = std::move(answer);
    http::async_write(stream_, answer_,
                      [self = shared_from_this()](beast::error_code, std::size_t) {
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
                      });
  }

  LiveHost& host_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> answer_;
  RequestRate& rate_;
  std::function<bool()> has_room_;
  std::shared_ptr<void> counted_;
};

}  // namespace

void admitVisitor(LiveHost& host, Tcp::socket socket, RequestRate& rate,
                  std::function<bool()> has_room, std::shared_ptr<void> counted) {
  std::make_shared<Visitor>(host, std::move(socket), rate, std::move(has_room), std::move(counted))
      ->start();
}

std::string liveNonce() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

}  // namespace perception
