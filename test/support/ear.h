// Keeps the newest message of a topic, and counts.
#pragma once

#include <ros/node_handle.h>

#include <mutex>
#include <string>

namespace racecar_mcl {

/// Its callbacks run in the threads of whoever spins the handle's queue.
template <typename Message>
class Ear {
 public:
  Ear(ros::NodeHandle& node, const std::string& topic)
      : subscriber_(node.subscribe<Message>(
            topic, 50, [this](const boost::shared_ptr<const Message>& message) {
              const std::lock_guard<std::mutex> lock(mutex_);
              newest_ = *message;
              ++count_;
            })) {}
  ~Ear() { subscriber_.shutdown(); }
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  /// An empty message before the first.
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
