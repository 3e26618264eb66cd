#include "offline/bag_reader.h"

#include <rosbag/query.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "offline/bag_structure.h"
#include "offline/recorded_message.h"
#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {
namespace {

/// Topics may be recorded with or without the leading slash.
bool sameTopic(const std::string& a, const std::string& b) {
  return stripLeadingSlash(a) == stripLeadingSlash(b);
}

std::vector<std::string> spellings(const std::vector<std::string>& topics) {
  std::vector<std::string> all;
  for (const std::string& topic : topics) {
    all.push_back(stripLeadingSlash(topic));
    all.push_back("/" + stripLeadingSlash(topic));
  }
  return all;
}

std::string joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + printable(word);
  return text;
}

bool beginsAsBag(const std::string& path) {
  const std::string magic = "#ROSBAG";
  std::string begin(magic.size(), ' ');
  return std::ifstream(path, std::ios::binary).read(begin.data(), begin.size()) && begin == magic;
}

/// ros::Duration cannot hold the seconds between any two times.
ros::Time later(const ros::Time& time, double seconds) {
  return ros::Time().fromNSec(time.toNSec() +
                              static_cast<std::uint64_t>(std::llround(seconds * 1e9)));
}

void insertTransforms(const tf2_msgs::TFMessage& message, bool is_static,
                      tf2::BufferCore* transforms) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    transform.header.frame_id = stripLeadingSlash(transform.header.frame_id);
    transform.child_frame_id = stripLeadingSlash(transform.child_frame_id);
    transforms->setTransform(transform, "bag", is_static);
  }
}

}  // namespace

BagReader::BagReader(const std::vector<std::string>& paths, const BagSpan& span) {
  for (const std::string& path : paths) {
    auto bag = std::make_unique<rosbag::Bag>();
    try {
      checkBagStructure(path);
      bag->open(path, rosbag::bagmode::Read);
    } catch (const rosbag::BagUnindexedException&) {
      throw BagError(path + ": the bag has no index (interrupted recording?); " +
                     "'rosbag reindex' restores it");
    } catch (const std::exception& error) {
      if (beginsAsBag(path)) {
        throw BagError(path + ": the bag is cut off or damaged (interrupted recording?); " +
                       "'rosbag reindex' restores what is there: " + error.what());
      }
      throw BagError(path + ": the bag cannot be read: " + error.what());
    }
    bags_.push_back({path, std::move(bag)});
  }
  interval_ = intervalOf(span);
}

BagReader::Interval BagReader::intervalOf(const BagSpan& span) const {
  Interval all{ros::TIME_MAX, ros::TIME_MIN};
  for (const NamedBag& named : bags_) {
    rosbag::View view(*named.bag);
    if (view.size() == 0) continue;
    all.from = std::min(all.from, view.getBeginTime());
    all.to = std::max(all.to, view.getEndTime());
  }
  const double duration = all.from <= all.to ? all.to.toSec() - all.from.toSec() : 0.0;
  if (span.start > 0.0 && span.start >= duration) {
    std::ostringstream problem;
    problem << names() << ": no messages from " << span.start << " s on; the duration is "
            << duration << " s";
    throw BagError(problem.str());
  }
  Interval interval;
  if (span.start > 0.0) interval.from = later(all.from, span.start);
  if (span.start + span.duration < duration) {
    interval.to = later(all.from, span.start + span.duration);
  }
  return interval;
}

std::string BagReader::names() const {
  std::string text;
  for (const NamedBag& named : bags_) text += (text.empty() ? "" : ", ") + named.path;
  return text;
}

std::string BagReader::contents() const {
  std::map<std::string, std::string> types;
  for (const NamedBag& named : bags_) {
    rosbag::View view(*named.bag);
    for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
      types[connection->topic] = connection->datatype;
    }
  }
  if (types.empty()) return "nothing";
  std::string text;
  for (const auto& [topic, type] : types) {
    text += (text.empty() ? "" : ", ") + printable(topic) + " (" + printable(type) + ")";
  }
  return text;
}

bool BagReader::hasTopic(const std::string& topic, const std::string& type) const {
  for (const NamedBag& named : bags_) {
    rosbag::View view(*named.bag);
    for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
      if (sameTopic(connection->topic, topic) && connection->datatype == type) return true;
    }
  }
  return false;
}

void BagReader::requireTopic(const std::string& topic, const std::string& type,
                             const std::string& option) const {
  if (hasTopic(topic, type)) return;
  throw BagError(names() + ": no topic " + topic + " of type " + type + "; set it with " + option +
                 "; recorded topics: " + contents());
}

