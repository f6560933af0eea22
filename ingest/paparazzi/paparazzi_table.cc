// Which messages and fields a Flight is made of. The integers of the firmware are exact powers of two; the
// coefficients that a .log prints are rounded (0.0000019 for 2^-19 is 0.4 % off) and are never used.
#include <cmath>
#include <numbers>

#include "ingest/paparazzi/paparazzi_aircraft.h"

namespace quadsonde::ingest::paparazzi {
namespace {

struct FieldSpec {
  std::string_view name;
  double factor = 1;  ///< of an integer field to the row's unit; floats come in that unit
  bool optional = false;
};

struct RowSpec {
  std::string_view message;
  Row row;
  std::array<FieldSpec, most_values> fields;
};

constexpr double p8 = 1.0 / 256, p10 = 1.0 / 1024, p12 = 1.0 / 4096, p15 = 1.0 / 32768, p19 = 1.0 / 524288;
constexpr double degree = std::numbers::pi / 180;

// Source: paparazzi/pprzlink message_definitions/v1.0/messages.xml; sw/airborne/math/pprz_algebra_int.h for the powers.
constexpr RowSpec rows[] = {
    // ENU from INS_REF: m, m/s; rad.
    {"ROTORCRAFT_FP",
     Row::rotorcraft_fp,
     {{{"east", p8},
       {"north", p8},
       {"up", p8},
       {"veast", p19},
       {"vnorth", p19},
       {"vup", p19},
       {"phi", p12},
       {"theta", p12},
       {"psi", p12}}}},
    // NED from INS_REF: m, m/s.
    {"INS",
     Row::ins,
     {{{"ins_x", p8}, {"ins_y", p8}, {"ins_z", p8}, {"ins_xd", p19}, {"ins_yd", p19}, {"ins_zd", p19}}}},
    // deg; m above mean sea level.
    {"INS_REF", Row::ins_ref, {{{"lat0", 1e-7}, {"lon0", 1e-7}, {"hmsl0", 1e-3}}}},
    // deg; m above the ellipsoid and the sea; ECEF m/s; m/s 1-sigma; ms of the GPS week.
    {"GPS_INT",
     Row::gps_int,
     {{{"fix"},
       {"lat", 1e-7},
       {"lon", 1e-7},
       {"alt", 1e-3},
       {"hmsl", 1e-3},
       {"ecef_xd", 1e-2},
       {"ecef_yd", 1e-2},
       {"ecef_zd", 1e-2},
       {"sacc", 1e-2, true},
       {"tow"}}}},
    // course rad from north; m above mean sea level (mm, cm in old files); m/s, climb up; GPS week and its ms.
    {"GPS",
     Row::gps,
     {{{"mode"},
       {"course", 0.1 * degree},
       {"alt", 1e-3},
       {"speed", 1e-2},
       {"climb", 1e-2},
       {"week", 1, true},
       {"itow"}}}},
    {"GPS_LLA",
     Row::gps_lla,
     {{{"mode"},
       {"course", 0.1 * degree},
       {"hmsl", 1e-3, true},
       {"speed", 1e-2},
       {"climb", 1e-2},
       {"week", 1, true},
       {"itow"},
       {"lat", 1e-7},
       {"lon", 1e-7},
       {"alt", 1e-3}}}},
    // rad as float, degrees as integer (old); this order in the file is phi, psi, theta.
    {"ATTITUDE", Row::attitude, {{{"phi", degree}, {"theta", degree}, {"psi", degree}}}},
    // Scalar first; as numbers the usual quaternion of the body's attitude.
    {"AHRS_QUAT_INT", Row::quaternion, {{{"body_qi", p15}, {"body_qx", p15}, {"body_qy", p15}, {"body_qz", p15}}}},
    {"AHRS_EULER_INT", Row::euler, {{{"body_phi", p12}, {"body_theta", p12}, {"body_psi", p12}}}},
    {"IMU_ACCEL_SCALED", Row::acceleration, {{{"ax", p10}, {"ay", p10}, {"az", p10}}}},
    {"IMU_ACCEL", Row::acceleration, {{{"ax"}, {"ay"}, {"az"}}}},
    // Pa; m above mean sea level. The temperature is the board's and stays out.
    {"AIR_DATA", Row::air_data, {{{"pressure"}, {"amsl_baro", 1, true}}}},
    // m/s, where the air moves to; bit 0 of the flags: horizontal part valid. Old logs have no flags.
    {"WIND_INFO_RET", Row::wind, {{{"flags", 1, true}, {"east"}, {"north"}}}},
    {"ROTORCRAFT_STATUS", Row::status, {{{"gps_status", 1, true}, {"ap_in_flight"}, {"ap_motors_on"}}}},
    // A text.
    {"AUTOPILOT_VERSION", Row::version, {{{"desc", 1, true}}}},
    {"ROTORCRAFT_CMD", Row::rotorcraft_mark, {}},
    {"ROTORCRAFT_NAV_STATUS", Row::rotorcraft_mark, {}},
    {"NAVIGATION", Row::fixed_wing_mark, {}},
    {"ESTIMATOR", Row::fixed_wing_mark, {}},
};

double factor_of(const FieldSpec& spec, const PaparazziField& field, Row row) {
  if (field.is_float()) return 1;
  // Heights of old GPS messages are centimetres; the definition says which.
  if ((row == Row::gps || row == Row::gps_lla) && spec.factor == 1e-3 && field.unit == "cm") return 1e-2;
  return spec.factor;
}

}  // namespace

Binding bind(const PaparazziMessageDefinition& definition) {
  Binding binding;
  for (const auto& spec : rows) {
    if (spec.message != definition.name) continue;
    binding.row = spec.row;
    binding.values = definition.fields.size();
    binding.complete = true;
    for (std::size_t i = 0; i < most_values; ++i) {
      binding.index[i] = -1;
      if (spec.fields[i].name.empty()) continue;
      const auto found = definition.find(spec.fields[i].name);
      if (found) {
        binding.index[i] = static_cast<int>(*found);
        binding.factor[i] = factor_of(spec.fields[i], definition.fields[*found], spec.row);
      } else if (!spec.fields[i].optional) {
        binding.complete = false;
      }
    }
    break;
  }
  return binding;
}

}  // namespace quadsonde::ingest::paparazzi
