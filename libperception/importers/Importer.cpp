#include "libperception/importers/Importer.h"

#include "libperception/core/Error.h"

namespace perception {

std::vector<ImporterRow>& importers() {
  static std::vector<ImporterRow> rows = {
      {"kitti", "one sequence of the KITTI tracking benchmark", kUsesRate | kUsesImages,
       &makeKittiImporter},
      {"kitti-raw", "a drive of KITTI's raw data: scans, GPS/IMU, images, tracklets", kUsesImages,
       &makeKittiRawImporter},
      {"semantickitti", "a sequence of SemanticKITTI: scans, poses, a class per point", kUsesRate,
       &makeSemanticKittiImporter},
      {"clouds", "a folder of point clouds (.bin .pcd .ply .csv), with stamps and poses", kUsesRate,
       &makeCloudsImporter},
      {"bag", "recordings of ROS 1 or 2: bags, MCAP files, sqlite files of rosbag2 (.db3)", kLists,
       &makeBagImporter},
      {"images", "single frames of the KITTI object benchmark: images, labels, scans",
       kUsesRate | kUsesImages | kUsesRepeat, &makeImagesImporter},
      {"kitti-object", "single scans of the KITTI object benchmark: scans, labels, images",
       kUsesRate | kUsesImages | kUsesRepeat, &makeKittiObjectImporter},
      {"vod", "View of Delft: radar points, lidar, image, labels, poses",
       kUsesRate | kUsesImages | kUsesRepeat, &makeVodImporter},
      {"av2", "Argoverse 2 as tables: scans of two stacked lidars, labels, poses", kUsesRepeat,
       &makeAv2Importer},
      {"nuscenes", "nuScenes: lidar, five radars, six cameras, poses, boxes of one scene",
       kUsesImages | kLists, &makeNuscenesImporter},
      {"aimotive", "aiMotive: lidar, front and rear radar, camera, motion, labels", kUsesImages,
       &makeAimotiveImporter},
      {"radiate", "RADIATE: Navtech radar, lidar, camera, GPS, annotations", kUsesImages,
       &makeRadiateImporter},
      {"wads", "WADS: lidar scans in falling snow with a class per point", kUsesRate,
       &makeWadsImporter},
      {"snowykitti", "SnowyKITTI: KITTI scans with simulated snow, labeled per point", kUsesRate,
       &makeSnowyKittiImporter},
      {"semanticspray", "SemanticSpray: scans behind a vehicle on wet roads, a class per point",
       kUsesRate, &makeSemanticSprayImporter},
      {"cadc", "CADC: lidar, GPS/IMU and boxes in snow", 0, &makeCadcImporter},
      {"boreas", "Boreas: lidar, turning radar, camera, poses and boxes of one drive", kUsesImages,
       &makeBoreasImporter},
      {"comma2k19", "comma2k19: tracks of a car's radar, ego motion, GNSS", 0,
       &makeComma2k19Importer},
      {"udacity", "Udacity's radar and laser measurements of one object (simulated)", 0,
       &makeUdacityImporter},
      {"packets", "a pcap of a lidar's or radar's UDP packets", 0, &makePacketsImporter},
      {"nmea", "a GPS receiver's NMEA 0183 log: the vehicle's own way, or an object's", 0,
       &makeNmeaImporter},
      {"gpx", "a GPX track: the vehicle's own way, or an object's", 0, &makeGpxImporter},
      {"vehicle-truth", "another vehicle's GNSS as the truth of a log: FILE.truth.csv", 0,
       &makeVehicleTruthImporter},
  };
  return rows;
}

void failUsage(const std::string& message) { throw Error(ExitCode::kUsage, message); }

}  // namespace perception
