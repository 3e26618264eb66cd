#include "racecar_mcl/sensor_table.h"

#include <cmath>
#include <sstream>
#include <utility>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {

void validate(const SensorTableParameters& p) {
  std::ostringstream problem;
  const std::pair<const char*, double> shares[] = {{"alpha_hit", p.alpha_hit},
                                                   {"alpha_short", p.alpha_short},
                                                   {"alpha_max", p.alpha_max},
                                                   {"alpha_rand", p.alpha_rand}};
  double sum = 0.0;
  for (const auto& [name, value] : shares) {
    if (!std::isfinite(value) || value < 0.0 || value > 1.0) {
      problem << name << " is " << value << "; it must lie in [0, 1]";
      throw ParameterError(problem.str());
    }
    sum += value;
  }
  if (std::abs(sum - 1.0) > 1e-3) {
    problem << "alpha_hit + alpha_short + alpha_max + alpha_rand is " << sum
            << "; the four shares must sum to 1";
  } else if (p.alpha_hit + p.alpha_max + p.alpha_rand == 0.0) {
    problem << "alpha_short is " << p.alpha_short
            << "; it cannot be the only share, for nothing comes short of a range of 0";
  } else if (!std::isfinite(p.sigma_hit) || p.sigma_hit <= 0.0) {
    problem << "sigma_hit is " << p.sigma_hit << " pixels; it must be positive";
  } else if (p.table_width < 2 || p.table_width > 4001) {
    problem << "table_width is " << p.table_width << " pixels; it must lie in [2, 4001]";
  }
  if (!problem.str().empty()) throw ParameterError(problem.str());
}

Eigen::ArrayXXd makeSensorTable(const SensorTableParameters& p) {
  validate(p);
  const int width = p.table_width;
  const double z_max = width - 1;
  const Eigen::ArrayXd z = Eigen::ArrayXd::LinSpaced(width, 0.0, z_max);
  Eigen::ArrayXXd table(width, width);
  for (int column = 0; column < width; ++column) {
    const double d = column;
    const Eigen::ArrayXd hit = (-0.5 * ((z - d) / p.sigma_hit).square()).exp();
    Eigen::ArrayXd mix = p.alpha_hit * hit / hit.sum() + p.alpha_rand / z_max;
    if (column > 0) {
      mix.head(column + 1) += p.alpha_short * (2.0 / d) * (1.0 - z.head(column + 1) / d);
    }
    mix[width - 1] += p.alpha_max;
    table.col(column) = mix / mix.sum();
  }
  return table;
}

}  // namespace racecar_mcl
