// perception-grabber's recorder under load: capture_load FOLDER MB_PER_S SECONDS [GZIP_LEVEL].
// Eight drivers together offer as many bytes a second in scans of 100 000 returns with noise in
// every float (a lidar's compress by as little); prints what was offered, what the log holds (read
// again), what was left out, and the share of one core.
#include <fmt/format.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "libperception/capture/Grabber.h"
#include "libperception/core/Error.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {

constexpr std::size_t kReturns = 100000;
constexpr int kDrivers = 8;

class CLoadSensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(CLoadSensor)

 public:
  void initialize() override {
    std::mt19937 random(1);
    for (std::size_t i = 0; i < kReturns; ++i) {
      const auto noise = [&](float scale) { return scale * static_cast<float>(random() % 100000); };
      cloud_.x.push_back(noise(1e-3F)), cloud_.y.push_back(noise(1e-3F)),
          cloud_.z.push_back(noise(1e-4F));
      cloud_.intensity.push_back(static_cast<float>(random() % 256) / 255);
      cloud_.time_offset.push_back(static_cast<float>(i) * 1e-6F);
      cloud_.ring.push_back(static_cast<std::uint16_t>(i % 64));
    }
  }
  void doProcess() override {
    const auto now = std::chrono::steady_clock::now();
    if (made == 0) begin_ = now;
    const double due = std::chrono::duration<double>(now - begin_).count() * rate_;
    for (; static_cast<double>(made) <= due; ++made) {
      auto scan = std::make_shared<CObservationLidarScan>();
      scan->cloud = cloud_;
      scan->sensorLabel = m_sensorLabel;
      scan->timestamp = mrpt::Clock::now();
      appendObservation(scan);
    }
  }
  std::uint64_t made = 0;

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override {
    rate_ = config.read_double(section, "rate", 1);
  }

 private:
  LidarCloud cloud_;
  double rate_ = 1;  ///< [1/s]
  std::chrono::steady_clock::time_point begin_;
};

IMPLEMENTS_GENERIC_SENSOR(CLoadSensor, perception)

double cpuSeconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

int run(const std::string& folder, double megabytes, double seconds, int level) {
  CLoadSensor::doRegister();
  std::filesystem::create_directories(folder);
  const double size = kReturns * 22e-6;  // [MB] five floats and a ring
  const std::string ini = folder + "/load.ini";
  std::ofstream file(ini);
  file << fmt::format("[global]\nrawlog_GZ_compress_level = {}\nqueue_mb = 1000\n", level);
  for (int i = 0; i < kDrivers; ++i)
    file << fmt::format(
        "[L{0}]\ndriver = CLoadSensor\nprocess_rate = 200\nsensorLabel = L{0}\nrate = {1}\n", i,
        megabytes / size / kDrivers);
  file.close();
  const double cpu = cpuSeconds();
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Grabber grabber(ini, {folder + "/log", "", {}});
  grabber.run([&] { return passed() >= seconds; }, [] {});
  const double took = passed(), used = cpuSeconds() - cpu;
  std::uint64_t written = 0, left_out = 0, listed = 0, read = 0;
  for (const auto& [label, ledger] : grabber.sensors()) {
    written += ledger.written;
    left_out += ledger.left_out;
    listed += ledger.left_out_stamps.size();
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/log")) {
    if (entry.path().extension() != ".rawlog") continue;
    RawlogReader reader(entry.path().string());
    while (reader.next()) ++read;
  }
  const auto mb = [&](std::uint64_t scans) { return static_cast<double>(scans) * size; };
  fmt::print(
      "offered {:.0f} MB in {:.1f} s ({:.1f} MB/s); recorded {:.0f} MB in {:.1f} s, read again "
      "{:.0f} MB; left out {} scans, {} listed; {:.2f} cores; {} chunks, {:.0f} MB\n",
      mb(written + left_out), seconds, mb(written + left_out) / seconds, mb(written), took,
      mb(read), left_out, listed, used / took, grabber.chunks(),
      static_cast<double>(grabber.bytes()) * 1e-6);
  return read == written ? 0 : 1;
}

}  // namespace perception

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fputs("capture_load FOLDER MB_PER_S SECONDS [GZIP_LEVEL]\n", stderr);
    return 64;
  }
  try {
    return perception::run(argv[1], std::atof(argv[2]), std::atof(argv[3]),
                           argc > 4 ? std::atoi(argv[4]) : 1);
  } catch (const perception::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  }
}
