// Names of the enumeration values of the localizer's parameters.
#pragma once

#include <utility>
#include <vector>

#include "racecar_mcl/common/parameter_text.h"
#include "racecar_mcl/localizer/localizer_parameters.h"

namespace racecar_mcl {

template <>
struct EnumNames<MotionNoise> {
  static std::vector<std::pair<MotionNoise, const char*>> all() {
    return {{MotionNoise::kConstant, "constant"},
            {MotionNoise::kDifferential, "differential"},
            {MotionNoise::kAckermann, "ackermann"}};
  }
};

template <>
struct EnumNames<ResamplingMethod> {
  static std::vector<std::pair<ResamplingMethod, const char*>> all() {
    return {{ResamplingMethod::kSystematic, "systematic"},
            {ResamplingMethod::kMultinomial, "multinomial"}};
  }
};

template <>
struct EnumNames<EstimateFrom> {
  static std::vector<std::pair<EstimateFrom, const char*>> all() {
    return {{EstimateFrom::kMean, "mean"},
            {EstimateFrom::kBest, "best"},
            {EstimateFrom::kCluster, "cluster"}};
  }
};

template <>
struct EnumNames<UnknownIs> {
  static std::vector<std::pair<UnknownIs, const char*>> all() {
    return {{UnknownIs::kFree, "free"}, {UnknownIs::kOccupied, "occupied"}};
  }
};

template <>
struct EnumNames<SensorModelType> {
  static std::vector<std::pair<SensorModelType, const char*>> all() {
    return {{SensorModelType::kBeam, "beam"},
            {SensorModelType::kLikelihoodField, "likelihood_field"}};
  }
};

template <>
struct EnumNames<MotionFrom> {
  static std::vector<std::pair<MotionFrom, const char*>> all() {
    return {{MotionFrom::kTwist, "twist"}, {MotionFrom::kPose, "pose"}, {MotionFrom::kTf, "tf"}};
  }
};

template <>
struct EnumNames<BeamLayout> {
  static std::vector<std::pair<BeamLayout, const char*>> all() {
    return {{BeamLayout::kEven, "even"}, {BeamLayout::kBoxed, "boxed"}};
  }
};

template <>
struct EnumNames<ScanDirectionFrom> {
  static std::vector<std::pair<ScanDirectionFrom, const char*>> all() {
    return {{ScanDirectionFrom::kAuto, "auto"},
            {ScanDirectionFrom::kListed, "listed"},
            {ScanDirectionFrom::kReversed, "reversed"}};
  }
};

template <>
struct EnumNames<Relocalization> {
  static std::vector<std::pair<Relocalization, const char*>> all() {
    return {{Relocalization::kFull, "full"},
            {Relocalization::kStart, "start"},
            {Relocalization::kOff, "off"},
            {Relocalization::kOff, "false"}};  // YAML reads a bare off as false
  }
};

}  // namespace racecar_mcl
