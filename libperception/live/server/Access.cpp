#include "libperception/live/server/Access.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <cctype>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/core/LowerCase.h"

namespace perception {
namespace {

constexpr std::size_t kShortestToken = 16, kLongestToken = 128;

std::optional<boost::asio::ip::address> addressOf(const std::string& text) {
  boost::system::error_code fault;
  const auto address = boost::asio::ip::make_address(text, fault);
  if (fault) return std::nullopt;
  return address;
}

/// The name in "name", "name:port", "[address]:port"; empty if it is none of them.
std::string nameIn(const std::string& host) {
  const bool bracket = !host.empty() && host[0] == '[';
  const std::size_t end = bracket ? host.find(']') : host.find(':');
  if (bracket && end == std::string::npos) return "";
  const std::string name = bracket ? host.substr(1, end - 1) : host.substr(0, end);
  const std::string rest = end == std::string::npos ? "" : host.substr(end + (bracket ? 1 : 0));
  const bool port = rest.empty() || (rest.size() > 1 && rest[0] == ':' &&
                                     std::all_of(rest.begin() + 1, rest.end(), [](unsigned char c) {
                                       return std::isdigit(c) != 0;
                                     }));
  return port ? lowerCase(name) : "";
}

std::string machineName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? lowerCase(name.data()) : "";
}

bool isOurName(const AccessRules& rules, const std::string& name) {
  if (name == "localhost" || isLoopback(name)) return true;
  if (name.empty() || isLoopback(rules.address)) return false;
  return addressOf(name).has_value() || name == machineName();
}

/// Takes as long whatever the letters are.
bool isSame(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs = static_cast<unsigned char>(differs | (a[i] ^ b[i]));
  return differs == 0;
}

std::string_view tokenIn(const AccessRequest& request) {
  constexpr std::string_view kBearer = "Bearer ", kKey = "token=";
  const std::string_view authorization = request.authorization;
  if (authorization.substr(0, kBearer.size()) == kBearer)
    return authorization.substr(kBearer.size());
  std::string_view query = request.target;
  query.remove_prefix(std::min(pathOf(query).size() + 1, query.size()));
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.substr(0, kKey.size()) == kKey) return part.substr(kKey.size());
    query.remove_prefix(std::min(part.size() + 1, query.size()));
  }
  return {};
}

}  // namespace

bool isLoopback(const std::string& address) {
  const auto parsed = addressOf(address);
  return parsed && parsed->is_loopback();
}

std::string readToken(const std::string& path) {
  std::ifstream in(path);
  std::string token;
  if (!in || !std::getline(in, token))
    throw DataError(path + ": no token can be read", ExitCode::kNoInput);
  const auto fits = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_' || c == '~';
  };
  if (token.size() < kShortestToken || token.size() > kLongestToken ||
      !std::all_of(token.begin(), token.end(), fits)) {
    throw DataError(fmt::format("{}: line 1: a token has {} to {} letters, digits, - . _ ~", path,
                                kShortestToken, kLongestToken));
  }
  return token;
}

void checkRules(const AccessRules& rules) {
  if (!addressOf(rules.address))
    throw Error(ExitCode::kUsage,
                "--serve-address '" + rules.address + "': expected an address, as 127.0.0.1");
  if (!isLoopback(rules.address) && rules.token.empty())
    throw Error(ExitCode::kUsage,
                "--serve-address " + rules.address + ": others reach it; needs --serve-token FILE");
}

std::string_view pathOf(std::string_view target) { return target.substr(0, target.find('?')); }

std::optional<Refusal> refusalOf(const AccessRules& rules, const AccessRequest& request) {
  if (!isOurName(rules, nameIn(request.host)))
    return Refusal{403, "the header Host names another machine"};
  if (request.origin && lowerCase(*request.origin) != "http://" + lowerCase(request.host) &&
      std::find(rules.origins.begin(), rules.origins.end(), *request.origin) == rules.origins.end())
    return Refusal{403, "pages of this origin may not connect (--serve-origin)"};
  if (!rules.token.empty() && !isSame(tokenIn(request), rules.token))
    return Refusal{401, "a token is needed: ?token=TOKEN"};
  return std::nullopt;
}

}  // namespace perception
