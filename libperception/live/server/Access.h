#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// Who may look at a live run.
struct AccessRules {
  std::string address = "127.0.0.1";  ///< on which the server listens
  std::string token;                  ///< of whoever asks; empty: none is needed
  std::vector<std::string> origins;   ///< pages that may connect beside our own: "https://HOST"
};

/// True for 127.0.0.0/8 and ::1.
bool isLoopback(const std::string& address);
/// The first line of a file: 16 to 128 letters, digits, - . _ ~. Throws DataError.
std::string readToken(const std::string& path);
/// Throws Error (kUsage) for an invalid address, and for one that others can reach without a token.
void checkRules(const AccessRules& rules);

/// Parts of a request that access depends on.
struct AccessRequest {
  std::string host;                   ///< header Host
  std::optional<std::string> origin;  ///< header Origin, which browsers send
  std::string target;                 ///< "/path?token=TOKEN"
  std::string authorization;          ///< header: "Bearer TOKEN"
};

/// Why a request is refused: a status of HTTP and a sentence.
struct Refusal {
  int status = 403;
  std::string reason;
};

/// A Host that is another name than this machine's is refused: it may be a page of another site
/// whose name now leads to our address (DNS rebinding). An Origin must be our own page or one of
/// the rules.
std::optional<Refusal> refusalOf(const AccessRules& rules, const AccessRequest& request);

/// "/path" of "/path?query".
std::string_view pathOf(std::string_view target);

}  // namespace perception
