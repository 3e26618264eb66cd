#include "racecar_mcl/sensor/beam_table.h"

#include <cmath>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {

void validate(const BeamTableParameters& p) {
  requireShare("alpha_hit", p.alpha_hit);
  requireShare("alpha_short", p.alpha_short);
  requireShare("alpha_max", p.alpha_max);
  requireShare("alpha_rand", p.alpha_rand);
  const double at_zero = p.alpha_hit + p.alpha_max + p.alpha_rand;
  const double sum = at_zero + p.alpha_short;
  require(std::abs(sum - 1.0) <= 1e-3, "alpha_hit + alpha_short + alpha_max + alpha_rand", sum,
          "1");
  require(at_zero > 0.0, "alpha_short", p.alpha_short,
          "below 1, since no beam is short of an expected range of 0");
  requirePositive("sigma_hit", p.sigma_hit, "pixels");
  requireWithin("table_width", p.table_width, 2, 4001, "pixels");
}

Eigen::ArrayXXd makeBeamTable(const BeamTableParameters& p) {
  validate(p);
  const int width = p.table_width;
  const double z_max = width - 1;
  const Eigen::ArrayXd z = Eigen::ArrayXd::LinSpaced(width, 0.0, z_max);
  Eigen::ArrayXXd table(width, width);
  for (int column = 0; column < width; ++column) {
    const double d = column;
    const Eigen::ArrayXd hit = (-0.5 * ((z - d) / p.sigma_hit).square()).exp();
    Eigen::ArrayXd mixture = p.alpha_hit * hit / hit.sum() + p.alpha_rand / z_max;
    if (column > 0) {
      mixture.head(column + 1) += p.alpha_short * (2.0 / d) * (1.0 - z.head(column + 1) / d);
    }
    mixture[width - 1] += p.alpha_max;
    table.col(column) = mixture / mixture.sum();
  }
  return table;
}

}  // namespace racecar_mcl
