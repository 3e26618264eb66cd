// Scan preprocessing: beam selection, range correction and deskewing.
#pragma once

#include "racecar_mcl/scan/deskew.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

enum class BeamLayout {
  kEven,   ///< evenly spaced bearings
  kBoxed,  ///< end points evenly spaced on the walls of a corridor (selectBeamsBoxed)
};

struct ScanParameters {
  int num_beams_per_particle = 240;    ///< beams used per scan
  double scan_field_of_view = 6.2832;  ///< rad, beams outside are not used
  BeamLayout beam_layout = BeamLayout::kBoxed;
  double beam_box_aspect = 2.0;  ///< length / width of the box of kBoxed
  int min_beams = 10;            ///< a scan with fewer valid beams is not used
  bool deskew = true;            ///< correct for the car's motion during the sweep
};

/// Throws ParameterError on a value out of range.
void validate(const ScanParameters& parameters);

/// Corrections of the lidar's systematic errors.
struct ScanCorrection {
  double range_bias = 0.0;  ///< m, subtracted from the ranges
  bool reversed = false;    ///< beams are listed in reverse acquisition order
  bool moves = false;       ///< the scan is moved to another pose than that at its stamp
};

struct PreprocessedScan {
  Scan beams;           ///< deskewed, as seen from one pose of the car
  Scan sweep;           ///< before deskewing, with times in acquisition order
  double turned = 0.0;  ///< rad, turn of the car during the sweep; 0 without deskewing
};

class ScanPreprocessor {
 public:
  /// Throws as `validate` does.
  explicit ScanPreprocessor(const ScanParameters& parameters);

  /// Selects the beams of a scan that are used.
  Scan select(const Scan& scan) const;
  /// Whether there are at least min_beams.
  bool isEnough(const Scan& selected) const { return selected.size() >= parameters_.min_beams; }

  /// Corrects and deskews the selected beams.
  PreprocessedScan correct(Scan selected, const ScanCorrection& correction,
                           const BaseAfter& base_after) const;

  const ScanParameters& parameters() const { return parameters_; }

 private:
  ScanParameters parameters_;
};

}  // namespace racecar_mcl
