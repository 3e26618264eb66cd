#include "racecar_mcl/sensor/scan_likelihood.h"

#include "simd/vector_math.h"

namespace racecar_mcl {

void ScanLikelihood::evaluate(const ParticleSet& particles, const Scan& scan, SensorModel* model,
                              Eigen::ArrayXd* log_likelihoods) {
  const int size = static_cast<int>(particles.size());
  lidar_x_.resize(size);
  lidar_y_.resize(size);
  lidar_yaw_.resize(size);
  const double* const x = particles.x.data();
  const double* const y = particles.y.data();
  const double* const yaw = particles.yaw.data();
  double* __restrict const lidar_x = lidar_x_.data();
  double* __restrict const lidar_y = lidar_y_.data();
  double* __restrict const lidar_yaw = lidar_yaw_.data();
  runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
    const Pose2 laser = scan.laser_in_base;
    for (int i = 0; i < size; ++i) {
      double sine, cosine;
      sinCos(yaw[i], &sine, &cosine);
      lidar_x[i] = x[i] + cosine * laser.x - sine * laser.y;
      lidar_y[i] = y[i] + sine * laser.x + cosine * laser.y;
      lidar_yaw[i] = yaw[i] + laser.yaw;
    }
  });
  log_likelihoods->resize(size);
  model->logLikelihoods({lidar_x, lidar_y, lidar_yaw, size}, scan, *log_likelihoods);
}

}  // namespace racecar_mcl
