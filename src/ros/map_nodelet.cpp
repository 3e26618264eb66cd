#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ros/map_source.h"

namespace racecar_mcl {

/// The map source as a nodelet. Where the map cannot be read it stays loaded but offers nothing,
/// with the reason in the log.
class MapNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      source_ = std::make_unique<MapSource>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("no map is served: %s", error.what());
    }
  }

  std::unique_ptr<MapSource> source_;
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::MapNodelet, nodelet::Nodelet)
