// Reads scans, odometry, ground truth and lidar extrinsics from recorded bags.
#pragma once

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "ros/conversions/message_conversions.h"
#include "ros/localization/tf_odometry.h"

namespace racecar_mcl {

/// A bag that cannot be read or lacks the requested messages; names what it contains.
struct BagError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline Nanoseconds toNanoseconds(const ros::Time& time) {
  return static_cast<Nanoseconds>(time.toNSec());
}

/// One recorded message: a scan, odometry or an IMU's.
struct BagEvent {
  ros::Time recorded;
  sensor_msgs::LaserScan::ConstPtr scan;
  std::string scan_topic;
  nav_msgs::Odometry::ConstPtr odometry;
  sensor_msgs::Imu::ConstPtr imu;
};

struct BagTopics {
  std::vector<std::string> scans;
  std::string odometry;  ///< not used if the odometry is from tf
  std::string imu = {};  ///< empty: none
};

/// The frames of odometry in tf.
struct TfFrames {
  std::string odom;
  std::string base;
  double clock_jump = 1.0;  ///< s; see TfOdometry
};

/// A part of the recording, relative to the beginning of the earliest bag.
struct BagSpan {
  double start = 0.0;                                         ///< s
  double duration = std::numeric_limits<double>::infinity();  ///< s
};

class BagReader {
 public:
  /// Scans and odometry are limited to the span; transforms and readPoses are not. Throws BagError
  /// if a bag cannot be read or the span contains no messages.
  explicit BagReader(const std::vector<std::string>& paths, const BagSpan& span = {});

  /// Throws BagError if no bag contains this topic with this type (such as sensor_msgs/LaserScan);
  /// `option` is the command-line option for the topic.
  void requireTopic(const std::string& topic, const std::string& type,
                    const std::string& option) const;
  bool hasTopic(const std::string& topic, const std::string& type) const;

  /// The number of messages on these topics.
  std::size_t count(const std::vector<std::string>& topics) const;

  /// Calls visit(event) in the order of record time over all bags; among messages with the same
  /// record time, scans come last because they need the others. Throws BagError if a bag is
  /// corrupt.
  void forEach(const BagTopics& topics, const std::function<void(const BagEvent&)>& visit) const;

  /// The same with odometry from tf, odom_frame -> base_frame. Throws BagError before the first
  /// event if the bags have no such transform; names the frames they contain.
  void forEach(const BagTopics& topics, const TfFrames& frames,
               const std::function<void(const BagEvent&)>& visit) const;

  /// The messages of one topic in the order of record time. Throws as forEach.
  void forEachScan(const std::string& topic,
                   const std::function<void(const sensor_msgs::LaserScan&)>& visit) const;
  void forEachOdometry(const std::string& topic,
                       const std::function<void(const nav_msgs::Odometry&)>& visit) const;

  /// The header stamp of the first scan. Throws BagError if there is none.
  Nanoseconds firstScanStamp(const std::string& topic) const;

  /// The poses of an odometry topic, by header stamp.
  Trajectory readPoses(const std::string& topic) const;

  /// Extrinsics of the first scan's lidar, from /tf_static and, if necessary, /tf. Throws BagError
  /// if there is no such transform; names the frames the bags contain.
  LidarExtrinsics lidarExtrinsics(const std::string& scan_topic,
                                  const std::string& base_frame) const;
  /// The same of the lidar with this frame.
  LidarExtrinsics extrinsicsOf(const std::string& laser_frame, const std::string& base_frame) const;
  /// The frame of the first scan, without a leading slash. Throws BagError if there is none.
  std::string scanFrame(const std::string& topic) const;
  /// As scanFrame; throws BagError also if it is empty.
  std::string requireScanFrame(const std::string& topic) const;
  /// The rotation of the IMU in `base_frame`, from /tf_static and, if necessary, /tf; none without
  /// a transform.
  std::optional<geometry_msgs::Quaternion> imuRotation(const std::string& imu_topic,
                                                       const std::string& base_frame) const;

 private:
  struct NamedBag {
    std::string path;
    std::unique_ptr<rosbag::Bag> bag;
  };

  using Visit = std::function<bool(const rosbag::MessageInstance&)>;

  /// Record times, inclusive; unlimited by default.
  struct Interval {
    ros::Time from = ros::TIME_MIN;
    ros::Time to = ros::TIME_MAX;
  };

  Interval intervalOf(const BagSpan& span) const;
  void addQueries(const std::vector<std::string>& topics, const Interval& interval,
                  rosbag::View* view) const;
  /// Calls visit(message) in the order of record time until it returns false.
  void visitMessages(const std::vector<std::string>& topics, const Interval& interval,
                     const Visit& visit) const;
  sensor_msgs::LaserScan::ConstPtr firstScan(const std::string& topic) const;
  /// Calls `visit` for scans, for IMU messages and for odometry, which `odometry_of` extracts from
  /// the other messages.
  void forEach(
      const BagTopics& topics,
      const std::function<nav_msgs::OdometryConstPtr(const rosbag::MessageInstance&)>& odometry_of,
      const std::function<void(const BagEvent&)>& visit) const;
  /// A TfOdometry that contains all of /tf_static.
  std::unique_ptr<TfOdometry> tfOdometry(const TfFrames& frames) const;
  void requireOdometry(const TfFrames& frames) const;
  /// The transform from a sensor's frame; none if the bags have none.
  std::optional<geometry_msgs::Transform> transformOf(const std::string& sensor_frame,
                                                      const std::string& base_frame,
                                                      std::string* known_frames) const;
  std::string contents() const;
  std::string names() const;

  std::vector<NamedBag> bags_;
  Interval interval_;
};

}  // namespace racecar_mcl
