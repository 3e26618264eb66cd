// Reads one message of a bag, which may be damaged.
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/serialization.h>
#include <rosbag/message_instance.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {

/// A message that cannot be read; the text continues "message 3 of /scan ".
struct RecordedMessageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads the lengths of arrays in a serialized message.
class ArrayLengths {
 public:
  explicit ArrayLengths(std::vector<std::uint8_t>* bytes)
      : stream_(bytes->data(), static_cast<std::uint32_t>(bytes->size())) {}

  /// Skips this number of bytes. Throws StreamOverrunException at the end of the message.
  void skip(std::uint32_t bytes) { stream_.advance(bytes); }

  /// Reads a length and skips the elements. Throws RecordedMessageError if the message is too short
  /// for them: deserializing would first allocate them.
  void skipArray(std::uint32_t bytes_per_element) {
    std::uint32_t length = 0;
    stream_.next(length);
    const auto bytes = static_cast<std::uint64_t>(length) * bytes_per_element;
    if (bytes > stream_.getLength()) {
      throw RecordedMessageError("is damaged: an array has " + std::to_string(length) +
                                 " elements, but the message ends after " +
                                 std::to_string(stream_.getLength()) + " bytes");
    }
    skip(static_cast<std::uint32_t>(bytes));
  }

 private:
  ros::serialization::IStream stream_;
};

/// Strings are not allocated before they are found: nothing to check.
inline void checkArrays(const ArrayLengths& /*lengths*/, const nav_msgs::Odometry* /*type*/) {}
inline void checkArrays(const ArrayLengths& /*lengths*/, const sensor_msgs::Imu* /*type*/) {}

inline void checkArrays(ArrayLengths lengths, const sensor_msgs::LaserScan* /*type*/) {
  lengths.skip(12);      // sequence number and stamp
  lengths.skipArray(1);  // frame
  lengths.skip(28);      // angles, times and limits
  lengths.skipArray(4);  // ranges
  lengths.skipArray(4);  // intensities
}

inline void checkArrays(ArrayLengths lengths, const tf2_msgs::TFMessage* /*type*/) {
  lengths.skipArray(76);  // transforms with empty frames
}

/// Throws RecordedMessageError if the message is damaged or of another type.
template <typename Message>
typename Message::ConstPtr readMessage(const rosbag::MessageInstance& instance) {
  namespace traits = ros::message_traits;
  if (instance.getMD5Sum() != traits::MD5Sum<Message>::value()) {
    throw RecordedMessageError("is " + printable(instance.getDataType()) +
                               " with another message definition than this program's");
  }
  try {
    std::vector<std::uint8_t> bytes(instance.size());
    ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    instance.write(out);
    checkArrays(ArrayLengths(&bytes), static_cast<const Message*>(nullptr));
    ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    const auto message = boost::make_shared<Message>();
    ros::serialization::deserialize(in, *message);
    return message;
  } catch (const ros::serialization::StreamOverrunException& error) {
    throw RecordedMessageError(std::string("is truncated: ") + error.what());
  } catch (const std::bad_alloc&) {
    throw RecordedMessageError("is damaged: its length exceeds the memory");
  }
}

}  // namespace racecar_mcl
