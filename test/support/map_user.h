// A map with the sensor models that a localizer uses.
#pragma once

#include <memory>
#include <utility>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/relocalization/search_map.h"

namespace racecar_mcl {

class MapUser {
 public:
  MapUser(std::shared_ptr<const LocalizationMap> map, const SensorParameters& sensor,
          int threads = 1)
      : map_(std::move(map)),
        model_(makeSensorModel(*map_, sensor, threads)),
        coarse_(map_->matcher.field(), threads) {}

  const LocalizationMap& map() const { return *map_; }
  SensorModel* model() { return model_.get(); }
  SearchMap searchMap() { return {map_->view(), map_->matcher, model_.get()}; }

  /// Uses the coarse field until the filter has converged.
  const UpdateResult& update(ParticleFilter* filter, const Scan& scan,
                             double decorrelation_distance = 0.0) {
    const MapView view = map_->view();
    SensorModel* const model = filter->converged() ? model_.get() : &coarse_;
    return filter->update(scan, model, &view, decorrelation_distance);
  }

  /// Particles drawn from the free space.
  void initializeGlobally(ParticleFilter* filter) const {
    filter->initializeGlobally([this](Eigen::Index count, Random& random) {
      return sampleFreeSpace(*map_, count, random);
    });
  }

 private:
  std::shared_ptr<const LocalizationMap> map_;
  std::unique_ptr<SensorModel> model_;
  LikelihoodFieldModel coarse_;
};

}  // namespace racecar_mcl
