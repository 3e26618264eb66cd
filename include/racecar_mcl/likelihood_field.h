// The sensor model without rays: a beam is likely where it ends near an obstacle (Probabilistic
// Robotics, section 6.4).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/range_caster.h"
#include "racecar_mcl/scan.h"
#include "racecar_mcl/surfaces.h"

namespace racecar_mcl {

struct LikelihoodFieldParameters {
  double field_sigma = 0.045;     ///< m, distance from an obstacle at which a beam counts half
  double field_rand = 0.1;        ///< share of beams that end anywhere, in (0, 1)
  double field_max_range = 30.0;  ///< m, longer beams and those without a return are not weighed
  double field_squash = 6.5;      ///< a particle's weight is the product of its beams to the power
                                  ///< 1 / this
  double field_inside = 0.1;  ///< what a metre behind the surface of a blurred wall counts against
                              ///< one in front of it, in [0, 1]
};

/// Throws ParameterError on a value out of range.
void validate(const LikelihoodFieldParameters& parameters);

/// The log-likelihood of a beam that ends at a distance d from the nearest surface,
///
///   log((1 - field_rand) / (1 + (d / field_sigma)^2) + field_rand).
///
/// Surfaces are what findSurfaces gives; inside a blurred wall d counts field_inside of its length,
/// for the true surface may lie anywhere in there. The values are stored per cell and interpolated
/// between cell centres, so that the result does not jump from cell to cell. The tails are a
/// Cauchy's, not a Gaussian's: maps are wrong by more than their lidar's noise. A beam that ends
/// outside the map, by more than four field_sigma, counts as field_rand.
class LikelihoodField {
 public:
  LikelihoodField(const OccupancyGrid& grid, const LikelihoodFieldParameters& parameters);
  /// The same, with what findSurfaces gave of the grid.
  LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                  const LikelihoodFieldParameters& parameters);

  /// The squashed log-likelihood of one scan from each of N lidar poses (map frame): N values.
  void logLikelihood(const PoseBatch& lidar_in_map, const Scan& beams,
                     Eigen::Ref<Eigen::ArrayXd> log_likelihood) const;

  /// Of each beam alone, not squashed; NaN where it is not weighed.
  void beamLogLikelihoods(const Pose2& lidar_in_map, const Scan& beams,
                          Eigen::Ref<Eigen::ArrayXf> log_likelihoods) const;
  Eigen::ArrayXf beamLogLikelihoods(const Pose2& lidar_in_map, const Scan& beams) const;
  /// Of a beam that ends `distance` m from the nearest surface.
  double logLikelihoodAt(double distance) const;
  /// m, the distance from the nearest surface of a beam with this log-likelihood.
  double distanceOf(double log_likelihood) const;

  /// The exponent of a particle's weight is 1 / this.
  double squash() const { return parameters_.field_squash; }

  std::size_t memoryBytes() const { return log_field_.size() * sizeof(float); }

 private:
  LikelihoodFieldParameters parameters_;
  GridGeometry geometry_;  ///< of the field: the map's and a margin around it
  float max_range_;
  float squash_;
  float log_rand_;
  std::vector<float> log_field_;  ///< row by row, one value per cell centre
};

}  // namespace racecar_mcl