std::size_t BagReader::count(const std::vector<std::string>& topics) const {
  rosbag::View view;
  addQueries(topics, interval_, &view);
  return view.size();
}

void BagReader::addQueries(const std::vector<std::string>& topics, const Interval& interval,
                           rosbag::View* view) const {
  for (const NamedBag& named : bags_) {
    view->addQuery(*named.bag, rosbag::TopicQuery(spellings(topics)), interval.from, interval.to);
  }
}

void BagReader::visitMessages(const std::vector<std::string>& topics, const Interval& interval,
                              const Visit& visit) const {
  std::map<std::string, std::size_t> numbers;  // of the messages read, by topic
  std::string topic;                           // of the last one
  const auto last = [&] {
    if (topic.empty()) return std::string("the first message");
    return "message " + std::to_string(numbers[topic]) + " of " + printable(topic);
  };
  try {
    rosbag::View view;
    addQueries(topics, interval, &view);
    for (const rosbag::MessageInstance& instance : view) {
      topic = instance.getTopic();
      ++numbers[topic];
      if (!visit(instance)) return;
    }
  } catch (const rosbag::BagException& error) {
    throw BagError(names() + ": the bag is corrupt at or after " + last() + ": " + error.what());
  } catch (const RecordedMessageError& problem) {
    throw BagError(names() + ": " + last() + " " + problem.what());
  } catch (const MessageError& error) {
    throw BagError(names() + ": " + last() + ": " + error.what());
  }
}

void BagReader::forEach(const BagTopics& topics,
                        const std::function<void(const BagEvent&)>& visit) const {
  forEach(topics, readMessage<nav_msgs::Odometry>, visit);
}

void BagReader::forEach(const BagTopics& topics, const TfFrames& frames,
                        const std::function<void(const BagEvent&)>& visit) const {
  requireOdometry(frames);
  const std::unique_ptr<TfOdometry> odometry = tfOdometry(frames);
  const auto odometry_of = [&](const rosbag::MessageInstance& instance) {
    return odometry->add(*readMessage<tf2_msgs::TFMessage>(instance), false);
  };
  forEach({topics.scans, "/tf", topics.imu}, odometry_of, visit);
}

std::unique_ptr<TfOdometry> BagReader::tfOdometry(const TfFrames& frames) const {
  auto odometry = std::make_unique<TfOdometry>(stripLeadingSlash(frames.odom),
                                               stripLeadingSlash(frames.base), frames.clock_jump);
  visitMessages({"/tf_static"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    odometry->add(*readMessage<tf2_msgs::TFMessage>(instance), true);
    return true;
  });
  return odometry;
}

void BagReader::requireOdometry(const TfFrames& frames) const {
  const std::unique_ptr<TfOdometry> odometry = tfOdometry(frames);
  std::set<std::string> known;
  bool found = false;
  visitMessages({"/tf"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    const auto message = readMessage<tf2_msgs::TFMessage>(instance);
    for (const geometry_msgs::TransformStamped& transform : message->transforms) {
      known.insert(stripLeadingSlash(transform.header.frame_id) + " -> " +
                   stripLeadingSlash(transform.child_frame_id));
    }
    found = odometry->add(*message, false) != nullptr;
    return !found;
  });
  if (found) return;
  throw BagError(names() + ": /tf has no odometry " + stripLeadingSlash(frames.odom) + " -> " +
                 stripLeadingSlash(frames.base) + "; set frames with --odom-frame and " +
                 "--base-frame; recorded transforms: " + (known.empty() ? "none" : joined(known)));
}

void BagReader::forEach(
    const BagTopics& topics,
    const std::function<nav_msgs::OdometryConstPtr(const rosbag::MessageInstance&)>& odometry_of,
    const std::function<void(const BagEvent&)>& visit) const {
  // Scans are delayed until all other messages with the same record time have been visited.
  std::vector<BagEvent> scans;
  std::vector<std::string> names = topics.scans;
  names.push_back(topics.odometry);
  const auto is_scan = [&](const std::string& topic) {
    return std::any_of(topics.scans.begin(), topics.scans.end(),
                       [&](const std::string& known) { return sameTopic(topic, known); });
  };
  if (!topics.imu.empty()) names.push_back(topics.imu);
  const auto flush = [&] {
    for (const BagEvent& scan : scans) visit(scan);
    scans.clear();
  };
  visitMessages(names, interval_, [&](const rosbag::MessageInstance& instance) {
    BagEvent event;
    event.recorded = instance.getTime();
    if (!scans.empty() && event.recorded != scans.front().recorded) flush();
    if (is_scan(instance.getTopic())) {
      event.scan = readMessage<sensor_msgs::LaserScan>(instance);
      event.scan_topic = instance.getTopic();
      scans.push_back(event);
    } else if (!topics.imu.empty() && sameTopic(instance.getTopic(), topics.imu)) {
      event.imu = readMessage<sensor_msgs::Imu>(instance);
      visit(event);
    } else {
      event.odometry = odometry_of(instance);
      if (event.odometry) visit(event);
    }
    return true;
  });
  flush();
}

