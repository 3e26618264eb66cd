// Buffer of gyro measurements: how far the car turned between any two times.
#pragma once

#include <deque>
#include <optional>

namespace racecar_mcl {

/// One measurement of a gyro.
struct GyroSample {
  double stamp = 0.0;     ///< s
  double yaw_rate = 0.0;  ///< about the base frame's z axis, rad/s, or the unit of a wrong driver
};

enum class GyroOutcome {
  kUsed,
  kNotFinite,       ///< NaN or inf: dropped
  kImplausible,     ///< over 5000 rad/s (or degrees): dropped
  kOutOfOrder,      ///< not newer than the newest: dropped
  kGap,             ///< used; turns over the gap are unknown
  kTimeJumpedBack,  ///< used; the buffer restarts with this sample
};

/// Text for logs and diagnostics.
const char* toString(GyroOutcome outcome);

/// The turn since the first sample, and the rate.
struct GyroState {
  double turn = 0.0;  ///< rad
  double rate = 0.0;  ///< rad/s
};

/// The last 10 s of a gyro, integrated by the trapezoidal rule. The mean rate while the car stands
/// is the gyro's bias, and is subtracted from then on (zero-rate update).
class GyroBuffer {
 public:
  /// `clock_jump`: s; a stamp older than the newest by this or more restarts the time.
  explicit GyroBuffer(double clock_jump = 1.0) : clock_jump_(clock_jump) {}

  /// `at_rest`: the car stands, according to its odometry.
  GyroOutcome add(const GyroSample& sample, bool at_rest);

  /// The state at a time; none before the first sample since a gap, and from 0.1 s after the
  /// newest.
  std::optional<GyroState> at(double stamp) const;

  bool empty() const { return entries_.empty(); }
  double bias() const { return bias_; }  ///< rad/s, measured at rest

  void reset() { entries_.clear(); }

  /// A copy without the samples that states from this time on do not need.
  GyroBuffer since(double stamp) const;

 private:
  struct Entry {
    double stamp;
    GyroState state;
  };

  void learnBias(double rate, double seconds, bool at_rest);

  double clock_jump_;
  double bias_ = 0.0;          ///< rad/s
  double rest_seconds_ = 0.0;  ///< s, of the average in bias_, at most its time constant
  std::deque<Entry> entries_;
};

}  // namespace racecar_mcl
