#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libperception/batch/Manifest.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunRecord.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

inline std::string contentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A batch of shards without logs; what tracks them is a shell script.
struct BatchFixture : testing::Test {
  TemporaryFolder folder;
  std::string dir = folder / "batch";
  Batch batch;

  BatchFixture() {
    batch.version = "1";
    batch.folder = folder.path();
    batch.config = "batch.ini";
    std::filesystem::create_directory(dir);
    std::filesystem::create_directory(folder / "records");
  }
  Shard& addShard(const std::string& id, std::uint64_t bytes = 1) {
    Shard shard;
    shard.id = id;
    shard.input = id + ".rawlog";
    shard.bytes = bytes;
    shard.sha256 = "0" + id;
    shard.config = PERCEPTION_SOURCE_DIR "/ini/udacity.ini";
    shard.config_sha = configurationHash(effectiveIniOf(shard), batch.version);
    batch.shards.push_back(shard);
    return batch.shards.back();
  }
  /// A program in place of perception-track. $id is the shard's, $out its folder; `finish` makes it
  /// done as its record says.
  std::string program(const std::string& script) const;
  void keepRecord(const Shard& shard, const RunRecord& record) const {
    writeRunRecord(folder / "records/" + shard.id + ".json", record);
  }
  void finish(const Shard& shard, const RunRecord& record) const {
    std::filesystem::create_directories(dir + "/" + shard.id);
    writeRunRecord(dir + "/" + shard.id + "/done.json", record);
  }
};

inline RunRecord recordOf(const Shard& shard, std::vector<std::string> warnings = {}) {
  RunRecord record;
  record.program = "perception-track";
  record.version = "1";
  record.hash = shard.runHash();
  record.input = shard.input;
  record.seed = 3;
  record.sensors_used = "L";
  record.association = "ranked";
  record.particles = 7;
  record.first_stamp = Stamp::fromSeconds(1000);
  record.last_stamp = Stamp::fromSeconds(1010);
  record.scenes = 100;
  record.tracks = 5;
  record.warnings = std::move(warnings);
  return record;
}

inline std::string BatchFixture::program(const std::string& script) const {
  for (const Shard& shard : batch.shards) keepRecord(shard, recordOf(shard));
  const std::string path = folder / "track.sh";
  std::ofstream(path) << "#!/bin/sh\n"
                         "while [ $# -gt 0 ]; do case $1 in -o) out=$2;; esac; shift; done\n"
                         "id=${out##*/}\n"
                         "finish() { mkdir -p \"$out\" && cp "
                      << folder / "records/$id.json"
                      << " \"$out/done.json\"; }\n"
                      << script << '\n';
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

}  // namespace perception::test
