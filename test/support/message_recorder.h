// Records the newest message of a topic and counts messages.
#pragma once

#include <ros/node_handle.h>

#include <mutex>
#include <string>

namespace racecar_mcl {

/// Callbacks run in the threads that process the handle's queue.
template <typename Message>
class MessageRecorder {
 public:
  MessageRecorder(ros::NodeHandle& node, const std::string& topic)
      : subscriber_(node.subscribe<Message>(
            topic, 50, [this](const boost::shared_ptr<const Message>& message) {
              const std::lock_guard<std::mutex> lock(mutex_);
              newest_ = *message;
              ++count_;
            })) {}
  ~MessageRecorder() { subscriber_.shutdown(); }
  MessageRecorder(const MessageRecorder&) = delete;
  MessageRecorder& operator=(const MessageRecorder&) = delete;

  /// A default-constructed message before the first.
  Message newest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return newest_;
  }
  int count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return count_;
  }

 private:
  mutable std::mutex mutex_;
  Message newest_;
  int count_ = 0;
  ros::Subscriber subscriber_;
};

}  // namespace racecar_mcl
