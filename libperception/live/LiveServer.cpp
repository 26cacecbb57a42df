#include "libperception/live/LiveServer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <chrono>
#include <csignal>
#include <exception>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/live/LiveSession.h"

namespace perception {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;

constexpr std::chrono::milliseconds kNone{0}, kLastWords{500};  // for what waits at the end
constexpr auto kPause = std::chrono::milliseconds(100);         // after a connection that failed
constexpr int kNice = 5;                                        // of the server's thread
constexpr int kSendBuffer = 1 << 18;  // [bytes] of the system, for a client

/// Drivers that are started later do not get it.
void keepToUs(int file) { ::fcntl(file, F_SETFD, FD_CLOEXEC); }

std::string nonce() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

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

}  // namespace

/// The server at work.
class LiveServer::Hub final : public LiveHost {
 public:
  explicit Hub(Params given);
  ~Hub() override { finish(); }

  void admitted(const std::shared_ptr<LiveSession>& session) override { sessions.insert(session); }
  void opened(const LiveSession& session) override {
    ++(session.isPage() ? totals.pages : totals.others);
    if (session.isPage()) ++pages;
  }
  void closed(const std::shared_ptr<LiveSession>& session) override {
    sessions.erase(session);
    if (session->isPage() && session->isOpen()) --pages;
    if (finishing && sessions.empty()) deadline.cancel();
  }
  void subscribed(int change) override { subscriptions += change; }
  void finish();

  std::size_t connections = 0;  // counted down by what the next one holds
  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  asio::steady_timer pause{io}, deadline{io};
  std::set<std::shared_ptr<LiveSession>> sessions;
  bool finishing = false;
  RequestRate rate;
  std::atomic<int> pages{0}, subscriptions{0};

 private:
  void listen();
  void accept();
  void run();
  std::thread thread_;
};

namespace {

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
    const std::string once = nonce();
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

LiveServer::Hub::Hub(Params given) : rate(given.limits.requests) {
  params = std::move(given);
  session = nonce();
  checkRules(params.access);
  listen();
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // signals are the run's own matter
  thread_ = std::thread([this] { run(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void LiveServer::Hub::listen() {
  const Tcp::endpoint at(asio::ip::make_address(params.access.address), params.port);
  try {
    acceptor.open(at.protocol());
    keepToUs(acceptor.native_handle());
    acceptor.set_option(Tcp::acceptor::reuse_address(true));
    acceptor.bind(at);
    acceptor.listen();
  } catch (const boost::system::system_error& fault) {
    throw Error(ExitCode::kUnavailable,
                fmt::format("--serve: {} port {}: {}", params.access.address, params.port,
                            fault.code().message()));
  }
  accept();
}

void LiveServer::Hub::accept() {
  acceptor.async_accept([this](beast::error_code fault, Tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (fault) {
      pause.expires_after(kPause);
      return pause.async_wait([this](beast::error_code stopped) {
        if (!stopped) accept();
      });
    }
    if (connections < params.limits.connections) {
      keepToUs(socket.native_handle());
      beast::error_code ignored;
      socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
      socket.set_option(Tcp::no_delay(true), ignored);
      ++connections;
      std::shared_ptr<void> counted(nullptr, [this](void*) { --connections; });
      const auto has_room = [this] { return sessions.size() < params.limits.clients; };
      std::make_shared<Visitor>(*this, std::move(socket), rate, has_room, std::move(counted))
          ->start();
    } else {
      ++totals.refused;
    }
    accept();
  });
}

void LiveServer::Hub::run() {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNice);
  for (;;) {
    try {
      io.run();
      return;
    } catch (const std::exception&) {
      ++totals.faults;  // told at the end; the run goes on
    }
  }
}

void LiveServer::Hub::finish() {
  if (!thread_.joinable()) return;
  asio::post(io, [this] {
    beast::error_code ignored;
    acceptor.close(ignored);
    pause.cancel();
    finishing = true;
    for (const auto& session : sessions) session->finish();
    deadline.expires_after(sessions.empty() ? kNone : kLastWords);
    deadline.async_wait([this](beast::error_code) {
      for (const auto& session : std::set(sessions)) session->end();
      io.stop();
    });
  });
  thread_.join();
}

LiveServer::LiveServer(Params params) : hub_(std::make_unique<Hub>(std::move(params))) {}
LiveServer::~LiveServer() { hub_->finish(); }

std::uint16_t LiveServer::port() const { return hub_->acceptor.local_endpoint().port(); }

std::string LiveServer::url() const {
  const std::string& address = hub_->params.access.address;
  const bool v6 = address.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/", v6 ? "[" : "", address, v6 ? "]" : "", port());
}

bool LiveServer::hasPages() const { return hub_->pages > 0; }
bool LiveServer::hasSubscribers() const { return hub_->subscriptions > 0; }
void LiveServer::post(std::function<void()> work) { asio::post(hub_->io, std::move(work)); }
void LiveServer::setGreeting(std::string text) { hub_->greeting = std::move(text); }

void LiveServer::sendToPages(const std::string& slot, std::shared_ptr<const std::string> payload,
                             bool binary) {
  for (const auto& session : hub_->sessions)
    if (session->isPage()) session->put({slot, "", payload, binary});
}

void LiveServer::addChannel(const foxglove::Channel& channel) {
  hub_->channels.push_back(channel);
  for (const auto& session : hub_->sessions)
    if (!session->isPage()) session->putText(foxglove::advertisement({channel}));
}

bool LiveServer::isSubscribed(std::uint32_t channel) const {
  return std::any_of(hub_->sessions.begin(), hub_->sessions.end(),
                     [&](const auto& session) { return session->isSubscribed(channel); });
}

void LiveServer::send(std::uint32_t channel, const std::string& slot, Stamp stamp,
                      std::shared_ptr<const std::string> payload) {
  for (const auto& session : hub_->sessions) session->putChannel(channel, slot, stamp, payload);
}

void LiveServer::finish() { hub_->finish(); }
LiveTotals LiveServer::totals() const { return hub_->totals; }

}  // namespace perception
