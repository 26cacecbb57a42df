// Packets of a simulated device through driver and recorder, to the packet.
#include "libperception/capture/drivers/CPacketSensor.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "libperception/capture/Grabber.h"
#include "libperception/core/Error.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
constexpr int kPackets = 2000;

void put(std::string& bytes, std::size_t at, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i)
    bytes[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> 8 * i);
}

/// A packet of an XT32 that turns ten times in 2000 packets; each channel sees a wall at 10 m.
std::string xt32Packet(int number) {
  std::string bytes(1080, '\0');
  bytes.replace(0, 12, std::string("\xEE\xFF\6\1\0\0\x20\x08\1\4\1\1", 12));
  for (std::size_t b = 0; b < 8; ++b) {
    put(bytes, 12 + 130 * b,
        static_cast<std::uint64_t>(number * 180 + 22 * static_cast<int>(b)) % 36000, 2);
    for (std::size_t c = 0; c < 32; ++c) put(bytes, 12 + 130 * b + 2 + 4 * c, 2500, 2);
  }
  bytes[1062] = '\x37';
  bytes[1065] = 100, bytes[1066] = 1, bytes[1067] = 1;
  put(bytes, 1071, static_cast<std::uint64_t>(number) * 500, 4);
  put(bytes, 1076, static_cast<std::uint64_t>(number), 4);
  return bytes;
}

/// A capture of the packets, 0.5 ms apart.
void writePcap(const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  std::string header(24, '\0');
  put(header, 0, 0xA1B2C3D4, 4), put(header, 4, 2, 2), put(header, 6, 4, 2), put(header, 20, 1, 4);
  file << header;
  for (int i = 0; i < kPackets; ++i) {
    const std::string payload = xt32Packet(i);
    std::string record(16 + 42, '\0');
    put(record, 0, 1000, 4), put(record, 4, static_cast<std::uint64_t>(i) * 500, 4);
    put(record, 8, 42 + payload.size(), 4), put(record, 12, 42 + payload.size(), 4);
    const std::size_t ip = 20 + 8 + payload.size(), udp = 8 + payload.size();
    record[28] = 8, record[30] = 0x45, record[39] = 17;
    record[32] = static_cast<char>(ip >> 8), record[33] = static_cast<char>(ip);
    record[52] = 9, record[53] = 0x40;
    record[54] = static_cast<char>(udp >> 8), record[55] = static_cast<char>(udp);
    file << record << payload;
  }
}

class Recorded : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    writePcap((dir_ / "xt32.pcap").string());
  }
  void TearDown() override { fs::remove_all(dir_); }

  std::string ini(const std::string& global, const std::string& more) const {
    const std::string path = (dir_ / "capture.ini").string();
    std::ofstream(path) << "[global]\n"
                        << global << "\n[XT32]\ndriver = CPacketSensor\n"
                        << "process_rate = 50\nsensorLabel = XT32\ndevice = xt32\nport = 42371\n"
                        << "replay = " << (dir_ / "xt32.pcap").string() << "\n"
                        << more;
    return path;
  }
  std::string out() const { return (dir_ / "out").string(); }

  /// The lines of capture.jsonl that have `key`.
  std::vector<nlohmann::json> notes(const char* key) const {
    std::vector<nlohmann::json> lines;
    std::ifstream file(out() + "/capture.jsonl");
    for (std::string line; std::getline(file, line);) {
      const auto json = nlohmann::json::parse(line);
      if (json.contains(key)) lines.push_back(json);
    }
    return lines;
  }

  fs::path dir_ = fs::path(testing::TempDir()) / "packet sensor test";
};

TEST_F(Recorded, WhatWasSentAndWhatWasLostIsKnownToThePacket) {
  Grabber grabber(ini("chunk_seconds = 1",
                      "fault_loss = 0.02\nfault_repeat = 0.02\n"
                      "fault_swap = 0.02\nseed = 3\n"),
                  {out(), "", {}});
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
  grabber.run([&] { return std::chrono::steady_clock::now() > end; }, [] {});
  const auto sensors = notes("sensor");
  ASSERT_EQ(sensors.size(), 1U);
  const auto& sent = sensors[0]["simulator"];
  const auto& got = sensors[0]["packets"];
  EXPECT_GT(sent["dropped"], 10);
  EXPECT_EQ(got["received"], sent["sent"]);
  EXPECT_EQ(got["lost"], sent["dropped"]);
  EXPECT_EQ(got["repeated"], sent["repeated"]);
  EXPECT_GT(got["late"], 10);
  EXPECT_EQ(got["damaged"], 0);
  std::uint64_t points = 0, entries = 0;
  for (const auto& chunk : notes("chunk")) {
    RawlogReader reader(out() + "/" + chunk["chunk"].get<std::string>());
    while (const auto observation = reader.next())
      points += dynamic_cast<const CObservationLidarScan&>(*observation).cloud.size();
    EXPECT_EQ(reader.end(), RawlogReader::End::kClean);
    EXPECT_EQ(reader.entries(), chunk["entries"]);
    entries += reader.entries();
  }
  EXPECT_EQ(entries, sensors[0]["written"]);
  const auto whole = sent["made"].get<std::uint64_t>() - sent["dropped"].get<std::uint64_t>();
  EXPECT_EQ(points, whole * 256);  // every return of every packet, the tail included
}

