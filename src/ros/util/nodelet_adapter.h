// Adapts a node class to the nodelet interface.
#pragma once

#include <nodelet/nodelet.h>

#include <exception>
#include <memory>

namespace racecar_mcl {

/// Constructs `Node` from the nodelet's node handles. If that throws (such as on invalid
/// parameters), the nodelet stays loaded but inactive, and "not_working: reason" is logged.
template <typename Node>
class NodeletAdapter : public nodelet::Nodelet {
 protected:
  explicit NodeletAdapter(const char* not_working) : not_working_(not_working) {}

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
