#include "tests/support/Browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

extern char** environ;

namespace perception::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kPatience = 60'000;  // [ms]

std::string decodedBase64(const std::string& text) {
  std::string out;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    const std::string all = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto at = all.find(c);
    if (at == std::string::npos) break;
    bits = bits << 6 | static_cast<unsigned>(at);
    if ((count += 6) >= 8) out += static_cast<char>(bits >> (count -= 8) & 255U);
  }
  return out;
}

}  // namespace

std::string Browser::program() {
  const char* named = std::getenv("CHROMIUM");
  const std::string path = named ? named : "/usr/bin/chromium";
  return ::access(path.c_str(), X_OK) == 0 ? path : "";
}

Browser::Browser() {
  int in[2], out[2];
  if (::pipe2(in, O_CLOEXEC) != 0 || ::pipe2(out, O_CLOEXEC) != 0)
    throw std::runtime_error("no pipes");
  // Chromium reads 3 and writes 4; copies above both, so that none is in the other's way.
  const int theirs_in = ::fcntl(in[0], F_DUPFD_CLOEXEC, 10);
  const int theirs_out = ::fcntl(out[1], F_DUPFD_CLOEXEC, 10);
  to_ = ::fcntl(in[1], F_DUPFD_CLOEXEC, 10);
  from_ = ::fcntl(out[0], F_DUPFD_CLOEXEC, 10);
  for (const int fd : {in[0], in[1], out[0], out[1]}) ::close(fd);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, theirs_in, 3);
  ::posix_spawn_file_actions_adddup2(&actions, theirs_out, 4);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<std::string> words = {program(),
                                    "--headless=new",
                                    "--no-sandbox",
                                    "--no-first-run",
                                    "--disable-extensions",
                                    "--disable-background-networking",
                                    "--disable-dev-shm-usage",
                                    "--use-gl=angle",
                                    "--use-angle=swiftshader",
                                    "--enable-unsafe-swiftshader",
                                    "--remote-debugging-pipe",
                                    "--user-data-dir=" + profile_.path(),
                                    "about:blank"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed =
      ::posix_spawn(&process_, words.front().c_str(), &actions, &attributes, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  ::close(theirs_in);
  ::close(theirs_out);
  if (failed) throw std::runtime_error("chromium does not start");
  ::signal(SIGPIPE, SIG_IGN);
  const Json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ = call("Target.attachToTarget", {{"targetId", target["targetId"]}, {"flatten", true}})
                 .at("sessionId");
  for (const char* domain : {"Page", "Runtime", "Network", "Log"})
    call(std::string(domain) + ".enable");
  call("Network.emulateNetworkConditions",
       {{"offline", true}, {"latency", 0}, {"downloadThroughput", -1}, {"uploadThroughput", -1}});
}

Browser::~Browser() {
  if (process_ > 0) {
    ::kill(-process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  for (const int fd : {to_, from_}) {
    if (fd >= 0) ::close(fd);
  }
  // Its helpers write into the profile until they are gone.
  for (int i = 0; i < 100 && ::kill(-process_, 0) == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

Json Browser::next() {
  std::size_t end = 0;
  while ((end = unread_.find('\0')) == std::string::npos) {
    pollfd ready = {from_, POLLIN, 0};
    char part[65536];
    ssize_t got = 0;
    if (::poll(&ready, 1, kPatience) <= 0 || (got = ::read(from_, part, sizeof part)) <= 0)
      throw std::runtime_error("chromium does not answer");
    unread_.append(part, static_cast<std::size_t>(got));
  }
  const Json message = Json::parse(unread_.substr(0, end));
  unread_.erase(0, end + 1);
  return message;
}

void Browser::note(const Json& event) {
  const std::string method = event.value("method", "");
  const Json params = event.value("params", Json::object());
  if (method == "Runtime.exceptionThrown") faults_.push_back(params.dump());
  if (method == "Runtime.consoleAPICalled" && params.value("type", "") == "error")
    faults_.push_back(params.dump());
  if (method == "Log.entryAdded" && params.at("entry").value("level", "") == "error")
    faults_.push_back(params.dump());
  if (method == "Network.requestWillBeSent") {
    const std::string url = params.at("request").at("url");
    if (url.rfind("http", 0) == 0) requests_.push_back(url);
  }
}

Json Browser::call(const std::string& method, Json params) {
  Json request = {{"id", ++calls_}, {"method", method}, {"params", std::move(params)}};
  if (!session_.empty()) request["sessionId"] = session_;
  const std::string text = request.dump() + '\0';
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(to_, text.data() + done, text.size() - done);
    if (n <= 0) throw std::runtime_error("chromium does not listen");
    done += static_cast<std::size_t>(n);
  }
  while (true) {
    const Json message = next();
    if (message.value("id", 0) != calls_) {
      note(message);
      continue;
    }
    if (message.contains("error")) throw std::runtime_error(method + ": " + message.dump());
    return message.value("result", Json::object());
  }
}

void Browser::resize(int width, int height) {
  const bool phone = width < 600;
  width_ = width;
  call("Emulation.setDeviceMetricsOverride", {{"width", width},
                                              {"height", height},
                                              {"deviceScaleFactor", phone ? 2 : 1},
                                              {"mobile", phone}});
}

void Browser::open(const std::string& file) {
  call("Page.navigate", {{"url", "about:blank"}});
  faults_.clear();
  requests_.clear();
  const Json answer = call("Page.navigate", {{"url", "file://" + fs::absolute(file).string()}});
  if (answer.contains("errorText")) throw std::runtime_error(file + ": " + answer.dump());
  waitFor("document.readyState === 'complete' && location.protocol === 'file:'");
}

Json Browser::value(const std::string& expression) {
  const Json answer =
      call("Runtime.evaluate",
           {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (answer.contains("exceptionDetails"))
    throw std::runtime_error(expression + ": " + answer["exceptionDetails"].dump());
  return answer.at("result").value("value", Json());
}

void Browser::waitFor(const std::string& expression) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatience);
  while (value(expression) != true) {
    if (std::chrono::steady_clock::now() > until)
      throw std::runtime_error("waited in vain for " + expression);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void Browser::drag(double x0, double y0, double x1, double y1) {
  const auto mouse = [&](const char* type, double x, double y, int buttons) {
    call("Input.dispatchMouseEvent",
         {{"type", type},
          {"x", x},
          {"y", y},
          {"button", buttons || std::string(type) == "mouseReleased" ? "left" : "none"},
          {"buttons", buttons},
          {"clickCount", 1}});
  };
  mouse("mouseMoved", x0, y0, 0);
  mouse("mousePressed", x0, y0, 1);
  constexpr int kSteps = 8;
  for (int i = 1; i <= kSteps && (x0 != x1 || y0 != y1); ++i)
    mouse("mouseMoved", x0 + (x1 - x0) * i / kSteps, y0 + (y1 - y0) * i / kSteps, 1);
  mouse("mouseReleased", x1, y1, 0);
}

void Browser::press(const std::string& key) {
  Json down = {{"type", "keyDown"}, {"key", key}};
  if (key.size() == 1) down["text"] = key;
  call("Input.dispatchKeyEvent", down);
  call("Input.dispatchKeyEvent", {{"type", "keyUp"}, {"key", key}});
}

void Browser::screenshot(const std::string& path) {
  value("window.scrollTo(0, 0)");
  const Json size = call("Page.getLayoutMetrics").at("cssContentSize");
  const Json answer = call(
      "Page.captureScreenshot",
      {{"captureBeyondViewport", true},
       {"clip",
        {{"x", 0}, {"y", 0}, {"width", width_}, {"height", size.at("height")}, {"scale", 1}}}});
  std::ofstream(path, std::ios::binary) << decodedBase64(answer.at("data"));
}

}  // namespace perception::test