TEST_F(Recorded, AFullDiskEndsTheCaptureWithWholeChunks) {
  Grabber grabber(ini("chunk_seconds = 60\nfree_mb = 1e12", ""), {out(), "", {}});
  try {
    grabber.run([] { return false; }, [] {});
    FAIL();
  } catch (const OutputError& error) {
    EXPECT_EQ(error.code(), ExitCode::kIoError);
  }
  ASSERT_EQ(notes("chunk").size(), 1U);
  RawlogReader reader(out() + "/capture_0001.rawlog");
  while (reader.next()) {
  }
  EXPECT_EQ(reader.end(), RawlogReader::End::kClean);
  EXPECT_GT(reader.entries(), 0U);
}

TEST_F(Recorded, FaultsOfTheIniAreNamed) {
  EXPECT_THROW(Grabber(ini("", "").substr(1), {out(), "", {}}), DataError);
  const std::string wrong = (dir_ / "wrong.ini").string();
  std::ofstream(wrong) << "[global]\n[A]\ndriver = CNoSuchSensor\n";
  try {
    Grabber grabber(wrong, {out(), "", {}});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("[A] driver CNoSuchSensor"), std::string::npos);
  }
}

/// "3", "5-7" as numbers.
std::vector<std::uint64_t> numbersOf(const nlohmann::json& ranges) {
  std::vector<std::uint64_t> numbers;
  for (const std::string range : ranges) {
    const std::size_t mark = range.find('-');
    const std::uint64_t from = std::stoull(range);
    const std::uint64_t to = mark == std::string::npos ? from : std::stoull(range.substr(mark + 1));
    for (std::uint64_t n = from; n <= to; ++n) numbers.push_back(n);
  }
  return numbers;
}

/// ini/capture.ini with faults in every device, wherever the test runs.
std::string shippedIni(const std::string& dir, const std::string& faults) {
  std::ifstream file(PERCEPTION_SOURCE_DIR "/ini/capture.ini");
  std::stringstream text;
  text << file.rdbuf();
  std::string ini =
      std::regex_replace(text.str(), std::regex("= ini/"), "= " PERCEPTION_SOURCE_DIR "/ini/");
  ini = std::regex_replace(ini, std::regex("driver = CPacketSensor"),
                           "driver = CPacketSensor\n" + faults);
  ini = std::regex_replace(ini, std::regex("start_delay = 2"), "start_delay = 1");
  ini = std::regex_replace(ini, std::regex("\nport = (.?)(...)(.)"), "\nport = 4$2$3");
  const std::string path = dir + "/shipped.ini";
  std::ofstream(path) << ini;
  return path;
}

TEST_F(Recorded, TheShippedDevicesLoseWhatTheirSimulatorsDroppedAndNothingElse) {
  Grabber grabber(shippedIni(dir_.string(),
                             "fault_loss = 0.02\nfault_repeat = 0.02\nfault_swap = 0.02\n"
                             "fault_torn = 0.02"),
                  {out(), "", {}});
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(3500);
  grabber.run([&] { return std::chrono::steady_clock::now() > end; }, [] {});
  int devices = 0;
  for (const auto& sensor : notes("sensor")) {
    if (!sensor.contains("simulator")) continue;
    ++devices;
    const std::string name = sensor["sensor"];
    const auto& sent = sensor["simulator"];
    const auto& got = sensor["packets"];
    EXPECT_GT(sensor["written"], 5) << name;
    EXPECT_EQ(got["received"], sent["sent"]) << name;
    EXPECT_EQ(got["damaged"], sent["torn"]) << name;
    EXPECT_EQ(got["repeated"], sent["repeated"]) << name;
    EXPECT_EQ(got["overrun"], 0) << name;
    EXPECT_EQ(numbersOf(got["lost_numbers"]), sent["missing"].get<std::vector<std::uint64_t>>())
        << name;
    EXPECT_EQ(got["lost"], sent["missing"].size()) << name;
    EXPECT_EQ(sent["made"].get<std::uint64_t>() - sent["dropped"].get<std::uint64_t>() +
                  sent["repeated"].get<std::uint64_t>() + sent["resent"].get<std::uint64_t>(),
              sent["sent"])
        << name;
  }
  EXPECT_EQ(devices, 9);
}

