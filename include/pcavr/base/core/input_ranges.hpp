// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The values that are accepted for one external quantity (input validation). The limits lie far
/// beyond what a tabletop, a room or an arm needs: they catch errors of unit, sign and format, and
/// numbers for which formulas overflow. Values outside, and NaN or infinity, are rejected by every
/// reader and by the command line, so that they never violate a precondition further on.
struct InputRange {
  const char* quantity = "";
  double min = 0.0;
  double max = 0.0;
  const char* unit = "";
  const char* reason = "";  ///< why these limits

  /// False for NaN and infinity.
  [[nodiscard]] bool contains(double value) const { return value >= min && value <= max; }
};

/// The one table of ranges, for files and options alike; docs/files.md lists it.
namespace ranges {

inline constexpr InputRange kStamp{
    "stamp", -4.6e9, 4.6e9, "s",
    "integer nanoseconds, and the difference of any two, fit into 64 bits (146 years)"};
inline constexpr InputRange kSpan{
    "span of a series", 0.0, 36000.0, "s",
    "ten hours: corrections count time in 32 bits of 10 us, which are 11.9 h"};
inline constexpr InputRange kCoordinate{
    "coordinate", -1e4, 1e4, "m",
    "single precision resolves 1 mm there; beyond it is another unit or frame"};
inline constexpr InputRange kTagSize{"tag's size", 1e-3, 10.0, "m",
                                     "from a printer's finest tag to a wall; 100 is millimetres"};
inline constexpr InputRange kBodySize{
    "body's size", 1e-4, 1e3, "m",
    "a tenth of a millimetre keeps its volume above rounding; nothing larger is pushed"};
inline constexpr InputRange kMass{"mass", 1e-6, 1e4, "kg",
                                  "from a milligram to more than a tool can push"};
inline constexpr InputRange kToolRadius{"tool's radius", 1e-4, 0.5, "m",
                                        "from a needle to a sphere of 1 m diameter"};
inline constexpr InputRange kYoungsModulus{"Young's modulus", 1e3, 1e13, "Pa",
                                           "from soft foam to ten times diamond"};
inline constexpr InputRange kPoissonRatio{"Poisson's ratio", -0.99, 0.5, "1",
                                          "stable isotropic materials, -1 to 0.5 (rubber)"};
inline constexpr InputRange kForce{"force", -1e5, 1e5, "N",
                                   "ten times the rating of the largest arms"};
inline constexpr InputRange kTorque{"torque", -1e5, 1e5, "N m",
                                    "ten times the rating of the largest arms"};
inline constexpr InputRange kJoint{"joint value", -1e6, 1e6, "rad, rad/s, N m",
                                   "more turns than any joint makes in ten hours"};
inline constexpr InputRange kDepthScale{
    "depth scale", 1.0, 1e6, "units/m",
    "16-bit images: at 1 a step is a metre, at 1e6 the maximum is 6.5 cm"};
inline constexpr InputRange kPositionStd{"std of a position", 0.0, 1e3, "m",
                                         "beyond a kilometre nothing is known"};
inline constexpr InputRange kRotationStd{"std of a rotation", 0.0, 1e3, "rad",
                                         "beyond pi nothing is known"};
inline constexpr InputRange kFigure{"quality figure", 0.0, 1e9, "any",
                                    "reported in a scene; printed, not used in computations"};

// The parameters that identification finds and a parameter file states. Lower ends keep quotients
// finite.
inline constexpr InputRange kStaticFriction{
    "limiting static friction", 1e-6, 1e5, "N",
    "as for forces; below a micronewton there is no friction"};
inline constexpr InputRange kFrictionCoefficient{"friction coefficient", 1e-6, 10.0, "1",
                                                 "rubber on rubber reaches 4"};
inline constexpr InputRange kToolFriction{"tool's friction coefficient", 0.0, 10.0, "1",
                                          "rubber on rubber reaches 4; a roller has none"};
inline constexpr InputRange kViscousFriction{"viscous friction", 0.0, 1e5, "N s/m",
                                             "a push of 1 m/s at the largest force"};
inline constexpr InputRange kFrictionRadius{"friction radius", 1e-6, 10.0, "m",
                                            "a body that a tool pushes is smaller"};
inline constexpr InputRange kLoadingRate{"loading rate", 1e-6, 1e7, "N/s",
                                         "the largest force within 10 ms"};
inline constexpr InputRange kStiffness{"contact stiffness", 1e-6, 1e12, "N/m^n",
                                       "steel on steel at n = 1.5 is some 1e10"};
inline constexpr InputRange kDamping{"contact damping", 0.0, 1e14, "N s/m^(n+1)",
                                     "the stiffest contact, times 100 s/m"};
inline constexpr InputRange kExponent{"contact exponent", 1.0, 3.0, "1",
                                      "1 is flat, 1.5 a sphere, 2 a cone [Hunt and Crossley 1975]"};
inline constexpr InputRange kParameterStd{"std of a parameter", 0.0, 1e15, "as the parameter",
                                          "ten times the largest parameter"};

inline constexpr InputRange kVoxel{"voxel", 0.001, 0.1, "m",
                                   "finer than the sensors' noise; coarser than tabletop objects"};
inline constexpr InputRange kOccupancyCell{"occupancy cell", 0.005, 1.0, "m",
                                           "the tree's memory; what an arm's planner can use"};
inline constexpr InputRange kDelay{
    "delay", 0.0, 10.0, "s", "a round trip to the Moon is 2.6 s; the prediction's memory grows"};
inline constexpr InputRange kJitter{"jitter", 0.0, 1.0, "s", "a tenth of the longest delay"};
inline constexpr InputRange kShare{"share", 0.0, 1.0, "1", "a fraction of the total"};
inline constexpr InputRange kImportRate{"frames a second", 0.1, 1e5, "Hz",
                                        "keeps the stamps of a million frames apart and in range"};
inline constexpr InputRange kStateRate{"states a second", 60.0, 90.0, "Hz",
                                       "frame rates of headsets"};
inline constexpr InputRange kHandForce{
    "force on the hand", 0.1, 1000.0, "N",
    "below it nothing is perceptible; above it no device is made"};
inline constexpr InputRange kClockOffset{"clock offset", -10.0, 10.0, "s",
                                         "longer than any case's push"};
inline constexpr InputRange kSaturation{"force sensor saturation", 0.1, 1e5, "N",
                                        "above a sensor's noise; as for forces"};
inline constexpr InputRange kPageSize{"page's side", 0.02, 10.0, "m",
                                      "from a label to the widest plotter's roll"};

/// All of them, in the order of the documentation.
inline constexpr std::array kAll{
    kStamp,          kSpan,           kCoordinate,          kTagSize,      kBodySize,
    kMass,           kToolRadius,     kYoungsModulus,       kPoissonRatio, kForce,
    kTorque,         kJoint,          kDepthScale,          kPositionStd,  kRotationStd,
    kFigure,         kStaticFriction, kFrictionCoefficient, kToolFriction, kViscousFriction,
    kFrictionRadius, kLoadingRate,    kStiffness,           kDamping,      kExponent,
    kParameterStd,   kVoxel,          kOccupancyCell,       kDelay,        kJitter,
    kShare,          kImportRate,     kStateRate,           kHandForce,    kClockOffset,
    kSaturation,     kPageSize};

}  // namespace ranges

/// An Error with the permitted range where `value` is outside it; nothing where it is inside.
/// `written` is the value as the user wrote it. The Error has no file, line and place.
[[nodiscard]] std::optional<Error> check_range(const InputRange& range, double value,
                                               const std::string& written);
/// The same check; the message has the value in its shortest decimal form.
[[nodiscard]] std::optional<Error> check_range(const InputRange& range, double value);

}  // namespace pcavr
