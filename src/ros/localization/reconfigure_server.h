// Parameters over the topics and the service of dynamic_reconfigure, for rqt_reconfigure.
//
// The parameters come from the registry at run time: there is no .cfg file that could differ from
// it. Only the messages of dynamic_reconfigure are needed.
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include <functional>

#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

class ReconfigureServer {
 public:
  /// Advertises below `private_node`. `reload` reads the parameter server, and returns the
  /// parameters in use afterwards; it reports a refusal itself. `parameters`: those in use now.
  ReconfigureServer(const ros::NodeHandle& private_node, const NodeParameters& parameters,
                    std::function<NodeParameters()> reload);

  /// Publishes the parameters in use, after another change.
  void publish(const NodeParameters& parameters);

 private:
  bool onSetParameters(dynamic_reconfigure::Reconfigure::Request& request,
                       dynamic_reconfigure::Reconfigure::Response& response);

  ros::NodeHandle private_node_;
  std::function<NodeParameters()> reload_;
  dynamic_reconfigure::Config current_;  ///< the values in use
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

}  // namespace racecar_mcl
