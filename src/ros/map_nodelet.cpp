// The map source as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/map_source.h"
#include "ros/nodelet_of.h"

namespace racecar_mcl {

struct MapNodelet : NodeletOf<MapSource> {
  MapNodelet() : NodeletOf("no map is served") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::MapNodelet, nodelet::Nodelet)
