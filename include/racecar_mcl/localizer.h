// The event level: odometry and scans in, the pose of the car at any time out. The one object that
// the nodelet, the offline replay and the tests all drive. It reads no clock, owns no thread and
// knows no ROS.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "racecar_mcl/hypothesis_verifier.h"
#include "racecar_mcl/lidar_odometry.h"
#include "racecar_mcl/odometry.h"
#include "racecar_mcl/odometry_calibration.h"
#include "racecar_mcl/odometry_doubt.h"
#include "racecar_mcl/particle_filter.h"
#include "racecar_mcl/protection_level.h"
#include "racecar_mcl/range_bias.h"
#include "racecar_mcl/recovery_policy.h"
#include "racecar_mcl/scan.h"
#include "racecar_mcl/sweep_order.h"
#include "racecar_mcl/verdict.h"

namespace racecar_mcl {

enum class BeamLayout {
  kEven,   ///< bearings evenly spread
  kBoxed,  ///< end points evenly spread over the walls of a corridor
};

struct LocalizerParameters {
  ParticleFilterParameters filter;
  MotionModelParameters motion;
  SensorParameters sensor;
  OdometryParameters odometry;
  OdometryCalibrationParameters calibration;
  RangeBiasParameters range_bias;
  double map_error_distance = 1.5;  ///< m; scans closer together than this times the share of
                                    ///< beams that the map fails to explain err alike and count in
                                    ///< part
  bool noise_adaptation = true;     ///< more motion noise while scans contradict the odometry
  VerdictParameters verdict;
  ProtectionLevelParameters protection;
  int num_beams_per_particle = 240;
  double scan_field_of_view = 6.2832;  ///< rad, beams outside are not used
  BeamLayout beam_layout = BeamLayout::kBoxed;
  double beam_box_aspect = 2.0;  ///< length by width of the corridor of a boxed layout
  int min_beams = 10;            ///< a scan with fewer valid beams is not used
  bool deskew = true;            ///< correct for the car's motion during the sweep
  SweepOrderFrom sweep_order = SweepOrderFrom::kLearned;  ///< in which the beams were taken
  bool global_search = true;   ///< a global start begins where the first scan fits, not evenly
  bool second_opinion = true;  ///< trust a search of the map once a second one agrees
  bool lidar_odometry = true;  ///< while the map is silent, match scans with the scans before them
  bool recovery = true;        ///< search the map for another place while scans contradict it
  bool reject_short_returns = false;  ///< leave out beams that something unmapped stopped, while
                                      ///< localized
  int parked_updates =
      40;  ///< scans weighed after the car has stopped; more of the same view is no news
};

/// Throws ParameterError naming the parameter, its value and the allowed range.
void validate(const LocalizerParameters& parameters);

/// The map model that these parameters ask for: makeMapModel with their sensor.
std::shared_ptr<MapModel> makeMapModel(OccupancyGrid grid, const LocalizerParameters& parameters);

/// The beams of a scan that these parameters ask for.
Scan chooseBeams(const LocalizerParameters& parameters, const Scan& scan);

enum class ScanOutcome {
  kUsed,
  kParked,          ///< the car stands and enough was seen from here: the estimate stays
  kNoMap,           ///< dropped: no map yet
  kNoStart,         ///< dropped: no start pose yet
  kNotFinite,       ///< dropped: the stamp is not finite
  kRepeatedStamp,   ///< dropped
  kOutOfOrder,      ///< dropped: older than the last scan
  kTooFewBeams,     ///< dropped: fewer than min_beams valid ones in the field of view
  kTimeJumpedBack,  ///< dropped: the clock started again; the pose is kept and the next scan is
                    ///< used
  kWeightsVanished  ///< no particle could have seen it: motion applied, weights kept
};

/// Words for logs and diagnostics.
std::string describe(ScanOutcome outcome);

/// Whether the scan was compared with the map, so that its result carries an estimate of its stamp.
bool leavesEstimate(ScanOutcome outcome);

/// What became of one scan.
struct ScanResult {
  ScanOutcome outcome = ScanOutcome::kNoMap;
  double stamp = 0.0;       ///< s, the scan's
  Verdict verdict;          ///< on the estimate, whatever became of the scan
  ScanFit fit;              ///< from the estimate, where there is one
  double range_bias = 0.0;  ///< m, that was taken from the ranges
  UpdateResult
      update;  ///< filled when outcome is kUsed or kWeightsVanished; the estimate also when kParked
};

/// Everything received, by fate.
struct LocalizerCounters {
  std::uint64_t scans_seen = 0;
  std::uint64_t scans_used = 0;
  std::uint64_t scans_parked = 0;
  std::uint64_t scans_dropped = 0;
  std::uint64_t weights_vanished = 0;
  std::uint64_t odometry_seen = 0;
  std::uint64_t odometry_used = 0;
  std::uint64_t odometry_dropped = 0;
  std::uint64_t odometry_gaps = 0;
  std::uint64_t time_jumps = 0;
  std::uint64_t scans_failed = 0;  ///< given up after an error in the program
  std::uint64_t recoveries = 0;    ///< searches after which particles were put where the scan fits
};

class Localizer {
 public:
  /// A scan on its way through the filter: made by `prepareScan`, worked on by `processScan`, taken
  /// in by `commitScan`.
  struct ScanTask {
    ScanResult result;
    Scan beams;                    ///< chosen and deskewed
    std::optional<Scan> mirrored;  ///< the same, had they been taken the other way about
    Motion motion;                 ///< since the scan before
    PoseEstimate before;           ///< at the scan before
    PoseEstimate predicted;        ///< at the scan's stamp, by odometry alone
    Pose2 correction;              ///< where the scan put the car, seen from `predicted`
    double repeat_distance = 0.0;  ///< m; scans closer together than that err alike
    double turned = 0.0;           ///< rad, during the sweep
    double order_log_odds = 0.0;   ///< of `beams` against `mirrored`, from the estimate
    bool weigh = false;
    bool reject_short = false;   ///< leave short returns out of the weighing
    bool carry = false;          ///< the map is silent: refine the motion by the scans before
    bool search = false;         ///< start where the scan fits
    bool challenge = false;      ///< look for a place that explains what this one contradicts
    bool was_localized = false;  ///< at any time since the start
    bool recovered = false;      ///< another place was proven and taken
    bool rejected = false;       ///< a search for another place has come to nothing
    bool asked = false;          ///< a second search has begun

