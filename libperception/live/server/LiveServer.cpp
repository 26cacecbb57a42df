#include "libperception/live/server/LiveServer.h"

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
#include <boost/beast/core/error.hpp>
#include <chrono>
#include <csignal>
#include <exception>
#include <set>
#include <thread>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/live/server/LiveSession.h"
#include "libperception/live/server/LiveVisitor.h"

namespace perception {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Tcp = asio::ip::tcp;

constexpr std::chrono::milliseconds kNone{0}, kLastWords{500};  // for what waits at the end
constexpr auto kPause = std::chrono::milliseconds(100);         // after a connection that failed
constexpr int kNice = 5;                                        // of the server's thread
constexpr int kSendBuffer = 1 << 18;  // [bytes] of the system, for a client

/// Drivers that are started later do not get it.
void keepToUs(int file) { ::fcntl(file, F_SETFD, FD_CLOEXEC); }

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

LiveServer::Hub::Hub(Params given) : rate(given.limits.requests) {
  params = std::move(given);
  session = liveNonce();
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
      admitVisitor(*this, std::move(socket), rate, has_room, std::move(counted));
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
