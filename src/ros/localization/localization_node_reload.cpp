// Part of LocalizationNode: changes parameters while it runs.
#include "racecar_mcl/localizer/parameter_registry.h"
#include "ros/localization/localization_node.h"

namespace racecar_mcl {

void LocalizationNode::advertisePrivateServices() {
  services_.push_back(reload_node_.advertiseService("reload_parameters",
                                                    &LocalizationNode::onReloadParameters, this));
  services_.push_back(
      reload_node_.advertiseService("save_pose", &LocalizationNode::onSavePose, this));
#ifdef RACECAR_MCL_HAS_DYNAMIC_RECONFIGURE
  reconfigure_server_ = std::make_unique<ReconfigureServer>(reload_node_, parameters_, [this] {
    std_srvs::Trigger trigger;
    onReloadParameters(trigger.request, trigger.response);
    return parameters_;
  });
#endif
}

bool LocalizationNode::onReloadParameters(std_srvs::Trigger::Request&,
                                          std_srvs::Trigger::Response& response) {
  try {
    const NodeParameters parameters = readNodeParameters(private_node_);
    response.message = changesBetween(parameters_, parameters);
    requireNoRestart(parameters_, parameters);
    runOn(&map_builder_, [&] { changeParameters(parameters); });
    response.success = true;
    ROS_INFO("parameters changed: %s", response.message.c_str());
#ifdef RACECAR_MCL_HAS_DYNAMIC_RECONFIGURE
    reconfigure_server_->publish(parameters_);
#endif
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    reportRejection(nullptr, "parameters not changed", response.message);
  }
  return true;
}

void LocalizationNode::changeParameters(const NodeParameters& parameters) {
  // The worker continues with the old map meanwhile. Maps are only replaced after this task.
  std::shared_ptr<const LocalizationMap> map;
  runOn(&worker_, [&] { map = localizer_.map(); });
  if (map && needsNewMap(parameters_.localizer, parameters.localizer)) {
    map = makeLocalizationMap(map->grid, parameters.localizer);
  }
  runOn(&worker_, [&] {
    localizer_.setParameters(parameters.localizer, map);
    const std::lock_guard<std::mutex> lock(mutex_);
    // The other parameters are equal, and callbacks read them without a lock.
    parameters_.localizer = parameters.localizer;
    parameters_.transform_tolerance = parameters.transform_tolerance;
    parameters_.input_timeout = parameters.input_timeout;
    parameters_.visualization_rate = parameters.visualization_rate;
    parameters_.obstacles = parameters.obstacles;
    watchdog_.setTimeout(parameters.input_timeout);
    publisher_.setParameters(parameters);
    obstacle_publisher_.setParameters(parameters);
    if (parameters.diagnostics_rate == parameters_.diagnostics_rate) return;
    parameters_.diagnostics_rate = parameters.diagnostics_rate;
    diagnostics_timer_.setPeriod(ros::WallDuration(1.0 / parameters.diagnostics_rate));
  });
}

}  // namespace racecar_mcl