    /// To another place: `correction` says nothing of the way there.
    bool moved() const { return search || recovered; }
  };

  /// Throws as `validate` does.
  Localizer(const LocalizerParameters& parameters, std::uint64_t seed);

  /// Swaps in a new map; the particles stay where they are.
  void setMap(std::shared_ptr<MapModel> map);
  bool hasMap() const { return map_ != nullptr; }
  const MapModel* map() const { return map_.get(); }

  /// Starts around a pose that holds now, that is at the newest stamp seen. Throws as
  /// ParticleFilter::initialize.
  void initialize(const PoseEstimate& start);
  /// Starts anywhere on the map; with global_search the next scan then says where. Without a map it
  /// returns false and changes nothing.
  bool initializeGlobally();
  bool initialized() const { return anchor_.has_value(); }

  OdometryOutcome addOdometry(const OdometrySample& sample);

  /// True when odometry reaches up to this stamp, so that a scan need not guess the last bit of
  /// motion. Odometry that is known to be late is not waited for any longer.
  bool odometryCovers(double stamp) const {
    return !odometry_.empty() &&
           odometry_.newestStamp() >= stamp + std::min(0.0, calibration_.delay());
  }

  /// prepareScan, processScan and commitScan in one.
  ScanResult addScan(const Scan& scan);

  /// The three parts of addScan, for a driver that takes odometry while a scan is being processed.
  /// Prepare and commit are short and touch what addOdometry and estimateAt touch; process is long
  /// and touches only particles and map. No start and no new map may come between the three.
  ScanTask prepareScan(const Scan& scan);
  void processScan(ScanTask* task);
  ScanResult commitScan(const ScanTask& task);

  /// After an exception in processScan, in place of commitScan: the scan is lost, and the
  /// particles, which may have been moved already, are drawn anew from the last estimate.
  void abandonScan();

  /// The pose at a time, carried there from the last scan by odometry; none before a start. Times
  /// before the last scan are carried backwards.
  std::optional<PoseEstimate> estimateAt(double stamp) const;
  /// The newest stamp of a scan or odometry message; none before the first.
  std::optional<double> newestStamp() const;
  /// The order in which the lidar takes its beams, as far as it is known.
  const SweepOrder& sweepOrder() const { return sweep_order_; }
  /// m, ranges measured less distances mapped, as far as it is known.
  double rangeBias() const { return range_bias_.bias(); }
  /// The newest odometry twist; zero before the first.
  Twist2 twist() const { return odometry_.empty() ? Twist2{} : odometry_.newestTwist(); }

  /// The next scan is weighed even if the car is parked.
  void requestUpdate() { scans_since_stop_ = 0; }

  const ParticleSet& particles() const { return filter_.particles(); }
  /// On the newest estimate.
  const Verdict& verdict() const { return judge_.verdict(); }
  const LocalizerCounters& counters() const { return counters_; }
  const LocalizerParameters& parameters() const { return parameters_; }

 private:
  /// The estimate that poses are carried from, and what odometry had summed up there.
  struct Anchor {
    PoseEstimate estimate;
    OdometryState odometry;
  };

  /// What odometry had summed up when the car was where it was at this time.
  OdometryState odometryAt(double stamp) const {
    return odometry_.at(stamp + calibration_.delay());
  }
  /// From the last estimate to there.
  Motion motionTo(const OdometryState& odometry) const;
  ScanOutcome admit(const Scan& scan);
  void straighten(const OdometryState& at_stamp, ScanTask* task) const;
  void weigh(ScanTask* task);
  void verify(bool was_converging, ScanTask* task);
  Verdict judge(const ScanTask& task);
  void lookForConflict(const ScanResult& result);
  void learnDoubt(const ScanTask& task);
  void anchorHere();

  LocalizerParameters parameters_;
  ParticleFilter filter_;
  OdometryHistory odometry_;
  OdometryCalibration calibration_;
  RangeBias range_bias_;
  OdometryDoubt doubt_;
  SweepOrder sweep_order_;
  std::shared_ptr<MapModel> map_;
  std::optional<Anchor> anchor_;
  std::optional<double> last_scan_stamp_;
  bool search_pending_ = false;
  HypothesisVerifier verifier_;
  RecoveryPolicy recovery_;
  Judge judge_;
  LidarOdometry lidar_odometry_;
  bool challenge_pending_ = false;
  int scans_since_stop_ = 0;
  LocalizerCounters counters_;
};

}  // namespace racecar_mcl
