// Devices that cannot be had, or go: named at the start, or in the ledger of the capture.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libperception/capture/Grabber.h"
#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

class Connections : public testing::Test {
 protected:
  std::string ini(const std::string& keys, const std::string& label) const {
    const std::string path = folder_ / "capture.ini";
    std::ofstream(path) << "[global]\n[" << label
                        << "]\ndriver = CPacketSensor\nsensorLabel = " << label << "\n"
                        << keys;
    return path;
  }

  /// What the capture could not even begin for.
  std::pair<ExitCode, std::string> refusal(const std::string& keys) const {
    try {
      Grabber grabber(ini(keys, "A"), {folder_ / "refused", "", {}});
    } catch (const Error& error) {
      return {error.code(), error.what()};
    }
    return {ExitCode::kOk, ""};
  }

  /// The events of a short capture.
  std::string events(const std::string& keys, const std::string& label = "A") const {
    Grabber grabber(ini(keys, label), {folder_ / "out", "", {}});
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(800);
    grabber.run([&] { return std::chrono::steady_clock::now() > end; }, [] {});
    std::ifstream file(folder_ / "out/capture.jsonl");
    for (std::string line; std::getline(file, line);) {
      const auto json = nlohmann::json::parse(line);
      if (json.contains("sensor")) return json["events"].dump();
    }
    return "";
  }

  const test::TemporaryFolder folder_;
};

TEST_F(Connections, AUdpPortInUseIsNamed) {
  const int taken = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(42391);
  ASSERT_EQ(::bind(taken, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  const auto [code, said] = refusal("device = xt32\nport = 42391\n");
  ::close(taken);
  EXPECT_EQ(code, ExitCode::kUnavailable);
  EXPECT_NE(said.find("[A] UDP port 42391: Address already in use"), std::string::npos) << said;
}

TEST_F(Connections, ACanInterfaceThatIsNotThereIsNamed) {
  const auto [code, said] = refusal("device = esr\ninterface = nosuch0\n");
  EXPECT_EQ(code, ExitCode::kUnavailable);
  EXPECT_NE(said.find("[A] CAN interface nosuch0: "), std::string::npos) << said;
}

TEST_F(Connections, ATcpDeviceThatDoesNotAnswerIsNamedOnce) {
  const std::string said = events("device = ibeo\nhost = 127.0.0.1\nport = 42392\n");
  const std::string event = "127.0.0.1:42392 does not answer";
  const std::size_t at = said.find(event);
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find(event, at + 1), std::string::npos) << said;
}

TEST_F(Connections, ASimulatorThatCannotGoOnSaysWhy) {
  const std::string said = events(
      "device = ars548\nport = 42393\npose_x = 9\nstart_delay = 0.1\nscenario "
      "= " PERCEPTION_SOURCE_DIR "/ini/scenarios/devices.ini\n",
      "ARS548");
  EXPECT_NE(said.find("its simulator: [ARS548] pose_x ... are not those of"), std::string::npos)
      << said;
}

}  // namespace
}  // namespace perception
