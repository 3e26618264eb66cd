// A node as a nodelet.
#pragma once

#include <nodelet/nodelet.h>

#include <exception>
#include <memory>

namespace racecar_mcl {

/// `Node` is made of the nodelet's two node handles. Where that throws, as on wrong parameters, the
/// nodelet stays loaded but does nothing, and "not_working: reason" is in the log.
template <typename Node>
class NodeletOf : public nodelet::Nodelet {
 protected:
  explicit NodeletOf(const char* not_working) : not_working_(not_working) {}

 private:
  void onInit() override {
    try {
      node_ = std::make_unique<Node>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", not_working_, error.what());
    }
  }

  const char* not_working_;
  std::unique_ptr<Node> node_;
};

}  // namespace racecar_mcl
