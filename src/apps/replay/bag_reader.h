// Recorded bags as the replay sees them: scans, odometry and truth in the order in which they were
// recorded, and where the lidar sat.
#pragma once

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "ros/conversions.h"
#include "ros/tf_odometry.h"

namespace racecar_mcl {

/// A bag that cannot be read or lacks what was asked for; says what it does hold.
struct BagError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline Nanoseconds toNanoseconds(const ros::Time& time) {
  return static_cast<Nanoseconds>(time.toNSec());
}

/// One recorded message: a scan or odometry.
struct BagEvent {
  ros::Time recorded;
  sensor_msgs::LaserScan::ConstPtr scan;
  nav_msgs::Odometry::ConstPtr odometry;
};

/// The frames between which tf holds the odometry.
struct TfFrames {
  std::string odom;
  std::string base;
  double clock_jump = 1.0;  ///< s; see TfOdometry
};

/// A part of the recorded time, counted from the beginning of the earliest bag.
struct BagSpan {
  double start = 0.0;                                         ///< s
  double duration = std::numeric_limits<double>::infinity();  ///< s
};

class BagReader {
 public:
  /// Of scans and odometry, only those recorded within the span are visited and counted; transforms
  /// and readPoses are of all. Throws BagError naming the bag that cannot be read, and where
  /// nothing was recorded within the span.
  explicit BagReader(const std::vector<std::string>& paths, const BagSpan& span = {});

  /// Throws BagError where no bag holds this topic with this type (as in sensor_msgs/LaserScan);
  /// `option` is the command-line option that names another.
  void requireTopic(const std::string& topic, const std::string& type,
                    const std::string& option) const;
  bool hasTopic(const std::string& topic, const std::string& type) const;

  /// How many messages these topics hold.
  std::size_t count(const std::vector<std::string>& topics) const;

  /// Calls visit(event) in the order of record time over all bags; of messages recorded at the same
  /// time odometry comes first, as a scan needs it. Throws BagError where a bag turns out broken.
  void forEach(const std::string& scan_topic, const std::string& odometry_topic,
               const std::function<void(const BagEvent&)>& visit) const;

  /// The same with odometry from tf, odom_frame -> base_frame. Throws BagError, before the first
  /// event, naming the frames that the bags do hold where this way is not among them.
  void forEach(const std::string& scan_topic, const TfFrames& frames,
               const std::function<void(const BagEvent&)>& visit) const;

  /// Those of one topic, in the order of record time. Throws as forEach.
  void forEachScan(const std::string& topic,
                   const std::function<void(const sensor_msgs::LaserScan&)>& visit) const;
  void forEachOdometry(const std::string& topic,
                       const std::function<void(const nav_msgs::Odometry&)>& visit) const;

  /// The header stamp of the first scan. Throws BagError where there is none.
  Nanoseconds firstScanStamp(const std::string& topic) const;

  /// The poses of an odometry topic, by header stamp.
  Trajectory readPoses(const std::string& topic) const;

  /// Where the lidar of the first scan sits, from /tf_static and the first messages of /tf that
  /// tell. Throws BagError naming the frames that the bags do hold.
  LaserMount laserMount(const std::string& scan_topic, const std::string& base_frame) const;

 private:
  struct NamedBag {
    std::string path;
    std::unique_ptr<rosbag::Bag> bag;
  };

  using Visit = std::function<bool(const rosbag::MessageInstance&)>;

  /// Record times, both included; all of them by default.
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
  /// Calls `visit` for scans, and for the odometry that `odometry_of` makes of other messages.
  void forEach(
      const std::string& scan_topic, const std::string& odometry_topic,
      const std::function<nav_msgs::OdometryConstPtr(const rosbag::MessageInstance&)>& odometry_of,
      const std::function<void(const BagEvent&)>& visit) const;
  /// Odometry from tf that knows all of /tf_static.
  std::unique_ptr<TfOdometry> tfOdometry(const TfFrames& frames) const;
  void requireOdometry(const TfFrames& frames) const;
  std::string contents() const;
  std::string names() const;

  std::vector<NamedBag> bags_;
  Interval interval_;
};

}  // namespace racecar_mcl