void BagReader::forEachScan(const std::string& topic,
                            const std::function<void(const sensor_msgs::LaserScan&)>& visit) const {
  visitMessages({topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    visit(*readMessage<sensor_msgs::LaserScan>(instance));
    return true;
  });
}

void BagReader::forEachOdometry(const std::string& topic,
                                const std::function<void(const nav_msgs::Odometry&)>& visit) const {
  visitMessages({topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    visit(*readMessage<nav_msgs::Odometry>(instance));
    return true;
  });
}

sensor_msgs::LaserScan::ConstPtr BagReader::firstScan(const std::string& topic) const {
  sensor_msgs::LaserScan::ConstPtr scan;
  visitMessages({topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    scan = readMessage<sensor_msgs::LaserScan>(instance);
    return false;
  });
  if (!scan) throw BagError(names() + ": " + topic + " has no scan within --start and --duration");
  return scan;
}

Nanoseconds BagReader::firstScanStamp(const std::string& topic) const {
  return toNanoseconds(firstScan(topic)->header.stamp);
}

Trajectory BagReader::readPoses(const std::string& topic) const {
  std::vector<StampedPose> poses;
  visitMessages({topic}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    const auto message = readMessage<nav_msgs::Odometry>(instance);
    poses.push_back({toNanoseconds(message->header.stamp), toPose2(message->pose.pose)});
    return true;
  });
  return inOrder(std::move(poses));
}

std::optional<geometry_msgs::Transform> BagReader::transformOf(const std::string& sensor_frame,
                                                               const std::string& base_frame,
                                                               std::string* known_frames) const {
  tf2::BufferCore transforms;
  visitMessages({"/tf_static"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    insertTransforms(*readMessage<tf2_msgs::TFMessage>(instance), true, &transforms);
    return true;
  });
  const auto known = [&] {
    return transforms.canTransform(base_frame, sensor_frame, ros::Time(0));
  };
  bool found = known();
  if (!found) {
    visitMessages({"/tf"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
      insertTransforms(*readMessage<tf2_msgs::TFMessage>(instance), false, &transforms);
      found = known();
      return !found;
    });
  }
  if (found) return transforms.lookupTransform(base_frame, sensor_frame, ros::Time(0)).transform;
  std::vector<std::string> frames;
  transforms._getFrameStrings(frames);
  *known_frames = joined({frames.begin(), frames.end()});
  return std::nullopt;
}

std::string BagReader::scanFrame(const std::string& topic) const {
  return stripLeadingSlash(firstScan(topic)->header.frame_id);
}

std::string BagReader::requireScanFrame(const std::string& topic) const {
  std::string frame = scanFrame(topic);
  if (!frame.empty()) return frame;
  throw BagError(names() + ": the scans on " + printable(topic) +
                 " have no frame_id, so that tf does not have the lidar's pose; set it with "
                 "--laser-pose");
}

LidarExtrinsics BagReader::lidarExtrinsics(const std::string& scan_topic,
                                           const std::string& base_frame) const {
  return extrinsicsOf(requireScanFrame(scan_topic), base_frame);
}

LidarExtrinsics BagReader::extrinsicsOf(const std::string& laser_frame,
                                        const std::string& base_frame) const {
  const std::string base = stripLeadingSlash(base_frame);
  std::string frames;
  if (const auto transform = transformOf(laser_frame, base, &frames)) {
    return toLidarExtrinsics(*transform);
  }
  throw BagError(
      names() + ": /tf_static and /tf have no transform from '" + base +
      "' to the lidar's frame '" + printable(laser_frame) +
      "'; set it with --laser-pose; known frames: " + (frames.empty() ? "none" : frames));
}

std::optional<geometry_msgs::Quaternion> BagReader::imuRotation(
    const std::string& imu_topic, const std::string& base_frame) const {
  std::string imu_frame;
  visitMessages({imu_topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    imu_frame = stripLeadingSlash(readMessage<sensor_msgs::Imu>(instance)->header.frame_id);
    return false;
  });
  const std::string base = stripLeadingSlash(base_frame);
  if (imu_frame == base) return quaternionOf(0.0);
  std::string frames;
  const auto transform = transformOf(imu_frame, base, &frames);
  if (!transform) return std::nullopt;
  return transform->rotation;
}

}  // namespace racecar_mcl