/// Sends to the loopback interface, from a port of its own.
class Sender {
 public:
  Sender() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {}
  ~Sender() { ::close(socket_); }
  void send(const std::string& bytes, std::uint16_t port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
             sizeof to);
  }

 private:
  int socket_;
};

TEST_F(Recorded, ASecondSenderIsRefusedAndARestartIsRecognised) {
  const std::string path = (dir_ / "two.ini").string();
  std::ofstream(path) << "[global]\n[XT32]\ndriver = CPacketSensor\nsensorLabel = XT32\n"
                         "device = xt32\nport = 42372\n";
  Grabber grabber(path, {out(), "", {}});
  const auto begin = std::chrono::steady_clock::now();
  bool sent = false;
  grabber.run(
      [&] {
        if (!std::exchange(sent, true)) {
          const Sender first, second;
          for (int i = 1000; i < 1200; ++i) {
            first.send(xt32Packet(i), 42372);
            if (i % 10 == 0) second.send(xt32Packet(50000 + i), 42372);
          }
          for (int i = 0; i < 100; ++i) first.send(xt32Packet(i), 42372);  // switched on again
        }
        return std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(600);
      },
      [] {});
  const auto sensor = notes("sensor").at(0);
  const auto& got = sensor["packets"];
  EXPECT_EQ(got["received"], 300);
  EXPECT_EQ(got["refused"], 20);
  EXPECT_EQ(got["restarts"], 1);
  EXPECT_EQ(got["lost"], 0);
  const std::string events = sensor["events"].dump();
  EXPECT_NE(events.find("a second sender, 127.0.0.1:"), std::string::npos) << events;
  EXPECT_NE(events.find("restarted"), std::string::npos) << events;
}

TEST_F(Recorded, ACanInterfaceTakesFramesOfAnEsr) {
  const std::string path = (dir_ / "can.ini").string();
  std::ofstream(path)
      << "[global]\n[ESR]\ndriver = CPacketSensor\nsensorLabel = ESR\ndevice = esr\n"
         "interface = vcan0\nscenario = " PERCEPTION_SOURCE_DIR
         "/ini/scenarios/devices.ini\n"
         "pose_x = 2.4\npose_z = 0.4\n";
  std::unique_ptr<Grabber> grabber;
  try {
    grabber = std::make_unique<Grabber>(path, GrabberOutputs{out(), "", {}});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kUnavailable);
    EXPECT_NE(std::string(error.what()).find("vcan0"), std::string::npos) << error.what();
    GTEST_SKIP() << error.what() << " (ip link add vcan0 type vcan; ip link set vcan0 up)";
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(2500);
  grabber->run([&] { return std::chrono::steady_clock::now() > end; }, [] {});
  const auto sensor = notes("sensor").at(0);
  EXPECT_GT(sensor["written"], 10);
  EXPECT_EQ(sensor["packets"]["received"], sensor["simulator"]["sent"]);
}

TEST_F(Recorded, KeysThatDoNotFitAreNamed) {
  const auto said = [&](const std::string& keys) -> std::string {
    const std::string path = (dir_ / "keys.ini").string();
    std::ofstream(path) << "[global]\n[A]\ndriver = CPacketSensor\nsensorLabel = A\n" << keys;
    try {
      Grabber grabber(path, {out(), "", {}});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(said("device = ibeo\n").find("host"), std::string::npos);
  EXPECT_NE(said("device = esr\ntransport = udp\n").find("can or can_udp"), std::string::npos);
  EXPECT_NE(said("device = xt32\nfault_loss = 0.1\n").find("need a simulated device"),
            std::string::npos);
  EXPECT_NE(said("device = xt32\nreplay_port = 70000\n").find("replay_port = 70000"),
            std::string::npos);
  EXPECT_NE(said("device = xt32\nreplay_speed = -1\n").find("replay_speed = -1"),
            std::string::npos);
  EXPECT_NE(said("device = xt32\nfault_loss = 2\n").find("fault_loss = 2"), std::string::npos);
  EXPECT_NE(said("device = xt32\nreplay = a.pcap\nfault_clock_step = 1\n").find("scenario"),
            std::string::npos);
}

}  // namespace
}  // namespace perception
