// The three nodelets in a loader of this process.
#pragma once

#include <nodelet/loader.h>

#include <boost/function.hpp>
#include <boost/make_shared.hpp>
#include <string>

#include "ros/localization/localization_node.h"
#include "ros/map_server/map_server.h"
#include "ros/simulation/simulator_node.h"
#include "ros/util/nodelet_adapter.h"

namespace racecar_mcl {

/// A nodelet manager without plugins: the distribution's manager is built without sanitizers, and
/// cannot load libraries that are built with them. Callbacks run in nodelet's own thread pool.
class NodeletHost {
 public:
  /// `node` is the name of a hosted class, such as "LocalizationNode".
  bool load(const std::string& name, const std::string& node) {
    return loader_.load(name, node, {}, {});
  }
  bool unload(const std::string& name) { return loader_.unload(name); }

 private:
  template <typename Node>
  struct Hosted : NodeletAdapter<Node> {
    Hosted() : NodeletAdapter<Node>("not hosted") {}
  };

  static boost::shared_ptr<nodelet::Nodelet> create(const std::string& node) {
    if (node == "MapServer") return boost::make_shared<Hosted<MapServer>>();
    if (node == "SimulatorNode") return boost::make_shared<Hosted<SimulatorNode>>();
    return boost::make_shared<Hosted<LocalizationNode>>();
  }

  using Create = boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string&)>;
  nodelet::Loader loader_{Create(&NodeletHost::create)};
};

}  // namespace racecar_mcl
