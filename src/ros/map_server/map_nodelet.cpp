// The map server as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/map_server/map_server.h"
#include "ros/util/nodelet_adapter.h"

namespace racecar_mcl {

struct MapNodelet : NodeletAdapter<MapServer> {
  MapNodelet() : NodeletAdapter("not serving a map") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::MapNodelet, nodelet::Nodelet)
