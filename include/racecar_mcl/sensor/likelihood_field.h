// Likelihood field model of a range finder (Probabilistic Robotics, section 6.4): the likelihood of
// a beam depends on the distance of its end point from the nearest surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "racecar_mcl/geometry/pose_batch.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/map/surfaces.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

struct LikelihoodFieldParameters {
  double field_scale = 0.045;     ///< m, distance at which the hit likelihood is half its maximum
  double z_rand = 0.1;            ///< weight of beams that end anywhere, in (0, 1)
  double field_max_range = 30.0;  ///< m, longer beams and those without a return are not evaluated
  double likelihood_exponent = 37.0 / 240.0;  ///< of the product over the beams, in (0, 1], since
                                              ///< errors of neighbouring beams are correlated
  double inside_wall_factor = 0.1;  ///< factor on distances from surfaces inside blurred walls, in
                                    ///< [0, 1]
  double unmapped_likelihood = 0.67;  ///< minimum in the cells of findUnmapped, in [0, 1]; no
                                      ///< effect below z_rand
};

/// Throws ParameterError on a value out of range.
void validate(const LikelihoodFieldParameters& parameters);

/// The log-likelihood of a beam that ends at the distance d from the nearest surface is
///
///   log((1 - z_rand) / (1 + (d / field_scale)^2) + z_rand).
///
/// Surfaces are those of findSurfaces. Inside blurred walls d is multiplied by inside_wall_factor,
/// since the true surface may be anywhere inside, up to 2.6 m from a visible one. Values are stored
/// per cell, in 255 steps between log(z_rand) and 0, and interpolated bilinearly between cell
/// centres. The tails are those of a Cauchy distribution instead of a Gaussian: map errors are
/// larger than the lidar's noise. A beam that ends outside the map by more than four field_scale
/// has the likelihood z_rand. Only the surroundings of surfaces are stored.
class LikelihoodField {
 public:
  LikelihoodField(const OccupancyGrid& grid, const LikelihoodFieldParameters& parameters);
  /// The same, with the result of findSurfaces for the grid.
  LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                  const LikelihoodFieldParameters& parameters);
  /// The same, with unmapped_likelihood where `unmapped`, a mask over the cells, is 1.
  LikelihoodField(const GridGeometry& geometry, const Surfaces& surfaces,
                  const std::vector<std::uint8_t>& unmapped,
                  const LikelihoodFieldParameters& parameters);

  /// The log-likelihood of one scan from each of N lidar poses (map frame): N values, with the
  /// exponent.
  void logLikelihood(const PoseBatch& lidar_in_map, const Scan& beams,
                     Eigen::Ref<Eigen::ArrayXd> log_likelihood) const;

  /// The log-likelihood of each of K beams from each of N lidar poses: K x N, without the exponent;
  /// NaN for beams that are not evaluated.
  void beamLogLikelihoods(const PoseBatch& lidar_in_map, const Scan& beams,
                          Eigen::Ref<Eigen::ArrayXXf> log_likelihoods) const;
  Eigen::ArrayXf beamLogLikelihoods(const Pose2& lidar_in_map, const Scan& beams) const;
  /// The log-likelihood of a beam that ends `distance` (m) from the nearest surface.
  double logLikelihoodAt(double distance) const;
  /// The inverse of logLikelihoodAt: the distance from the nearest surface, m.
  double distanceOf(double log_likelihood) const;

  double scale() const { return parameters_.field_scale; }  ///< m
  double likelihoodExponent() const { return parameters_.likelihood_exponent; }

  std::size_t memoryBytes() const { return cells_.size() * sizeof(cells_[0]); }

 private:
  LikelihoodFieldParameters parameters_;
  GridGeometry geometry_;  ///< of the field: the surroundings of surfaces
  float max_range_;
  float exponent_;
  float log_rand_;
  float log_step_;  ///< of the stored values
  /// Row by row, values at the cell centres: in the low byte that of the cell, in the high byte
  /// that of the cell above it. Two neighbours in a row hold the four corners of an interpolation.
  std::vector<std::uint16_t> cells_;
};

}  // namespace racecar_mcl
