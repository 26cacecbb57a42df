#include "libperception/capture/drivers/Drivers.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <fstream>
#include <thread>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

using std::chrono::milliseconds;

/// [mood] good gives an observation a look; bad throws at the third; stuck does not return.
class CMoodySensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(CMoodySensor)

 public:
  void doProcess() override {
    ++looks_;
    if (mood_ == "bad" && looks_ > 2) throw std::runtime_error("no more");
    if (mood_ == "stuck") std::this_thread::sleep_for(std::chrono::seconds(4));
    auto observation = std::make_shared<mrpt::obs::CObservationOdometry>();
    observation->sensorLabel = m_sensorLabel;
    observation->timestamp = mrpt::Clock::now();
    appendObservation(observation);
  }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override {
    mood_ = config.read_string(section, "mood", "good");
  }

 private:
  std::string mood_;
  int looks_ = 0;
};

}  // namespace
IMPLEMENTS_GENERIC_SENSOR(CMoodySensor, perception::test)
namespace {

std::string iniOf(const TemporaryFolder& folder, const std::vector<std::string>& moods) {
  CMoodySensor::doRegister();
  std::ofstream ini(folder / "drivers.ini");
  for (const auto& mood : moods)
    ini << "[" << mood << "]\ndriver = CMoodySensor\nsensorLabel = " << mood << "\nmood = " << mood
        << "\nprocess_rate = 200\n";
  return folder / "drivers.ini";
}

TEST(Drivers, OneThatFailsOrHangsCostsNothingButItself) {
  const TemporaryFolder folder;
  Drivers drivers(iniOf(folder, {"good", "bad", "stuck"}));
  std::map<std::string, int> count;
  const auto end = std::chrono::steady_clock::now() + milliseconds(500);
  while (std::chrono::steady_clock::now() < end) {
    for (const auto& arrival : drivers.take(milliseconds(20)))
      ++count[drivers.label(arrival.driver)];
  }
  drivers.end();
  EXPECT_GT(count["good"], 20);
  EXPECT_EQ(count["bad"], 2);
  EXPECT_EQ(count["stuck"], 0);
  EXPECT_EQ(drivers.faults(), (std::vector<std::string>{"bad: its driver failed: no more",
                                                        "stuck: its driver does not return"}));
}

TEST(Drivers, FaultsOfTheIniAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(Drivers(folder / "none.ini"), DataError);
  std::ofstream(folder / "empty.ini") << "[global]\n";
  EXPECT_THROW(Drivers(folder / "empty.ini"), ConfigError);
}

TEST(Drivers, ARawlogIsPlayedWithItsOwnIntervals) {
  const TemporaryFolder folder;
  const std::string log = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";
  const double start = 2e9;  // [s] stamps begin here; the log is due at once at this speed
  std::ofstream(folder / "log.ini") << "[LOG]\ndriver = CRawlogSensor\nsensorLabel = LOG\n"
                                       "process_rate = 500\nspeed = 20\nlabels = LIDAR_TOP\n"
                                       "rawlog = "
                                    << log << "\n";
  std::ofstream(folder / "late.ini") << "[LOG]\ndriver = CRawlogSensor\nsensorLabel = LOG\n"
                                        "start_at = "
                                     << std::to_string(start) << "\nrawlog = " << log << "\n";
  Drivers late(folder / "late.ini");  // of the future: nothing is due
  Drivers drivers(folder / "log.ini");
  std::vector<Stamp> played, recorded;
  const auto end = std::chrono::steady_clock::now() + milliseconds(1500);
  while (std::chrono::steady_clock::now() < end) {
    for (const auto& arrival : drivers.take(milliseconds(20))) {
      EXPECT_EQ(arrival.observation->sensorLabel, "LIDAR_TOP");
      played.push_back(*toStamp(arrival.observation->timestamp));
    }
  }
  RawlogReader reader(log);
  while (const auto o = reader.next())
    if (o->sensorLabel == "LIDAR_TOP") recorded.push_back(*toStamp(o->timestamp));
  ASSERT_EQ(played.size(), recorded.size());
  for (std::size_t i = 1; i < played.size(); ++i)
    EXPECT_EQ(played[i].ns - played[0].ns, recorded[i].ns - recorded[0].ns);
  EXPECT_TRUE(late.take(milliseconds(0)).empty());
}

TEST(Drivers, ARawlogJoinsWhereItStartedBefore) {
  const TemporaryFolder folder;
  const double start = mrpt::Clock::nowDouble() - 5;
  std::ofstream(folder / "log.ini")
      << "[LOG]\ndriver = CRawlogSensor\nsensorLabel = LOG\n"
         "process_rate = 500\nlabels = LIDAR_TOP\nstart_at = "
      << std::to_string(start) << "\nrawlog = " << PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog\n";
  Drivers drivers(folder / "log.ini");
  std::vector<Stamp> played;
  const auto end = std::chrono::steady_clock::now() + milliseconds(800);
  while (std::chrono::steady_clock::now() < end)
    for (const auto& arrival : drivers.take(milliseconds(20)))
      played.push_back(*toStamp(arrival.observation->timestamp));
  ASSERT_GT(played.size(), 3U);
  EXPECT_GT(played.front().seconds(), start + 4.8);
  for (std::size_t i = 1; i < played.size(); ++i)  // from then on without a gap
    EXPECT_NEAR(played[i] - played[i - 1], 0.1, 0.02);
}

}  // namespace
}  // namespace perception::test
