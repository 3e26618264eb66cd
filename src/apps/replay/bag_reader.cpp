#include "bag_reader.h"

#include <rosbag/query.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace racecar_mcl {
namespace {

/// Topics were recorded with and without the leading slash.
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
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

template <typename Message>
typename Message::ConstPtr read(const rosbag::MessageInstance& instance) {
  const typename Message::ConstPtr message = instance.instantiate<Message>();
  if (!message) {
    throw BagError("a message on " + instance.getTopic() + " is " + instance.getDataType() +
                   " of another definition than this program's");
  }
  return message;
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
      bag->open(path, rosbag::bagmode::Read);
    } catch (const rosbag::BagUnindexedException&) {
      throw BagError(path + ": the bag has no index, as after a recording that was cut short; " +
                     "'rosbag reindex' restores it");
    } catch (const std::exception& error) {
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
  const double lasts = all.from <= all.to ? (all.to - all.from).toSec() : 0.0;
  if (span.start > 0.0 && span.start >= lasts) {
    std::ostringstream problem;
    problem << names() << ": nothing was recorded from " << span.start
            << " s on; the recording lasts " << lasts << " s";
    throw BagError(problem.str());
  }
  Interval interval;
  if (span.start > 0.0) interval.from = all.from + ros::Duration(span.start);
  if (span.start + span.duration < lasts) {
    interval.to = all.from + ros::Duration(span.start + span.duration);
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
    text += (text.empty() ? "" : ", ") + topic + " (" + type + ")";
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
  throw BagError(names() + ": no topic " + topic + " of type " + type + "; " + option +
                 " names another; recorded were: " + contents());
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
  try {
    rosbag::View view;
    addQueries(topics, interval, &view);
    for (const rosbag::MessageInstance& instance : view) {
      if (!visit(instance)) return;
    }
  } catch (const rosbag::BagException& error) {
    throw BagError(names() + ": the bag is broken: " + error.what());
  } catch (const ros::serialization::StreamOverrunException& error) {
    throw BagError(names() + ": the bag holds a message that is cut short: " + error.what());
  }
}

void BagReader::forEach(const std::string& scan_topic, const std::string& odometry_topic,
                        const std::function<void(const BagEvent&)>& visit) const {
  forEach(scan_topic, odometry_topic, read<nav_msgs::Odometry>, visit);
}

void BagReader::forEach(const std::string& scan_topic, const TfFrames& frames,
                        const std::function<void(const BagEvent&)>& visit) const {
  requireOdometry(frames);
  const std::unique_ptr<TfOdometry> odometry = tfOdometry(frames);
  const auto odometry_of = [&](const rosbag::MessageInstance& instance) {
    return odometry->add(*read<tf2_msgs::TFMessage>(instance), false);
  };
  forEach(scan_topic, "/tf", odometry_of, visit);
}

std::unique_ptr<TfOdometry> BagReader::tfOdometry(const TfFrames& frames) const {
  auto odometry = std::make_unique<TfOdometry>(stripLeadingSlash(frames.odom),
                                               stripLeadingSlash(frames.base), frames.clock_jump);
  visitMessages({"/tf_static"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    odometry->add(*read<tf2_msgs::TFMessage>(instance), true);
    return true;
  });
  return odometry;
}

void BagReader::requireOdometry(const TfFrames& frames) const {
  const std::unique_ptr<TfOdometry> odometry = tfOdometry(frames);
  std::set<std::string> known;
  bool found = false;
  visitMessages({"/tf"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    const auto message = read<tf2_msgs::TFMessage>(instance);
    for (const geometry_msgs::TransformStamped& transform : message->transforms) {
      known.insert(stripLeadingSlash(transform.header.frame_id) + " -> " +
                   stripLeadingSlash(transform.child_frame_id));
    }
    found = odometry->add(*message, false) != nullptr;
    return !found;
  });
  if (found) return;
  throw BagError(names() + ": /tf holds no odometry " + stripLeadingSlash(frames.odom) + " -> " +
                 stripLeadingSlash(frames.base) + "; --odom-frame and --base-frame name others; " +
                 "recorded were: " + (known.empty() ? "none" : joined(known)));
}

void BagReader::forEach(
    const std::string& scan_topic, const std::string& odometry_topic,
    const std::function<nav_msgs::OdometryConstPtr(const rosbag::MessageInstance&)>& odometry_of,
    const std::function<void(const BagEvent&)>& visit) const {
  // Scans wait here until all odometry recorded at the same time is through.
  std::vector<BagEvent> scans;
  const auto flush = [&] {
    for (const BagEvent& scan : scans) visit(scan);
    scans.clear();
  };
  visitMessages({scan_topic, odometry_topic}, interval_,
                [&](const rosbag::MessageInstance& instance) {
                  BagEvent event;
                  event.recorded = instance.getTime();
                  if (!scans.empty() && event.recorded != scans.front().recorded) flush();
                  if (sameTopic(instance.getTopic(), scan_topic)) {
                    event.scan = read<sensor_msgs::LaserScan>(instance);
                    scans.push_back(event);
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
    visit(*read<sensor_msgs::LaserScan>(instance));
    return true;
  });
}

void BagReader::forEachOdometry(const std::string& topic,
                                const std::function<void(const nav_msgs::Odometry&)>& visit) const {
  visitMessages({topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    visit(*read<nav_msgs::Odometry>(instance));
    return true;
  });
}

sensor_msgs::LaserScan::ConstPtr BagReader::firstScan(const std::string& topic) const {
  sensor_msgs::LaserScan::ConstPtr scan;
  visitMessages({topic}, interval_, [&](const rosbag::MessageInstance& instance) {
    scan = read<sensor_msgs::LaserScan>(instance);
    return false;
  });
  if (!scan) throw BagError(names() + ": " + topic + " holds no scan within the time asked for");
  return scan;
}

Nanoseconds BagReader::firstScanStamp(const std::string& topic) const {
  return toNanoseconds(firstScan(topic)->header.stamp);
}

Trajectory BagReader::readPoses(const std::string& topic) const {
  std::vector<StampedPose> poses;
  visitMessages({topic}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    const auto message = read<nav_msgs::Odometry>(instance);
    poses.push_back({toNanoseconds(message->header.stamp), toPose2(message->pose.pose)});
    return true;
  });
  return inOrder(std::move(poses));
}

LaserMount BagReader::laserMount(const std::string& scan_topic,
                                 const std::string& base_frame) const {
  const std::string laser_frame = stripLeadingSlash(firstScan(scan_topic)->header.frame_id);
  const std::string base = stripLeadingSlash(base_frame);

  tf2::BufferCore transforms;
  visitMessages({"/tf_static"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
    insertTransforms(*read<tf2_msgs::TFMessage>(instance), true, &transforms);
    return true;
  });
  const auto known = [&] { return transforms.canTransform(base, laser_frame, ros::Time(0)); };
  bool found = known();
  if (!found) {
    visitMessages({"/tf"}, Interval{}, [&](const rosbag::MessageInstance& instance) {
      insertTransforms(*read<tf2_msgs::TFMessage>(instance), false, &transforms);
      found = known();
      return !found;
    });
  }
  if (!found) {
    std::vector<std::string> frames;
    transforms._getFrameStrings(frames);
    const std::string text = joined({frames.begin(), frames.end()});
    throw BagError(names() + ": /tf_static and /tf do not tell where the lidar's frame '" +
                   laser_frame + "' sits on '" + base +
                   "'; --laser-pose says it; frames known: " + (text.empty() ? "none" : text));
  }
  return toLaserMount(transforms.lookupTransform(base, laser_frame, ros::Time(0)).transform);
}

}  // namespace racecar_mcl
